"""Rigs calibrated from rendered photographs, beside the true ones and beside their own sigma."""

import itertools
import json
import math
from pathlib import Path

from .common import SCENES, calibrate, run, size_of

# Errors of focal lengths in per cent, of the principal point in px: (scene, photographs) -> {figure: largest magnitude}.
CALIBRATION_BOUNDS = {
    ("paper_tilted", "one photo"): {"f_cam": 0.03, "f_proj": 0.1},
    ("paper_tilted", "with screen"): {"f_cam": 0.03, "f_proj": 0.1},
    ("paper_lensshift", "one photo"): {"f_cam": 0.03, "f_proj": 0.1, "cy_proj": 2.0},
    ("dark_clutter", "one photo"): {"f_cam": 0.3, "f_proj": 0.6},
}
# The sheet seen 3 degrees off face-on with exact principal points, focal length error in per cent, at most.
NEAR_FRONTAL_BOUND_PERCENT = 1.0
# Focal length of the same photograph at half and at double size, per cent, at most.
SCALE_BOUND_PERCENT = 0.3
# Errors in units of their own sigma; of the two poses together: focal lengths in per cent, principal points in px; residuals
# of every rendered photograph in px: at most.
SIGMAS_BOUND = 3.0
PAIR_PP_PX = 0.6
RMS_BOUND_PX = 0.1
# Scenes whose true principal points lie where they are expected by default.
PAPER_SCENES = ("paper_tilted", "paper_lensshift")
PAPER_BASELINE_PERCENT = 0.1
PAPER_CY_PX = 2.0
PAIR_BOUNDS_PERCENT = {"camera": 0.03, "projector": 0.2}


def check_scores(table, ctx):
    rows = ctx.scores
    if rows is None:
        table.row("the scorer runs", "failed", "exit 0", False)
        return
    for r in rows:
        if r["view"] == "calibrate":
            keys = " ".join(f"{k}={v:.3f}" if isinstance(v, float) else f"{k}={v}" for k, v in r.items() if k not in ("scene", "view", "rig"))
            print(f"     {r['scene']:16s} {r['rig']:12s} {keys}")
    by_key = {(r["scene"], r["rig"]): r for r in rows if r["view"] == "calibrate"}
    for (scene, photos), bounds in CALIBRATION_BOUNDS.items():
        r = by_key.get((scene, photos), {})
        for figure, bound in bounds.items():
            table.at_most(f"{scene}, {photos}: {figure}", r.get(figure), bound)


def errors_and_sigmas(rig, truth):
    """Figure -> (error, its own sigma), for what was estimated. The components of the translation are strongly correlated:
    the baseline's sigma comes from their whole covariance."""
    out = {}
    for device, suffix in (("camera", "_cam"), ("projector", "_proj")):
        k, true, sigma = rig[device]["K"], truth[device]["K"], rig[device]["sigma"]
        out["f" + suffix] = (k[0][0] - true[0][0], sigma["focal_px"])
        for axis, name in enumerate(("cx", "cy")):
            out[name + suffix] = (k[axis][2] - true[axis][2], sigma[name + "_px"])
    distortion = rig["camera"]["sigma"]["distortion"]
    out["k1"] = (rig["camera"]["distortion"][0] - truth["camera"]["distortion"][0], distortion[0])
    t, names, matrix = rig["projector_from_camera"]["t"], rig["covariance"]["parameters"], rig["covariance"]["matrix"]
    length = math.hypot(*t)
    at = [names.index(f"projector_from_camera.{axis}_mm") for axis in ("tx", "ty", "tz")]
    variance = sum(t[i] * matrix[at[i]][at[j]] * t[j] for i in range(3) for j in range(3)) / length**2
    sigma = math.sqrt(max(variance, 0.0))
    out["baseline"] = (length - math.hypot(*truth["projector_from_camera"]["t"]), sigma)
    return {name: (error, sigma) for name, (error, sigma) in out.items() if sigma > 0}


def check_sigma(table, ctx):
    """Every error within three of its own sigma, and the residuals: alone and the pair, from one photograph and with the
    dark one, principal points by default and exact."""
    rendered = ctx.rendered
    for scenes in [[s] for s in SCENES] + [["pair_a", "pair_b"]]:
        folder = rendered / scenes[0]
        truth = json.loads((folder / "truth_rig.json").read_text())
        for screen, exact in itertools.product((False, True), (False, True)):
            more = ["--pattern", folder / "patterns/checker.json"]
            if scenes == ["near_frontal"]:
                more += ["--allow-degenerate"]
            if screen:
                more += [x for s in scenes for x in ("--screen", rendered / s / "screen.png")]
            if exact:
                points = {d: ",".join(str(truth[d]["K"][i][2]) for i in (0, 1)) for d in ("camera", "projector")}
                more += ["--camera-pp", points["camera"], "--projector-pp", points["projector"]]
            photos = [rendered / s / "checker.png" for s in scenes]
            out = ctx.tmp / "sigma.json"
            r = run(ctx.slcal, "calibrate", *photos, "--size", size_of(truth), "-o", out, "--force", *more)
            what = f"{'+'.join(scenes)}{', screen' if screen else ''}, pp {'exact' if exact else 'default'}"
            if r.returncode:
                table.row(f"{what}: calibrates", f"exit {r.returncode}", "exit 0, or 5 alone", r.returncode == 5 and len(scenes) == 1)
                continue
            rig = json.loads(out.read_text())
            check_rig(table, what, rig, truth, len(scenes) > 1)
            if scenes[0] in PAPER_SCENES and not screen and not exact:
                base = math.hypot(*rig["projector_from_camera"]["t"]) / math.hypot(*truth["projector_from_camera"]["t"])
                table.at_most(f"{what}: baseline", 100 * (base - 1), PAPER_BASELINE_PERCENT, " %")
                table.at_most(f"{what}: cy_proj", errors_of(rig, truth, "projector", 1), PAPER_CY_PX, " px")


def errors_of(rig, truth, device, axis):
    return rig[device]["K"][axis][2] - truth[device]["K"][axis][2]


def check_rig(table, what, rig, truth, pair):
    for name, (error, sigma) in errors_and_sigmas(rig, truth).items():
        table.at_most(f"{what}: {name} / sigma", error / sigma, SIGMAS_BOUND)
    for view in rig["views"]:
        for kind in ("edges", "corners"):
            table.at_most(f"{what}, {Path(view['photo']).parent.name}: rms of {kind}", view["rms_px"][kind], RMS_BOUND_PX, " px")
    if pair:
        for device, bound in PAIR_BOUNDS_PERCENT.items():
            percent = 100 * (rig[device]["K"][0][0] / truth[device]["K"][0][0] - 1)
            table.at_most(f"{what}: f of the {device}", percent, bound, " %")
            for axis, name in enumerate(("cx", "cy")):
                table.at_most(f"{what}: {name} of the {device}", errors_of(rig, truth, device, axis), PAIR_PP_PX, " px")


def check_near_frontal(table, ctx):
    scene = ctx.rendered / "near_frontal"
    truth = ctx.truth_rig("near_frontal")
    args = (ctx.slcal, scene / "checker.png", size_of(truth), ctx.tmp / "near.json", "--pattern", scene / "patterns/checker.json")
    plain = calibrate(*args)
    table.row("near_frontal: refused", f"exit {plain.returncode}", "exit 5", plain.returncode == 5)
    exact = calibrate(*args, "--camera-pp", "639.5,479.5", "--projector-pp", "511.5,383.5")
    error = None
    if exact.returncode == 0:
        rig = json.loads((ctx.tmp / "near.json").read_text())
        error = 100 * (rig["camera"]["K"][0][0] / truth["camera"]["K"][0][0] - 1)
    table.at_most("near_frontal, exact principal points: f_cam", error, NEAR_FRONTAL_BOUND_PERCENT, " %")


def check_two_vp(table, ctx):
    scene = ctx.rendered / "paper_lensshift"
    truth = ctx.truth_rig("paper_lensshift")
    out = ctx.tmp / "two_vp.json"
    r = calibrate(ctx.slcal, scene / "checker.png", size_of(truth), out, "--pattern", scene / "patterns/checker.json", "--method", "two-vp")
    if r.returncode == 0:
        rig = json.loads(out.read_text())
        error = 100 * (rig["projector"]["K"][0][0] / truth["projector"]["K"][0][0] - 1)
        said = len(rig["quality"]["warnings"])
        table.row("paper_lensshift, two-vp: wrong by far, and says so", f"{error:+.0f} %, {said} warnings", "imaginary, or > 20 % and a warning", abs(error) > 20 and said > 0)
    else:
        imaginary = r.returncode == 5 and "imaginary" in r.stderr
        table.row("paper_lensshift, two-vp: imaginary, and says so", f"exit {r.returncode}", "exit 5, imaginary", imaginary)


def check_sizes(table, ctx):
    from PIL import Image

    scene = ctx.rendered / "paper_tilted"
    truth = ctx.truth_rig("paper_tilted")
    pattern = scene / "patterns/checker.json"
    photo = Image.open(scene / "checker.png").convert("RGB")
    focal = {}
    for factor in (1, 0.5, 2):
        resized = photo.resize((round(photo.width * factor), round(photo.height * factor)), Image.Resampling.BOX if factor < 1 else Image.Resampling.BICUBIC)
        resized.save(ctx.tmp / "resized.png")
        r = calibrate(ctx.slcal, ctx.tmp / "resized.png", size_of(truth), ctx.tmp / "resized.json", "--pattern", pattern)
        if r.returncode == 0:
            rig = json.loads((ctx.tmp / "resized.json").read_text())
            focal[factor] = {d: rig[d]["K"][0][0] / (factor if d == "camera" else 1) for d in ("camera", "projector")}
    for factor in (0.5, 2):
        for device in ("camera", "projector"):
            both = 1 in focal and factor in focal
            change = 100 * (focal[factor][device] / focal[1][device] - 1) if both else None
            table.at_most(f"paper_tilted at {factor:g} of its size: change of the {device}'s f", change, SCALE_BOUND_PERCENT, " %")


CHECKS = (check_scores, check_sigma, check_near_frontal, check_two_vp, check_sizes)


def check(table, ctx):
    for part in CHECKS:
        part(table, ctx)
