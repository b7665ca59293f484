"""Rigs calibrated from rendered photographs that have what real ones have: sheets that bend, lenses that are decentred,
channels that do not coincide, the camera's pipeline (the scenes real_*)."""

import statistics

from .calibration import PAIR_SIGMA_PERCENT, errors_and_sigmas, percent_of, sigma_percent
from .common import calibrate_scenes

PAIRS = ("real_one_curl", "real_one_decentred", "real_one_projector", "real_mild", "real_tang")
ALONE = (*(f"{pair}_{pose}" for pair in PAIRS for pose in "ab"), "real_wave", "real_board_a", "real_grid", "real_portrait0")
# Its projector is shifted sideways by 4 sigma of what is expected: one photograph cannot know that, and is judged on the camera.
CAMERA_ONLY = "real_tang"
FIGURES = ("f_cam", "f_proj", "cx_cam", "cy_cam", "cx_proj", "cy_proj", "baseline")
# Errors in units of their own sigma: every one at most, and the per cent of all that may lie beyond the lower bound.
SIGMAS_BOUND = 4.0
SIGMAS_USUAL = 3.0
BEYOND_USUAL_PERCENT = 1.0
# Sigma of the focal lengths and the median error of the camera's, per cent, at most.
ALONE_SIGMA_PERCENT = 1.6
ALONE_MEDIAN_PERCENT = 1.2
PAIR_MEDIAN_PERCENT = 0.08


def check_scenes(table, ctx, scenes, screen):
    """Checks one rig; the camera's focal length error in per cent (None: no rig) and the errors over sigma that were judged."""
    what = f"{'+'.join(scenes)}{', screen' if screen else ''}"
    rig, code = calibrate_scenes(ctx, scenes, screen)
    if rig is None:
        table.row(f"{what}: calibrates", f"exit {code}", "exit 0", False)
        return None, []
    truth = ctx.truth_rig(scenes[0])
    pair = len(scenes) > 1
    camera_only = scenes[0].startswith(CAMERA_ONLY) and not pair
    judged = {name: error / sigma for name, (error, sigma) in errors_and_sigmas(rig, truth).items() if name in FIGURES}
    judged = {name: z for name, z in judged.items() if not camera_only or name.endswith("_cam")}
    for name, z in judged.items():
        table.at_most(f"{what}: {name} / sigma", z, SIGMAS_BOUND)
    for device in ("camera", "projector") if pair else ("camera",):
        bound = PAIR_SIGMA_PERCENT if pair else ALONE_SIGMA_PERCENT
        table.at_most(f"{what}: sigma of the {device}'s f", sigma_percent(rig, device), bound, " %")
    error = percent_of(rig, truth, "camera")
    errors = "  ".join(f"{name} {z:+.1f}" for name, z in judged.items())
    print(f"     {what:38s} {error:+7.3f} ± {sigma_percent(rig, 'camera'):.3f} %  {rig['quality']['verdict']:5s} over sigma: {errors}", flush=True)
    return error, list(judged.values())


def check_set(table, ctx, what, sets, screen, median_bound):
    """One photograph each, or a pair each: the median error of the camera's focal length; all errors over sigma."""
    found = [check_scenes(table, ctx, scenes, screen) for scenes in sets]
    errors = [abs(error) for error, _ in found if error is not None]
    table.at_most(f"{what}: median error of f_cam", statistics.median(errors) if errors else None, median_bound, " %")
    return [z for _, judged in found for z in judged]


def check(table, ctx):
    alone = [[scene] for scene in ALONE]
    pairs = [[f"{pair}_a", f"{pair}_b"] for pair in PAIRS]
    judged = check_set(table, ctx, "real_*, one photograph", alone, False, ALONE_MEDIAN_PERCENT)
    judged += check_set(table, ctx, "real_*, pairs", pairs, False, PAIR_MEDIAN_PERCENT)
    beyond = 100 * sum(abs(z) > SIGMAS_USUAL for z in judged) / len(judged) if judged else None
    table.at_most(f"real_*: share of {len(judged)} errors beyond {SIGMAS_USUAL:g} sigma", beyond, BEYOND_USUAL_PERCENT, " %")
    # The same with a photograph of the dark projector where a scene has one.
    for scenes in alone + pairs:
        if not scenes[0].startswith("real_one"):
            check_scenes(table, ctx, scenes, True)
