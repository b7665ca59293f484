"""Real photographs of a sheet with a published calibration: the camera alone."""

import json

from .common import run

SIGMAS_BOUND = 3.0
REAL_FOCAL_PX = 701.0
REAL_BOUND_PERCENT = 3.0
REAL_TOGETHER_PERCENT = 1.0
REAL_K1 = -0.256
REAL_K1_BOUND = 0.05
# The order of photographs changes nothing but rounding.
ORDER_BOUND = 1e-6
REAL_TILTED = ["02", "07", "10", "11", "12"]
REAL_FACE_ON = ["01", "03"]


def check(table, ctx):
    photos = ctx.shared / "data/real/sony_sheet"
    out = ctx.tmp / "real.json"

    def rig_of(numbers):
        r = run(ctx.slcal, "calibrate", *(photos / f"frame{n}.jpg" for n in numbers), "--size", "279.4x215.9mm", "-o", out, "--force")
        return (json.loads(out.read_text()) if r.returncode == 0 else None), r.returncode

    def focal(what, rig, bound):
        error = rig["camera"]["K"][0][0] - REAL_FOCAL_PX if rig else None
        sigma = rig["camera"]["sigma"]["focal_px"] if rig else None
        table.at_most(f"{what}: f_cam", 100 * error / REAL_FOCAL_PX if rig else None, bound, " %")
        table.at_most(f"{what}: f_cam / sigma", error / sigma if rig else None, SIGMAS_BOUND)

    for number in REAL_TILTED:
        focal(f"real sheet {number}", rig_of([number])[0], REAL_BOUND_PERCENT)
    for number in REAL_FACE_ON:
        rig, code = rig_of([number])
        verdict = rig["quality"]["verdict"] if rig else f"exit {code}"
        # A photograph that is refused is not called good either: nothing found (4), nothing determined (5).
        table.row(f"real sheet {number}, seen face-on", verdict, "not good", verdict in ("fair", "weak", "exit 4", "exit 5"))
    together, _ = rig_of(REAL_TILTED)
    focal("real sheets together", together, REAL_TOGETHER_PERCENT)
    k1 = together["camera"]["distortion"][0] - REAL_K1 if together else None
    table.at_most("real sheets together: k1", k1, REAL_K1_BOUND)
    backwards, _ = rig_of(REAL_TILTED[::-1])
    change = backwards["camera"]["K"][0][0] / together["camera"]["K"][0][0] - 1 if together and backwards else None
    table.at_most("real sheets in reverse order: relative change of f", change, ORDER_BOUND)
