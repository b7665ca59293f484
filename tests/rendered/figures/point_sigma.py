"""Errors of points along the camera's ray in units of their own sigma, with the true rig."""

import json

import numpy as np

from . import truth as truths
from . import variants
from .common import STRIPED_SCENES, run

# Per cent of the points within one and within two sigma. A normal distribution has 68.3 and 95.4.
WITHIN_ONE = (66.0, 70.0)
WITHIN_TWO = (94.0, 96.0)
BOUNDED = ("stripes_plane_a", "stripes_plane_b")
SHOWN = (*BOUNDED, "stripes_sphere", "stripes_step")


def shares(errors):
    """Per cent within one and two, and the robust spread and median of errors in units of their sigma."""
    size = np.abs(errors)
    centre = np.median(errors)
    return 100 * (size < 1).mean(), 100 * (size < 2).mean(), 1.4826 * np.median(np.abs(errors - centre)), centre


def errors_of(ctx, scene, view, variant):
    """Errors over sigma beside the truth and beside a plane fitted to the points, or None."""
    folder, cloud = ctx.rendered / scene, ctx.tmp / "sigma.ply"
    photo = folder / f"{view}.png"
    if variant != "as rendered":
        photo = variants.write(variants.make(variant, photo, None)[0], ctx.tmp / "sigma.png")
    rig = folder / "truth_rig.json"
    r = run(ctx.slcal, "reconstruct", "--rig", rig, "--pattern", folder / "patterns/stripes.json", photo, "-o", cloud, "--force")
    if r.returncode:
        return None
    points, sigma = truths.read_cloud(cloud)
    on, true = truths.points_on_object(truths.load(ctx.shared, folder, view), points, json.loads(rig.read_text())["camera"])
    points, sigma = points[on], sigma[on]
    ray = points / np.linalg.norm(points, axis=1)[:, None]
    beside_truth = ((points - true) * ray).sum(1) / sigma
    centre, normal, _ = truths.fit_plane(points)
    return beside_truth, ((points - centre) @ normal) / (ray @ normal) / sigma, np.median(sigma)


def check(table, ctx):
    print(f"     {'':56s} < 1 sigma  < 2 sigma   spread   median")
    for scene in STRIPED_SCENES:
        for variant in ("as rendered", "noise 3"):
            for view in SHOWN:
                what = f"{scene}, {view[8:]}, {variant}"
                found = errors_of(ctx, scene, view, variant)
                if found is None:
                    if view in BOUNDED:
                        table.row(f"{what}: reconstructs", "no cloud", "exit 0", False)
                    continue
                beside_truth, beside_plane, sigma = found
                kinds = {"truth": beside_truth, "fitted plane": beside_plane} if view in BOUNDED else {"truth": beside_truth}
                for kind, errors in kinds.items():
                    one, two, spread, median = shares(errors)
                    print(f"     {what + ', beside the ' + kind:56s} {one:8.1f} % {two:8.1f} % {spread:8.2f} {median:8.2f}   sigma {sigma:.4f} mm")
                if view in BOUNDED:
                    one, two, *_ = shares(beside_truth)
                    table.between(f"{what}: errors within one sigma", one, *WITHIN_ONE, " %")
                    table.between(f"{what}: errors within two sigma", two, *WITHIN_TWO, " %")
