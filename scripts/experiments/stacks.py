"""The projector's parameters from the sheet under a sequence of Gray code, and under the checkerboard."""

import json

import cv2
import numpy as np

SIZE = "594x420mm"
# Principal points off the centre, px, and a projector that bends; the lens of the camera is ideal, which no calibration is told.
RIG = "--camera-offset 9,-7 --projector-offset -8 --projector-distortion=-0.05"
# Tilts of the sheet about the horizontal and vertical axis, degrees. Poses are added in this order.
POSES = [(25, 28), (-25, -28), (25, -28)]
# Sets of poses differ from these by so much at most: tilts, degrees, and the sheet's place, mm.
TILTED, ASIDE = 4.0, 25.0
SETS = 4
# Noise of a pixel of the camera in every photograph, grey levels of 255, and how often it is drawn for each set.
NOISE = 2.0
DRAWS = 5
WAYS = {"checkerboard": "checker", "sequence": "sequence"}
# (title, digits, path in the rig file, of its σ).
PARAMETERS = [
    ("f, px", 2, lambda d: (d["K"][0][0] + d["K"][1][1]) / 2, lambda s: s["focal_px"]),
    ("cx, px", 2, lambda d: d["K"][0][2], lambda s: s["cx_px"]),
    ("cy, px", 2, lambda d: d["K"][1][2], lambda s: s["cy_px"]),
    ("k1", 5, lambda d: d["distortion"][0], lambda s: s["distortion"][0]),
]


def prepare(slcal, folder):
    """Rig and sequence; returns the true projector."""
    truth = folder / "truth.json"
    slcal(f"simulate views --poses 1 {RIG} -o {folder}/seen.json --truth {truth} --force")
    slcal(f"pattern gray --projector 1024x768 --axis both --out-dir {folder}/gray --force")
    return json.loads(truth.read_text())["projector"]


def photographs(slcal, folder, tilt, rng):
    """The photographs of a pose without noise, grey: {way: [(H, W) float32, levels of 255]}."""
    x, y = tilt + rng.uniform(-TILTED, TILTED, 2)
    place = f"--tilt={x:.2f},{y:.2f} --aside={','.join(f'{v:.1f}' for v in rng.uniform(-ASIDE, ASIDE, 2))}"
    scene = f"simulate scene --rig {folder}/truth.json --surface sheet --size {SIZE} {place} --noise 0 --bits 16 --force"
    frames = {}
    for way, pattern in zip(WAYS, ["checker", f"{folder}/gray/sequence.json"]):
        out = folder / f"clean_{WAYS[way]}"
        slcal(f"{scene} --pattern {pattern} --out {out}")
        files = [out / "photo.png"] if way == "checkerboard" else sorted(out.glob("frame_*.png"))
        read = lambda file: cv2.cvtColor(cv2.imread(str(file), cv2.IMREAD_UNCHANGED), cv2.COLOR_BGR2GRAY)
        frames[way] = [np.float32(read(file)) / 257 for file in files]
    return frames


def observed(slcal, folder, frames, way, rng):
    """What slcal measures in photographs with noise, 8-bit PNG: its observations."""
    place = folder / f"noisy_{WAYS[way]}"
    place.mkdir(exist_ok=True)
    for i, frame in enumerate(frames):
        noisy = np.clip(np.rint(frame + NOISE * rng.standard_normal(frame.shape, dtype=np.float32)), 0, 255)
        cv2.imwrite(str(place / f"frame_{i:03}.png"), noisy.astype(np.uint8), [cv2.IMWRITE_PNG_COMPRESSION, 1])
    pattern = folder / ("gray/sequence.json" if way == "sequence" else "clean_checker/pattern.json")
    photo = place if way == "sequence" else place / "frame_000.png"
    seen = folder / "seen.json"
    line = f"calibrate {photo} --size {SIZE} --pattern {pattern} --flatness flat --allow-degenerate"
    slcal(f"{line} --save-observations {seen} -o {folder}/rig.json --force")
    return json.loads(seen.read_text())


def projectors(slcal, folder, poses):
    """The projectors of rigs from the first pose, the first two, and so on."""
    found = []
    for n in range(1, len(poses) + 1):
        views = [view for seen in poses[:n] for view in seen["views"]]
        place = folder / "seen.json"
        place.write_text(json.dumps({**poses[0], "views": views}))
        found.append(json.loads(slcal(f"calibrate --observations {place} --flatness flat --json").stdout)["projector"])
    return found


def experiment(slcal, folder, sets=SETS, draws=DRAWS):
    """The table."""
    truth = prepare(slcal, folder)
    rigs, count = {way: [] for way in WAYS}, {}
    for number in range(sets):
        rng = np.random.default_rng([1, number])
        seen = {way: [[] for _ in range(draws)] for way in WAYS}
        for tilt in POSES:
            for way, frames in photographs(slcal, folder, tilt, rng).items():
                count[way] = len(frames)
                for draw in seen[way]:
                    draw.append(observed(slcal, folder, frames, way, rng))
        for way in WAYS:
            rigs[way] += [projectors(slcal, folder, poses) for poses in seen[way]]
    lines = [
        "| poses | way | photographs | " + " | ".join(f"{title}: σ, rms error" for title, *_ in PARAMETERS) + " |",
        "|---" * (3 + len(PARAMETERS)) + "|",
    ]
    for n in range(len(POSES)):
        for way in WAYS:
            cells = [str(n + 1), way, str((n + 1) * count[way])]
            for _, digits, value, sigma in PARAMETERS:
                errors = np.array([value(found[n]) for found in rigs[way]]) - value(truth)
                stated = np.median([sigma(found[n]["sigma"]) for found in rigs[way]])
                cells.append(f"{stated:.{digits}f}, {np.sqrt((errors**2).mean()):.{digits}f}")
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)
