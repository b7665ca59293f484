"""Planes and spheres of own clouds: the rig from one photograph, then a photograph of stripes."""

import json

import numpy as np

from . import truth as truths
from .common import STRIPED_SCENES, run

# Mean distance of a plane's points from the plane fitted to them, per cent of their distance from the camera, at most.
PLANE_PERCENT = 0.05
RADIUS_PERCENT = 0.5


def cloud_of(ctx, scene, view, rig):
    """The file of a cloud, or None."""
    folder, out = ctx.rendered / scene, ctx.tmp / "cloud.ply"
    r = run(ctx.slcal, "reconstruct", "--rig", rig, "--pattern", folder / "patterns/stripes.json", folder / f"{view}.png", "-o", out, "--force")
    return out if r.returncode == 0 else None


def evaluated(ctx, shape, cloud):
    r = run(ctx.slcal, "evaluate", shape, cloud, "--json")
    return json.loads(r.stdout) if r.returncode == 0 else None


def check_plane(table, ctx, scene, view, rig):
    what = f"{scene}, {view[8:]}, own rig: distance to the plane"
    cloud = cloud_of(ctx, scene, view, rig)
    fit = evaluated(ctx, "plane", cloud) if cloud else None
    table.at_most(what, fit and fit["mean_percent"], PLANE_PERCENT, " %")
    percent = None
    if cloud:
        points, _ = truths.read_cloud(cloud)
        on, _ = truths.points_on_object(truths.load(ctx.shared, ctx.rendered / scene, view), points, json.loads(rig.read_text())["camera"])
        points = points[on]
        centre, normal, _ = truths.fit_plane(points)
        percent = 100 * np.abs((points - centre) @ normal).mean() / np.linalg.norm(points, axis=1).mean()
    table.at_most(f"{what}, every point of the object", percent, PLANE_PERCENT, " %")


def check_sphere(table, ctx, scene, view, rig):
    what = f"{scene}, {view[8:]}, own rig: radius"
    truth = truths.load(ctx.shared, ctx.rendered / scene, view)
    _, true = truths.fit_sphere(truth.xyz[truth.obj & np.isfinite(truth.xyz).all(-1)].astype(float))
    cloud = cloud_of(ctx, scene, view, rig)
    fit = evaluated(ctx, "sphere", cloud) if cloud else None
    table.at_most(what, fit and 100 * (fit["sphere"]["radius_mm"] / true - 1), RADIUS_PERCENT, " %")
    error = None
    if cloud:
        points, _ = truths.read_cloud(cloud)
        on, _ = truths.points_on_object(truth, points, json.loads(rig.read_text())["camera"])
        error = 100 * (truths.fit_sphere(points[on])[1] / true - 1)
    table.at_most(f"{what}, every point of the object", error, RADIUS_PERCENT, " %")


def check(table, ctx):
    for scene in STRIPED_SCENES:
        rig = ctx.own_rig(scene)
        if rig is None:
            table.row(f"{scene}: calibrates from one photograph", "no rig", "exit 0", False)
            continue
        for view in ("stripes_plane_a", "stripes_plane_b"):
            check_plane(table, ctx, scene, view, rig)
        check_sphere(table, ctx, scene, "stripes_sphere", rig)
