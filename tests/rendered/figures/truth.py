"""The truth of a striped view, as the scorer reads it, and matches and clouds beside it."""

import csv
import functools
import importlib.util
import json
from pathlib import Path

import numpy as np

# Neighbouring pixels of one surface lie no further apart than this, mm; as the scorer has it.
SAME_SURFACE_MM = 20.0


@functools.cache
def scorer(shared):
    """The scorer as a module."""
    spec = importlib.util.spec_from_file_location("score_rendered", Path(shared) / "tools/score_rendered.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def load(shared, scene, view):
    """The scorer's Truth of `scene` (a folder) and `view` (a name such as stripes_blob)."""
    pattern = json.loads((scene / "patterns/stripes.json").read_text())
    return scorer(shared).Truth(scene / "truth" / f"{view}.npz", pattern)


def read_matches(path):
    """N x 3: u, v and the projector's coordinate."""
    with open(path, newline="") as file:
        rows = [(float(r["u"]), float(r["v"]), float(r["projector_column"])) for r in csv.DictReader(file)]
    return np.array(rows).reshape(-1, 3)


def score_matches(truth, crossings, matches):
    """Counted as the scorer counts: per cent right and found, bias and rms in projector px. `matches` lie in the pixels of the
    truth; `crossings` are those that could be found."""
    half_period = np.median(np.diff(np.sort(truth.centres))) / 2
    judged, right, errors, seen = 0, 0, [], set()
    for u, v, column in matches:
        at = truth.at(v, u)
        if at is None:
            continue
        row = int(round(v))
        if not np.isfinite(at[0]):  # at the border of the light: no verdict; in the dark: wrong
            near = truth.col[truth.index[row], max(int(u) - 3, 0) : int(u) + 5]
            judged += not np.isfinite(near).any()
            continue
        judged += 1
        if abs(column - at[0]) < half_period:
            right += 1
            if at[1]:
                errors.append(column - at[0])
                seen.add((row, int(np.argmin(np.abs(truth.centres - column)))))
    hit = sum((row, slit) in seen for row, _, slit in crossings)
    errors = np.array(errors) if errors else np.array([np.nan])
    return {
        "matches": judged,
        "right": 100 * right / max(judged, 1),
        "found": 100 * hit / max(len(crossings), 1),
        "bias": float(errors.mean()),
        "rms": float(np.sqrt((errors**2).mean())),
    }


def read_cloud(path):
    """Points, N x 3 in mm, and their sigma along the camera's ray."""
    from plyfile import PlyData

    v = PlyData.read(path)["vertex"]
    return np.stack([v["x"], v["y"], v["z"]], 1).astype(float), np.asarray(v["sigma"], float)


def points_on_object(truth, points, camera):
    """Indices of the points that lie in rows of known truth on the object, and the true point of each one's pixel."""
    u, v = truth.project(points, camera)
    rows = np.array([truth.index.get(int(round(r)), -1) if np.isfinite(r) and abs(r - round(r)) < 0.1 else -1 for r in v])
    left = np.floor(np.nan_to_num(u, nan=-1.0)).astype(int)
    at = np.nonzero((rows >= 0) & (left >= 0) & (left < truth.col.shape[1] - 1))[0]
    i, a, w = rows[at], left[at], (u[at] - left[at])[:, None]
    p, q = truth.xyz[i, a].astype(float), truth.xyz[i, a + 1].astype(float)
    true = (1 - w) * p + w * q
    good = np.isfinite(true).all(1) & (np.linalg.norm(p - q, axis=1) <= SAME_SURFACE_MM) & truth.obj[i, a] & truth.obj[i, a + 1]
    return at[good], true[good]


def fit_plane(points):
    """A point of the plane and its unit normal: least squares, without what lies beyond four robust sigma."""
    keep = np.ones(len(points), bool)
    for _ in range(10):
        centre = points[keep].mean(0)
        normal = np.linalg.svd(points[keep] - centre, full_matrices=False)[2][2]
        distance = np.abs((points - centre) @ normal)
        keep = distance <= 4 * 1.4826 * np.median(distance)
    return centre, normal, keep


def fit_sphere(points):
    """Centre and radius: least squares, without what lies beyond four robust sigma."""
    keep = np.ones(len(points), bool)
    for _ in range(10):
        p = points[keep]
        mean = p.mean(0)
        a = np.column_stack([2 * (p - mean), np.ones(len(p))])
        x = np.linalg.lstsq(a, ((p - mean) ** 2).sum(1), rcond=None)[0]
        centre, radius = x[:3] + mean, float(np.sqrt(x[3] + x[:3] @ x[:3]))
        distance = np.abs(np.linalg.norm(points - centre, axis=1) - radius)
        keep = distance <= 4 * 1.4826 * np.median(distance)
    return centre, radius
