"""Rigs calibrated from rendered photographs of flat sheets, beside the true ones and beside their own sigma."""

import itertools
import json
import math
from pathlib import Path

from . import variants
from .common import SCENES, calibrate, calibrate_scenes, size_of

# What is taken for granted of sheet and lenses. By name: a flat sheet, square pixels and the lens of the scene, all exact.
# Flat: a flat sheet, and the lenses and aspects of `auto`. Default: nothing, neither of the sheet nor of the lenses.
BY_NAME, FLAT, DEFAULT = "by name", "flat", "default"
# Errors of focal lengths in per cent, of the principal point in px, largest magnitude, by name.
NAMED_BOUNDS = {
    "paper_tilted": {"f_cam": 0.03, "f_proj": 0.1},
    "paper_lensshift": {"f_cam": 0.03, "f_proj": 0.1, "cy_proj": 2.0},
    "dark_clutter": {"f_cam": 0.3, "f_proj": 0.6},
}
# The same by default, as the scorer runs it. What bends a line says less about the camera's principal point when lens and
# sheet are unknown, and its focal length moves with it. But in these scenes everything is where it is expected, so that the
# error is to be a small part of sigma, which is nearly all expectation.
DEFAULT_BOUNDS = {
    ("paper_tilted", "one photo"): {"z_cam": 0.2, "f_proj": 0.1},
    ("paper_tilted", "with screen"): {"z_cam": 0.2, "f_proj": 0.1},
    ("paper_lensshift", "one photo"): {"z_cam": 0.2, "f_proj": 0.1, "cy_proj": 2.0},
    ("dark_clutter", "one photo"): {"z_cam": 0.2, "f_proj": 0.6},
}
# Sigma of the focal lengths of camera and projector by name, per cent, as they were when `auto` chose these models: (scenes,
# principal points exact). No other assumption may make them larger or smaller by more than the factor.
NAMED_SIGMAS = {
    ("paper_tilted", False): (2.229, 1.542),
    ("paper_tilted", True): (0.0015, 0.0059),
    ("paper_lensshift", False): (2.229, 1.812),
    ("paper_lensshift", True): (0.0023, 0.0088),
    ("near_frontal", False): (31.78, 5.421),
    ("near_frontal", True): (0.1045, 0.0321),
    ("dark_clutter", False): (2.851, 1.536),
    ("dark_clutter", True): (0.0123, 0.0148),
    ("pair_a", False): (0.0556, 2.027),
    ("pair_a", True): (0.0086, 0.0145),
    ("pair_b", False): (0.0654, 4.175),
    ("pair_b", True): (0.0074, 0.0218),
    ("pair_a+pair_b", False): (0.0055, 0.0091),
    ("pair_a+pair_b", True): (0.0053, 0.0087),
}
SIGMA_FACTOR = 1.2
# Sigma of the camera's focal length from one photograph of a pair, principal points by default, per cent, at most.
ALONE_SIGMA_PERCENT = {FLAT: 1.1, DEFAULT: 1.6}
# The sheet seen 3 degrees off face-on with exact principal points, focal length error in per cent, at most.
NEAR_FRONTAL_BOUND_PERCENT = 1.0
# Focal length of the same photograph at half and at double size, per cent, at most.
SCALE_BOUND_PERCENT = 0.3
# Errors in units of their own sigma, and residuals of every rendered photograph in px: at most.
SIGMAS_BOUND = 3.0
RMS_BOUND_PX = 0.1
# Scenes whose true principal points lie where they are expected by default.
PAPER_SCENES = ("paper_tilted", "paper_lensshift")
PAPER_BASELINE_PERCENT = 0.1
PAPER_CY_PX = 2.0
# Both poses together: errors of focal lengths in per cent and of principal points in px, (camera, projector), at most. By
# default the bend of each sheet is unknown, and principal points are known to half a pixel only: sigma judges them.
PAIR_PERCENT = {BY_NAME: (0.03, 0.2), FLAT: (0.008, 0.008), DEFAULT: (0.05, 0.05)}
PAIR_PP_PX = {BY_NAME: (0.6, 0.6), FLAT: (0.2, 0.35)}
# Sigma of both focal lengths from both poses, per cent, at most.
PAIR_SIGMA_PERCENT = 0.11


def options_of(model, scene):
    """Options of the command for a model; by name with the lens that the scene has."""
    named = ("--distortion", "k1k2" if scene.startswith("pair") else "none", "--projector-distortion", "none")
    return {BY_NAME: ("--flatness", "flat", *named), FLAT: ("--flatness", "flat"), DEFAULT: ()}[model]


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
    for (scene, photos), bounds in DEFAULT_BOUNDS.items():
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


def check_models(table, ctx):
    """Rigs alone and of the pair under every model, from one photograph and with the dark one, principal points by default and
    exact, each beside the bounds that its model has."""
    for scenes in [[s] for s in SCENES] + [["pair_a", "pair_b"]]:
        for screen, exact, model in itertools.product((False, True), (False, True), (BY_NAME, FLAT, DEFAULT)):
            check_model(table, ctx, scenes, screen, exact, model)


def check_model(table, ctx, scenes, screen, exact, model):
    truth = ctx.truth_rig(scenes[0])
    more = [*options_of(model, scenes[0]), *(["--allow-degenerate"] if scenes == ["near_frontal"] else [])]
    if exact:
        points = {d: ",".join(str(truth[d]["K"][i][2]) for i in (0, 1)) for d in ("camera", "projector")}
        more += ["--camera-pp", points["camera"], "--projector-pp", points["projector"]]
    rig, code = calibrate_scenes(ctx, scenes, screen, more)
    what = f"{'+'.join(scenes)}{', screen' if screen else ''}, pp {'exact' if exact else 'default'}{'' if model == DEFAULT else ', ' + model}"
    if rig is None:
        table.row(f"{what}: calibrates", f"exit {code}", "exit 0, or 5 alone", code == 5 and len(scenes) == 1)
        return
    check_sigma(table, what, rig, truth)
    if len(scenes) > 1:
        check_pair(table, what, rig, truth, model)
    elif scenes[0].startswith("pair") and not exact and model in ALONE_SIGMA_PERCENT:
        table.at_most(f"{what}: sigma of f_cam", sigma_percent(rig, "camera"), ALONE_SIGMA_PERCENT[model], " %")
    if model == BY_NAME and not screen:
        check_named_sigma(table, what, rig, NAMED_SIGMAS["+".join(scenes), exact])
    if model == BY_NAME and not exact:
        check_named(table, what, rig, truth, NAMED_BOUNDS.get(scenes[0], {}))
    if scenes[0] in PAPER_SCENES and not screen and not exact and model != FLAT:
        base = math.hypot(*rig["projector_from_camera"]["t"]) / math.hypot(*truth["projector_from_camera"]["t"])
        table.at_most(f"{what}: baseline", 100 * (base - 1), PAPER_BASELINE_PERCENT, " %")
        table.at_most(f"{what}: cy_proj", errors_of(rig, truth, "projector", 1), PAPER_CY_PX, " px")


def errors_of(rig, truth, device, axis):
    return rig[device]["K"][axis][2] - truth[device]["K"][axis][2]


def percent_of(rig, truth, device):
    return 100 * (rig[device]["K"][0][0] / truth[device]["K"][0][0] - 1)


def sigma_percent(rig, device):
    return 100 * rig[device]["sigma"]["focal_px"] / rig[device]["K"][0][0]


def check_sigma(table, what, rig, truth):
    """Every error within three of its own sigma, and the residuals."""
    for name, (error, sigma) in errors_and_sigmas(rig, truth).items():
        table.at_most(f"{what}: {name} / sigma", error / sigma, SIGMAS_BOUND)
    for view in rig["views"]:
        for kind in ("edges", "corners"):
            table.at_most(f"{what}, {Path(view['photo']).parent.name}: rms of {kind}", view["rms_px"][kind], RMS_BOUND_PX, " px")


def check_named_sigma(table, what, rig, sigmas):
    for device, before in zip(("camera", "projector"), sigmas):
        share = sigma_percent(rig, device) / before
        table.between(f"{what}: sigma of the {device}'s f, share of before", share, 1 / SIGMA_FACTOR, SIGMA_FACTOR)


def check_named(table, what, rig, truth, bounds):
    found = {"f_cam": percent_of(rig, truth, "camera"), "f_proj": percent_of(rig, truth, "projector"), "cy_proj": errors_of(rig, truth, "projector", 1)}
    for figure, bound in bounds.items():
        table.at_most(f"{what}: {figure}", found[figure], bound)


def check_pair(table, what, rig, truth, model):
    for i, device in enumerate(("camera", "projector")):
        table.at_most(f"{what}: f of the {device}", percent_of(rig, truth, device), PAIR_PERCENT[model][i], " %")
        table.at_most(f"{what}: sigma of the {device}'s f", sigma_percent(rig, device), PAIR_SIGMA_PERCENT, " %")
        for axis, name in enumerate(("cx", "cy")):
            if model in PAIR_PP_PX:
                table.at_most(f"{what}: {name} of the {device}", errors_of(rig, truth, device, axis), PAIR_PP_PX[model][i], " px")


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


def resized_codes(factor, photo):
    """Another size as most programs make it, of codes instead of light: every edge moves towards the dark side."""
    from PIL import Image

    size = round(photo.width * factor), round(photo.height * factor)
    return photo.resize(size, Image.Resampling.BOX if factor < 1 else Image.Resampling.BICUBIC)


def resized_light(factor, photo):
    import numpy as np
    from PIL import Image

    return Image.fromarray(variants.scaled(factor, np.asarray(photo), None)[0])


def check_sizes(table, ctx):
    """Half and double size move the focal lengths by little: by name however the photograph was resized, by default when its
    edges stayed where they were. Where they did not, sigma must hold the error."""
    from PIL import Image

    scene = ctx.rendered / "paper_tilted"
    photo = Image.open(scene / "checker.png").convert("RGB")

    def rig_of(factor, resized, model):
        resized(factor, photo).save(ctx.tmp / "resized.png")
        out = ctx.tmp / "resized.json"
        more = ("--pattern", scene / "patterns/checker.json", *options_of(model, "paper_tilted"))
        r = calibrate(ctx.slcal, ctx.tmp / "resized.png", size_of(ctx.truth_rig("paper_tilted")), out, *more)
        return json.loads(out.read_text()) if r.returncode == 0 else None

    for model, resized in ((BY_NAME, resized_codes), (DEFAULT, resized_light)):
        whole = rig_of(1, resized, model)
        for factor in (0.5, 2):
            rig = rig_of(factor, resized, model)
            for device in ("camera", "projector"):
                share = rig[device]["K"][0][0] / whole[device]["K"][0][0] if whole and rig else None
                change = share and 100 * (share / (factor if device == "camera" else 1) - 1)
                table.at_most(f"paper_tilted at {factor:g} of its size, {model}: change of the {device}'s f", change, SCALE_BOUND_PERCENT, " %")
    for factor in (0.5, 2):
        rig = rig_of(factor, resized_codes, DEFAULT)
        errors = rig and errors_and_sigmas(rig, scaled_truth(ctx.truth_rig("paper_tilted"), factor))
        for name in ("f_cam", "f_proj", "baseline"):
            over_sigma = errors and errors[name][0] / errors[name][1]
            table.at_most(f"paper_tilted at {factor:g} of its size, its codes resized: {name} / sigma", over_sigma, SIGMAS_BOUND)


def scaled_truth(truth, factor):
    """The true rig of a photograph at another size; pixel centres: x' + 1/2 = factor (x + 1/2)."""
    k = truth["camera"]["K"]
    for axis in (0, 1):
        k[axis][axis] *= factor
        k[axis][2] = factor * (k[axis][2] + 0.5) - 0.5
    return truth


CHECKS = (check_scores, check_models, check_near_frontal, check_two_vp, check_sizes)


def check(table, ctx):
    for part in CHECKS:
        part(table, ctx)
