"""Rigs as arrays, what they predict, and how far they are from the truth."""

import json
from dataclasses import dataclass, field

import cv2
import numpy as np


@dataclass
class Rig:
    """camera and projector intrinsics, X_projector = R X_camera + t, and camera-from-sheet (R, t) of each view."""

    camera_k: np.ndarray
    camera_d: np.ndarray
    projector_k: np.ndarray
    projector_d: np.ndarray
    rotation: np.ndarray
    translation: np.ndarray
    views: list = field(default_factory=list)
    focal_sigma: tuple = None
    verdict: str = None

    @staticmethod
    def from_json(text):
        j = json.loads(text)
        a = np.array
        stereo = j["projector_from_camera"]
        views = [(a(v["camera_from_sheet"]["R"]), a(v["camera_from_sheet"]["t"])) for v in j["views"]]
        return Rig(
            a(j["camera"]["K"]), a(j["camera"]["distortion"], float),
            a(j["projector"]["K"]), a(j["projector"]["distortion"], float),
            a(stereo["R"]), a(stereo["t"]), views,
            tuple(j[d]["sigma"]["focal_px"] for d in ("camera", "projector")) if j["camera"].get("sigma") else None,
            (j.get("quality") or {}).get("verdict"),
        )  # fmt: skip


def pixels(points, k, d):
    """(N, 3) points in a device's frame -> (N, 2) pixels."""
    return cv2.projectPoints(points.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), k, d)[0].reshape(-1, 2)


def bearings(px, k, d):
    """(N, 2) pixels -> (N, 3) directions (x, y, 1); the distortion is undone by fixed-point iteration (OpenCV's own stops
    after a few steps, and its name depends on the version)."""
    seen = (np.column_stack([px, np.ones(len(px))]) @ np.linalg.inv(k).T)[:, :2]
    k1, k2, p1, p2, k3 = d[:5]
    x = seen.copy()
    for _ in range(50):
        r2 = (x**2).sum(1)
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        xy = x[:, 0] * x[:, 1]
        bent = [2 * p1 * xy + p2 * (r2 + 2 * x[:, 0] ** 2), p1 * (r2 + 2 * x[:, 1] ** 2) + 2 * p2 * xy]
        x = (seen - np.column_stack(bent)) / radial[:, None]
    return np.column_stack([x, np.ones(len(x))])


def onto_plane(origin, directions, pose):
    """Where rays meet the sheet at pose (R, t), in the frame of the rays."""
    normal, t = pose[0][:, 2], pose[1]
    s = (normal @ (t - origin)) / (directions @ normal)
    return origin + directions * s[:, None]


def reprojection(rig, pose, view):
    """rms distances of one view's observations from a rig's prediction: the sheet's and the projected corners in the camera
    (camera px), and the projected corners carried over the sheet into the projector (projector px)."""
    width, height = view["size_mm"]
    sheet = np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]], float)
    pairs = np.array([p[:4] for p in view["pairs"]], float)
    r, t = rig.rotation, rig.translation
    corners = pixels(sheet @ pose[0].T + pose[1], rig.camera_k, rig.camera_d)
    lit = onto_plane(-r.T @ t, bearings(pairs[:, 2:], rig.projector_k, rig.projector_d) @ r, pose)
    seen = pixels(lit, rig.camera_k, rig.camera_d)
    off = np.vstack([corners - np.array(view["sheet_corners_px"], float)[:, :2], seen - pairs[:, :2]])
    onto = onto_plane(np.zeros(3), bearings(pairs[:, :2], rig.camera_k, rig.camera_d), pose)
    carried = pixels(onto @ r.T + t, rig.projector_k, rig.projector_d)
    rms = lambda d: float(np.sqrt((d**2).sum(1).mean()))
    return rms(off), rms(carried - pairs[:, 2:])


def volume(truth, count=400):
    """Points at the sheet's distance and up to 200 mm before it and 100 mm behind it that both devices see."""
    rng = np.random.default_rng(0)
    distance = np.mean([v[1][2] + v[0][2, :2] @ [297, 210] for v in truth.views])
    box = rng.uniform([-300, -210, -200], [300, 210, 100], (count, 3))
    return box + [0, 0, distance]


def triangulated(rig, camera_px, projector_px):
    """(N, 3) points nearest to both rays of every correspondence, in the camera's frame."""
    a = bearings(camera_px, rig.camera_k, rig.camera_d)
    b = bearings(projector_px, rig.projector_k, rig.projector_d) @ rig.rotation
    c = -rig.rotation.T @ rig.translation
    aa, bb, ab = (a * a).sum(1), (b * b).sum(1), (a * b).sum(1)
    ac, bc = a @ c, b @ c
    s = (ac * bb - ab * bc) / (aa * bb - ab**2)
    u = (ab * ac - aa * bc) / (aa * bb - ab**2)
    return (a * s[:, None] + c + b * u[:, None]) / 2


def against_truth(rig, truth):
    """Errors of a rig: focal lengths and baseline in per cent; rms distance in mm of points in space that were not used for
    calibrating, triangulated from exact pixels, in the camera's frame, and after the best rigid motion (their shape)."""
    points = volume(truth)
    camera_px = pixels(points, truth.camera_k, truth.camera_d)
    projector_px = pixels(points @ truth.rotation.T + truth.translation, truth.projector_k, truth.projector_d)
    found = triangulated(rig, camera_px, projector_px)
    x, y = found - found.mean(0), points - points.mean(0)
    u, _, vt = np.linalg.svd(x.T @ y)
    turn = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    rms = lambda d: float(np.sqrt((d**2).sum(1).mean()))
    percent = lambda a, b: 100 * (a / b - 1)
    focal = lambda k: (k[0, 0] + k[1, 1]) / 2
    inside = [
        abs(focal(k) - focal(true)) < 1.96 * sigma
        for k, true, sigma in zip(
            (rig.camera_k, rig.projector_k), (truth.camera_k, truth.projector_k), rig.focal_sigma or ()
        )
    ]
    return {
        "verdict": rig.verdict,
        "inside": inside,
        "f_cam": percent(focal(rig.camera_k), focal(truth.camera_k)),
        "f_proj": percent(focal(rig.projector_k), focal(truth.projector_k)),
        "baseline": percent(np.linalg.norm(rig.translation), np.linalg.norm(truth.translation)),
        "points_mm": rms(found - points),
        "shape_mm": rms(x @ turn - y),
    }
