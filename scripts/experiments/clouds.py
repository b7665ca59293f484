"""Clouds, depth maps and meshes: files, and the picture of heads in docs/experiments.md."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import figures

ROOT = Path(__file__).resolve().parents[2]
NUMPY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "uint": "<u4", "int": "<i4"}
# Where light comes from in the shaded pictures: from above and the left of the camera.
LIGHT = np.array([-0.4, -0.5, -0.77])


def read_ply(path):
    """Vertices as a structured array (N,), and (M, 3) triangles, of a binary PLY by slcal."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    fields, counts = [], {}
    for words in (line.split() for line in data[:end].decode().splitlines()):
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            fields.append((words[2], NUMPY_TYPES[words[1]]))
    vertices = np.frombuffer(data, fields, counts["vertex"], end)
    face = [("n", "u1"), ("v", "<i4", 3)]
    triangles = np.frombuffer(data, face, counts.get("face", 0), end + vertices.nbytes)
    return vertices, triangles["v"]


def read_pfm(path):
    """(H, W) float32, NaN where nothing is known."""
    with path.open("rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        order = "<" if float(file.readline()) < 0 else ">"
        rows = np.frombuffer(file.read(), f"{order}f4").reshape(height, width)
    return np.ascontiguousarray(rows[::-1].astype(np.float32))


def bilinear(plane, u, v):
    """Values of a (H, W) plane at positions (N,) within it, px."""
    x, y = (np.clip(np.floor(a).astype(int), 0, n - 2) for a, n in ((u, plane.shape[1]), (v, plane.shape[0])))
    right, down = u - x, v - y
    upper = (1 - right) * plane[y, x] + right * plane[y, x + 1]
    lower = (1 - right) * plane[y + 1, x] + right * plane[y + 1, x + 1]
    return (1 - down) * upper + down * lower


def write_obj(path, points, triangles):
    """(N, 3) points and (M, 3) triangles, counted from 0."""
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in points]
    lines += [f"f {a} {b} {c}" for a, b, c in triangles + 1]
    path.write_text("\n".join(lines) + "\n")


def grid_mesh(depth, inside, k, step):
    """Points and triangles of a depth map, a point every `step` px where `inside` holds."""
    v, u = np.mgrid[0 : depth.shape[0] : step, 0 : depth.shape[1] : step]
    z, known = depth[::step, ::step], inside[::step, ::step]
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(k).T
    number = np.cumsum(known).reshape(known.shape) - 1
    a, b, c, d = (number[i : i - 1 or None, j : j - 1 or None] for i in (0, 1) for j in (0, 1))
    whole = known[:-1, :-1] & known[:-1, 1:] & known[1:, :-1] & known[1:, 1:]
    triangles = [np.stack(corners, axis=-1)[whole] for corners in ((a, c, b), (b, c, d))]
    return (rays * z[..., None])[known], np.concatenate(triangles)


def head_figure(path, ways):
    """Clouds of the head as shaded meshes seen from the camera, above their errors; ways: {name: (u, v, points, triangles, error in mm),
    NaN where a point is not counted}."""
    figure, axes = plt.subplots(2, len(ways), figsize=(5.6, 8.2), layout="constrained", sharex=True, sharey=True)
    for column, (name, (u, v, points, triangles, off)) in zip(axes.T, ways.items()):
        known = np.isfinite(off)
        triangles = triangles[known[triangles].all(axis=1)]
        at = points[triangles]
        normal = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        shade = np.abs(normal @ LIGHT) / np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
        # A mesh in the photograph's coordinates.
        options = {"antialiased": False, "rasterized": True, "edgecolors": "none"}
        column[0].tripcolor(u, v, triangles, facecolors=shade, cmap="gray", vmin=0, vmax=1, **options)
        column[0].set_title(f"{name}: {known.sum()} points", fontsize=10)
        dots = column[1].scatter(u[known], v[known], c=off[known], s=0.8, cmap="coolwarm", vmin=-0.5, vmax=0.5, lw=0)
        column[1].set_xlim(u[known].min() - 20, u[known].max() + 20)
        column[1].set_ylim(v[known].max() + 20, v[known].min() - 20)
    for axis in axes.ravel():
        axis.set_aspect("equal")
        axis.set_facecolor("#202020")
        axis.set_xticks([])
        axis.set_yticks([])
    bar = figure.colorbar(dots, ax=axes, label="depth less the truth, mm", location="bottom", shrink=0.6, aspect=40)
    bar.ax.tick_params(labelsize=8)
    figures.save(figure, path)
    # Shades of noise compress badly: a palette makes the file a third.
    Image.open(path).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)
