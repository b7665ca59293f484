#!/usr/bin/env python3
"""Measure the binary on rendered photographs with ground truth, and fail where a figure misses its bound.

    check_figures.py --slcal target/release/slcal --shared ../shared

Runs the scorer that lies beside the data and what it does not measure: planes fitted to own clouds, the same photograph at
other sizes, a 24-megapixel photograph within its memory, and real photographs of a sheet. Says so and passes where the data
is not at hand.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = ["paper_tilted", "paper_lensshift", "near_frontal", "dark_clutter", "pair_a", "pair_b"]

# Errors of focal lengths in per cent, of the principal point in px: (scene, photographs) -> {figure: largest magnitude}.
CALIBRATION_BOUNDS = {
    ("paper_tilted", "one photo"): {"f_cam": 0.03, "f_proj": 0.1},
    ("paper_tilted", "with screen"): {"f_cam": 0.03, "f_proj": 0.1},
    ("paper_lensshift", "one photo"): {"f_cam": 0.03, "f_proj": 0.1, "cy_proj": 2.0},
    ("dark_clutter", "one photo"): {"f_cam": 0.3, "f_proj": 0.6},
}
# Per cent of the matches that are right, and of the stripes that are found, at least.
STRIPE_BOUNDS = {"plane": {"right": 99.0, "found": 97.0}, "other": {"right": 97.0, "found": 90.0}}
# Mean distance of a plane's cloud from the fitted plane, per cent of the distance to the camera, at most.
PLANE_BOUND_PERCENT = 0.1
# The sheet seen 3 degrees off face-on with exact principal points, focal length error in per cent, at most.
NEAR_FRONTAL_BOUND_PERCENT = 1.0
# Focal length of the same photograph at half and at double size, per cent, at most.
SCALE_BOUND_PERCENT = 0.3
MEMORY_BOUND_GIB = 1.5
# Errors in units of their own sigma, and of focal lengths of the two poses together in per cent, at most.
SIGMAS_BOUND = 3.0
PAIR_BOUNDS_PERCENT = {"camera": 0.03, "projector": 0.2}
REAL_FOCAL_PX = 701.0
REAL_BOUND_PERCENT = 10.0
REAL_TILTED = ["02", "07", "10", "11", "12"]
REAL_FACE_ON = ["01", "03"]


class Table:
    """The figures beside their bounds."""

    def __init__(self):
        self.failed = self.passed = 0

    def row(self, what, measured, bound, holds):
        self.passed += bool(holds)
        self.failed += not holds
        print(f"{'ok  ' if holds else 'MISS'} {what:58s} {measured:>22s}   asked: {bound}", flush=True)

    def at_most(self, what, value, bound, unit=""):
        if value is None:
            self.row(what, "no result", f"<= {bound:g}{unit}", False)
        else:
            self.row(what, f"{value:.4f}{unit}", f"|x| <= {bound:g}{unit}", abs(value) <= bound)

    def at_least(self, what, value, bound, unit=""):
        if value is None:
            self.row(what, "no result", f">= {bound:g}{unit}", False)
        else:
            self.row(what, f"{value:.3f}{unit}", f">= {bound:g}{unit}", value >= bound)


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True)


def size_of(truth):
    return "x".join(f"{s:g}" for s in truth["views"][0]["size_mm"]) + "mm"


def calibrate(slcal, photo, size, out, *more):
    return run(slcal, "calibrate", photo, "--size", size, "-o", out, "--force", *more)


def check_scorer(table, slcal, shared):
    scenes = [shared / "data/rendered" / s for s in SCENES]
    scorer = run(sys.executable, shared / "tools/score_rendered.py", "--slcal", slcal, *scenes, "--json")
    if scorer.returncode:
        print(scorer.stderr, file=sys.stderr)
        table.row("the scorer runs", f"exit {scorer.returncode}", "exit 0", False)
        return
    rows = json.loads(scorer.stdout)
    for r in rows:
        keys = " ".join(f"{k}={v:.3f}" if isinstance(v, float) else f"{k}={v}" for k, v in r.items() if k not in ("scene", "view", "rig"))
        print(f"     {r['scene']:16s} {r['view']:16s} {r['rig']:12s} {keys}")
    by_key = {(r["scene"], r["view"], r["rig"]): r for r in rows}
    for (scene, photos), bounds in CALIBRATION_BOUNDS.items():
        r = by_key.get((scene, "calibrate", photos), {})
        for figure, bound in bounds.items():
            table.at_most(f"{scene}, {photos}: {figure}", r.get(figure), bound)
    for r in rows:
        if r["view"] == "calibrate" or r["rig"] != "true":
            continue
        bounds = STRIPE_BOUNDS["plane" if "plane" in r["view"] else "other"]
        for figure, bound in bounds.items():
            table.at_least(f"{r['scene']}, {r['view']}: {figure}", r.get(figure), bound, " %")


def check_sigma(table, slcal, shared, tmp):
    """Every focal length within three of its own σ, with principal points as a prior and exact, alone and the pair."""
    rendered = shared / "data/rendered"
    for scenes in [[s] for s in SCENES] + [["pair_a", "pair_b"]]:
        folder = rendered / scenes[0]
        truth = json.loads((folder / "truth_rig.json").read_text())
        for exact in (False, True):
            more = ["--pattern", folder / "patterns/checker.json", "--allow-degenerate"]
            if exact:
                points = {d: ",".join(str(truth[d]["K"][i][2]) for i in (0, 1)) for d in ("camera", "projector")}
                more += ["--camera-pp", points["camera"], "--projector-pp", points["projector"]]
            photos = [rendered / s / "checker.png" for s in scenes]
            out = tmp / "sigma.json"
            r = run(slcal, "calibrate", *photos, "--size", size_of(truth), "-o", out, "--force", *more)
            rig = json.loads(out.read_text()) if r.returncode == 0 else None
            what = f"{'+'.join(scenes)}, principal points {'exact' if exact else 'by default'}"
            for device in ("camera", "projector"):
                error = sigma = None
                if rig:
                    error = rig[device]["K"][0][0] - truth[device]["K"][0][0]
                    sigma = rig[device]["sigma"]["focal_px"]
                table.at_most(f"{what}: f of the {device} / sigma", error / sigma if rig else None, SIGMAS_BOUND)
                if len(scenes) > 1:
                    percent = 100 * error / truth[device]["K"][0][0] if rig else None
                    table.at_most(f"{what}: f of the {device}", percent, PAIR_BOUNDS_PERCENT[device], " %")


def check_near_frontal(table, slcal, shared, tmp):
    scene = shared / "data/rendered/near_frontal"
    truth = json.loads((scene / "truth_rig.json").read_text())
    args = (slcal, scene / "checker.png", size_of(truth), tmp / "near.json", "--pattern", scene / "patterns/checker.json")
    plain = calibrate(*args)
    table.row("near_frontal: refused", f"exit {plain.returncode}", "exit 5", plain.returncode == 5)
    exact = calibrate(*args, "--camera-pp", "639.5,479.5", "--projector-pp", "511.5,383.5")
    error = None
    if exact.returncode == 0:
        rig = json.loads((tmp / "near.json").read_text())
        error = 100 * (rig["camera"]["K"][0][0] / truth["camera"]["K"][0][0] - 1)
    table.at_most("near_frontal, exact principal points: f_cam", error, NEAR_FRONTAL_BOUND_PERCENT, " %")


def check_two_vp(table, slcal, shared, tmp):
    scene = shared / "data/rendered/paper_lensshift"
    truth = json.loads((scene / "truth_rig.json").read_text())
    out = tmp / "two_vp.json"
    r = calibrate(slcal, scene / "checker.png", size_of(truth), out, "--pattern", scene / "patterns/checker.json", "--method", "two-vp")
    if r.returncode == 0:
        rig = json.loads(out.read_text())
        error = 100 * (rig["projector"]["K"][0][0] / truth["projector"]["K"][0][0] - 1)
        said = len(rig["quality"]["warnings"])
        table.row("paper_lensshift, two-vp: wrong by far, and says so", f"{error:+.0f} %, {said} warnings", "imaginary, or > 20 % and a warning", abs(error) > 20 and said > 0)
    else:
        imaginary = r.returncode == 5 and "imaginary" in r.stderr
        table.row("paper_lensshift, two-vp: imaginary, and says so", f"exit {r.returncode}", "exit 5, imaginary", imaginary)


def check_planes(table, slcal, shared, tmp):
    for name in ("paper_tilted", "paper_lensshift"):
        scene = shared / "data/rendered" / name
        truth = json.loads((scene / "truth_rig.json").read_text())
        rig = tmp / f"{name}.json"
        calibrate(slcal, scene / "checker.png", size_of(truth), rig, "--pattern", scene / "patterns/checker.json")
        for image in sorted(scene.glob("stripes_plane_?.png")):
            cloud = tmp / "cloud.ply"
            r = run(slcal, "reconstruct", "--rig", rig, "--pattern", scene / "patterns/stripes.json", image, "-o", cloud, "--force")
            fit = run(slcal, "evaluate", "plane", cloud, "--json") if r.returncode == 0 else r
            percent = json.loads(fit.stdout)["mean_percent"] if fit.returncode == 0 else None
            table.at_most(f"{name}, {image.stem}, own rig: distance to the plane", percent, PLANE_BOUND_PERCENT, " %")


def check_sizes(table, slcal, shared, tmp):
    from PIL import Image

    scene = shared / "data/rendered/paper_tilted"
    truth = json.loads((scene / "truth_rig.json").read_text())
    pattern = scene / "patterns/checker.json"
    photo = Image.open(scene / "checker.png").convert("RGB")
    focal = {}
    for factor in (1, 0.5, 2):
        resized = photo.resize((round(photo.width * factor), round(photo.height * factor)), Image.Resampling.BOX if factor < 1 else Image.Resampling.BICUBIC)
        resized.save(tmp / "resized.png")
        r = calibrate(slcal, tmp / "resized.png", size_of(truth), tmp / "resized.json", "--pattern", pattern)
        if r.returncode == 0:
            rig = json.loads((tmp / "resized.json").read_text())
            focal[factor] = {d: rig[d]["K"][0][0] / (factor if d == "camera" else 1) for d in ("camera", "projector")}
    for factor in (0.5, 2):
        for device in ("camera", "projector"):
            both = 1 in focal and factor in focal
            change = 100 * (focal[factor][device] / focal[1][device] - 1) if both else None
            table.at_most(f"paper_tilted at {factor:g} of its size: change of the {device}'s f", change, SCALE_BOUND_PERCENT, " %")


def peak_memory_gib(*command):
    """Exit code and peak resident memory of one command."""
    script = "import resource,subprocess,sys; c=subprocess.run(sys.argv[1:],stdout=subprocess.DEVNULL).returncode; print(c, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    out = run(sys.executable, "-c", script, *command)
    code, kib = out.stdout.split()
    return int(code), int(kib) / 2**20, out.stderr


def check_memory(table, slcal, shared, tmp):
    from PIL import Image

    scene = shared / "data/rendered/paper_tilted"
    truth = json.loads((scene / "truth_rig.json").read_text())
    size = (5664, 4248)
    for name in ("checker", "stripes_blob"):
        Image.open(scene / f"{name}.png").convert("RGB").resize(size, Image.Resampling.BICUBIC).save(tmp / f"{name}.png", compress_level=1)
    patterns = scene / "patterns"
    for what, command in {
        "calibrate": ["calibrate", tmp / "checker.png", "--size", size_of(truth), "--pattern", patterns / "checker.json", "-o", tmp / "large.json", "--force"],
        "reconstruct": ["reconstruct", "--rig", tmp / "large.json", "--pattern", patterns / "stripes.json", tmp / "stripes_blob.png", "-o", tmp / "large.ply", "--force"],
    }.items():
        code, gib, said = peak_memory_gib(slcal, *map(str, command))
        if code:
            print(said, file=sys.stderr)
        table.row(f"24 megapixels, {what}: memory", f"exit {code}, {gib:.2f} GiB", f"exit 0, <= {MEMORY_BOUND_GIB} GiB", code == 0 and gib <= MEMORY_BOUND_GIB)


def check_real(table, slcal, shared, tmp):
    photos = shared / "data/real/sony_sheet"
    for number in REAL_TILTED + REAL_FACE_ON:
        out = tmp / f"real{number}.json"
        r = calibrate(slcal, photos / f"frame{number}.jpg", "279.4x215.9mm", out)
        rig = json.loads(out.read_text()) if r.returncode == 0 else None
        if number in REAL_TILTED:
            error = 100 * (rig["camera"]["K"][0][0] / REAL_FOCAL_PX - 1) if rig else None
            table.at_most(f"real sheet {number}: f_cam", error, REAL_BOUND_PERCENT, " %")
        else:
            verdict = rig["quality"]["verdict"] if rig else f"exit {r.returncode}"
            table.row(f"real sheet {number}, seen face-on", verdict, "not good", verdict in ("fair", "weak", "exit 5"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slcal", required=True, type=Path)
    parser.add_argument("--shared", required=True, type=Path)
    args = parser.parse_args()
    if not (args.shared / "tools/score_rendered.py").is_file():
        print(f"skipped: no rendered photographs at {args.shared}")
        return 0
    slcal, shared = args.slcal.resolve(), args.shared.resolve()
    table = Table()
    with tempfile.TemporaryDirectory() as folder:
        tmp = Path(folder)
        check_scorer(table, slcal, shared)
        for check in (check_sigma, check_near_frontal, check_two_vp, check_planes, check_sizes, check_memory, check_real):
            check(table, slcal, shared, tmp)
    print(f"figures: {table.passed} passed, {table.failed} failed")
    return 1 if table.failed else 0


if __name__ == "__main__":
    sys.exit(main())
