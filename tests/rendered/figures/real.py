"""Real photographs of a sheet with a published calibration, the camera alone, and measurements of a real rig."""

import json
import math

from .common import run

SIGMAS_BOUND = 3.0
REAL_FOCAL_PX = 701.01
REAL_BOUND_PERCENT = 3.0
REAL_TOGETHER_PERCENT = 1.0
REAL_K1 = -0.256
REAL_K1_BOUND = 0.05
# The order of photographs changes nothing but rounding.
ORDER_BOUND = 1e-6
REAL_TILTED = ["02", "07", "10", "11", "12"]
# Tilted less than those, and nearly face-on.
REAL_WEAK = ["06"]
REAL_FACE_ON = ["01", "03"]
# A rig called good or fair lies no further from the published focal length, in units of its own sigma; the root mean square
# of the tilted ones' errors in that unit lies between these.
CALLED_GOOD_SIGMAS = 3.5
RMS_OF_SIGMAS = (0.4, 1.6)
# OpenCV's camera on the printed boards of the rig's five poses; residuals in px, at most.
STACK_FOCAL_PX = 3450.7
STACK_RMS_PX = 0.5


def rig_of(ctx, *command):
    """The rig, or None, and the exit code."""
    out = ctx.tmp / "real.json"
    r = run(ctx.slcal, "calibrate", *command, "-o", out, "--force")
    return (json.loads(out.read_text()) if r.returncode == 0 else None), r.returncode


def sheets(ctx, numbers):
    photos = ctx.shared / "data/real/sony_sheet"
    return rig_of(ctx, *(photos / f"frame{n}.jpg" for n in numbers), "--size", "279.4x215.9mm")


def over_sigma(rig, true):
    """Error of the camera's focal length over its sigma; None without a rig."""
    return rig and (rig["camera"]["K"][0][0] - true) / rig["camera"]["sigma"]["focal_px"]


def focal(table, what, rig, bound):
    percent = rig and 100 * (rig["camera"]["K"][0][0] / REAL_FOCAL_PX - 1)
    table.at_most(f"{what}: f_cam", percent, bound, " %")
    table.at_most(f"{what}: f_cam / sigma", over_sigma(rig, REAL_FOCAL_PX), SIGMAS_BOUND)


def called_good(table, what, rig, true):
    """What is called good or fair is right within its sigma; anything else promises nothing."""
    if rig and rig["quality"]["verdict"] in ("good", "fair"):
        table.at_most(f"{what}, called {rig['quality']['verdict']}: f_cam / sigma", over_sigma(rig, true), CALLED_GOOD_SIGMAS)


def check_alone(table, ctx):
    errors = []
    for number in [*REAL_TILTED, *REAL_WEAK, *REAL_FACE_ON]:
        rig, code = sheets(ctx, [number])
        called_good(table, f"real sheet {number}", rig, REAL_FOCAL_PX)
        if number in REAL_FACE_ON:
            verdict = rig["quality"]["verdict"] if rig else f"exit {code}"
            # A photograph that is refused is not called good either: nothing found (4), nothing determined (5).
            table.row(f"real sheet {number}, seen face-on", verdict, "not good", verdict in ("fair", "weak", "exit 4", "exit 5"))
            continue
        if number in REAL_TILTED:
            focal(table, f"real sheet {number}", rig, REAL_BOUND_PERCENT)
        errors.append(over_sigma(rig, REAL_FOCAL_PX))
    rms = None if None in errors else math.sqrt(sum(e**2 for e in errors) / len(errors))
    table.between("real sheets, each tilted one alone: rms of error / sigma", rms, *RMS_OF_SIGMAS)


def check_together(table, ctx):
    together, _ = sheets(ctx, REAL_TILTED)
    focal(table, "real sheets together", together, REAL_TOGETHER_PERCENT)
    k1 = together["camera"]["distortion"][0] - REAL_K1 if together else None
    table.at_most("real sheets together: k1", k1, REAL_K1_BOUND)
    backwards, _ = sheets(ctx, REAL_TILTED[::-1])
    change = backwards["camera"]["K"][0][0] / together["camera"]["K"][0][0] - 1 if together and backwards else None
    table.at_most("real sheets in reverse order: relative change of f", change, ORDER_BOUND)
    focal(table, "all eight real sheets together", sheets(ctx, sorted(REAL_TILTED + REAL_WEAK + REAL_FACE_ON))[0], REAL_TOGETHER_PERCENT)


def check_stack(table, ctx):
    """Five poses of a real rig from its measurements: they lie far from where the estimator starts."""
    rig, code = rig_of(ctx, "--observations", ctx.shared / "data/real/gray_stack/observations_5.json")
    if rig is None:
        table.row("real rig of five poses: calibrates", f"exit {code}", "exit 0", False)
        return
    for kind in ("edges", "corners", "projector"):
        worst = max(view["rms_px"][kind] for view in rig["views"])
        table.at_most(f"real rig of five poses, the worst: rms of {kind}", worst, STACK_RMS_PX, " px")
    called_good(table, "real rig of five poses", rig, STACK_FOCAL_PX)


def check(table, ctx):
    for part in (check_alone, check_together, check_stack):
        part(table, ctx)
