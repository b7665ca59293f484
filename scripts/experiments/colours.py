"""Decoding under what projectors and cameras do to light and colour, one effect at a time and all together."""

import csv
import json
from collections import defaultdict

import numpy as np

SHIFT = "--channel-shift 0.3,-0.2,-0.24,0.3"
LATERAL = "--lateral-colour 3e-4,-2e-4"
EFFECTS = {
    "none": "",
    "red +0.30 px, blue −0.24 px": SHIFT,
    "lateral colour 3e-4, −2e-4": LATERAL,
    "Bayer, Malvar": "--demosaic malvar",
    "Bayer, bilinear": "--demosaic bilinear",
    "sharpening 0.6": "--sharpen 0.6,1.2",
    "tone curve 0.3": "--tone 0.3",
    "JPEG 88, 4:2:0": "--jpeg 88",
    "vignetting 0.4": "--vignetting 0.4",
    "flicker 0.3": "--flicker 0.3,170",
    "projector's gamma 2.4": "--projector-gamma 2.4",
    "projector's falloff 0.4": "--projector-falloff 0.4",
    "all of a camera and a projector":
        f"{SHIFT} {LATERAL} --demosaic malvar --sharpen 0.6,1.2 --tone 0.25 --jpeg 88 --vignetting 0.3 --projector-falloff 0.3",
}
SURFACES = ["plane", "sphere"]
NOISE = "--noise 1 --blur 1"
# Matches farther away than this, px, are of another slit.
SAME_PX = 3.0


def matches(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def scene(slcal, folder, surface, effects):
    """What decoding says of a photograph with these effects, against the truth."""
    out = folder / "scene"
    slcal(f"simulate scene --surface {surface} {NOISE} {effects} --out {out} --force")
    photo = out / ("photo.jpg" if "--jpeg" in effects else "photo.png")
    report = json.loads(slcal(f"decode {photo} --pattern {out}/pattern.json -o {folder}/matches.csv --json --force").stdout)
    hues = json.loads((out / "pattern.json").read_text())["sequence"]
    key = lambda m: (round(float(m["v"])), m["slit"])
    truth = {}
    for m in matches(out / "truth_matches.csv"):
        truth.setdefault(key(m), float(m["u"]))
    errors, right, ratios, seen = defaultdict(list), 0, [], 0
    for m in matches(folder / "matches.csv"):
        if key(m) not in truth:
            continue
        seen += 1
        error = float(m["u"]) - truth[key(m)]
        if abs(error) < SAME_PX:
            right += 1
            errors[hues[int(m["slit"])]].append(error)
            ratios.append(abs(error) / float(m["sigma_px"]))
    everything = np.concatenate([np.array(e) for e in errors.values()])
    bias = max((abs(np.median(e)) for e in errors.values()))
    shift = report["channel_shift"]
    return {
        "right": 100 * right / seen,
        "found": 100 * right / len(truth),
        "bias": bias,
        "scatter": 1.4826 * np.median(np.abs(everything - np.median(everything))),
        "within": 100 * np.mean(np.array(ratios) < 1),
        "shift": f"{shift['red_px']:+.2f}, {shift['blue_px']:+.2f}" if shift and shift["used"] else "–",
    }


def experiment(slcal, folder):
    """The table."""
    lines = [
        "| surface | effect | right, % | found, % | bias of the worst hue, px | scatter, px | within 1σ, % | red, blue found, px |",
        "|---" * 8 + "|",
    ]
    for surface in SURFACES:
        for name, effects in EFFECTS.items():
            r = scene(slcal, folder, surface, effects)
            lines.append(
                f"| {surface} | {name} | {r['right']:.2f} | {r['found']:.1f} | {r['bias']:.3f} | {r['scatter']:.3f} "
                f"| {r['within']:.0f} | {r['shift']} |"
            )
    return "\n".join(lines)
