"""The head of `slcal demo` by stripes, Gray code and phase shift: photographs, points, errors against the truth, time."""

import json
import os

import cv2
import numpy as np
from matplotlib.tri import LinearTriInterpolator, Triangulation

import clouds

# What: (pattern of the scene; None for stripes, else options of `slcal pattern`).
WAYS = {
    "stripes": None,
    "gray": "gray --axis columns",
    "phase": "phase --axis columns",
}
SEED = 1
LIGHT = "--noise 2 --blur 0.6 --projector-blur 0.5 --ambient 0.03 --exposure 0.22"
# Everything behind is the wall, mm.
BEHIND_HEAD = 1300.0
# Stripes are 18 px apart in the photograph of the head: σ of what smooths the triangles between them.
SMOOTH_PX = 8.0
# Pixels nearer to the outline of a surface see two surfaces.
OUTLINE_PX = 3
# An error above this, mm, is no noise: a stripe or period was mistaken, or the pixel sees two surfaces.
GROSS_MM = 5.0
REPEATS = 3


def surface(folder, rig):
    """Writes the demonstration's head as a mesh in the camera's frame: its cloud of stripes, smoothed and filled between them."""
    vertices, _ = clouds.read_ply(folder / "demo_head.ply")
    vertices = vertices[vertices["z"] < BEHIND_HEAD]
    points = np.column_stack([vertices[a] for a in "xyz"]).astype(float)
    k, size = np.array(rig["camera"]["K"]), (rig["camera"]["height"], rig["camera"]["width"])
    u, v = np.rint((points @ k.T)[:, :2] / points[:, 2:]).astype(int).T
    seen = np.zeros(size, np.uint8)
    seen[v, u] = 1
    net = Triangulation(u, v)
    rows, columns = np.mgrid[0 : size[0], 0 : size[1]]
    filled = LinearTriInterpolator(net, points[:, 2])(columns, rows)
    known = ~np.ma.getmaskarray(filled)
    weight = cv2.GaussianBlur(known.astype(float), (0, 0), SMOOTH_PX)
    depth = cv2.GaussianBlur(filled.filled(0.0), (0, 0), SMOOTH_PX) / np.maximum(weight, 1e-12)
    wide = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (61, 61))
    inside = cv2.morphologyEx(seen, cv2.MORPH_CLOSE, wide)
    narrow = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (25, 25))
    inside = cv2.morphologyEx(inside, cv2.MORPH_OPEN, narrow) > 0
    clouds.write_obj(folder / "head.obj", *clouds.grid_mesh(depth, inside, k, step=2))


def processor_seconds(slcal, line):
    """Median of processor time of the command, s, and what it printed."""
    times = []
    for _ in range(REPEATS):
        before = os.times()
        out = slcal(line).stdout
        after = os.times()
        times.append(after.children_user + after.children_system - before.children_user - before.children_system)
    return float(np.median(times)), out


def errors(scene, cloud, rig):
    """Depths less the truth, mm, and the points' own σ, mm, of all points on the head that are not at its outline; and the share of its
    lit pixels that have a point."""
    truth = clouds.read_pfm(scene / "truth_depth.pfm")
    kind = cv2.imread(str(scene / "truth_surface.png"), cv2.IMREAD_UNCHANGED)
    lit = np.isfinite(clouds.read_pfm(scene / "truth_column.pfm"))
    head = (kind == 1) & lit
    inner = cv2.erode(head.astype(np.uint8), np.ones((2 * OUTLINE_PX + 1,) * 2, np.uint8)) > 0
    vertices, triangles = clouds.read_ply(cloud)
    points = np.column_stack([vertices[a] for a in "xyz"]).astype(float)
    u, v = ((points @ np.array(rig["camera"]["K"]).T)[:, :2] / points[:, 2:]).T
    near = np.rint(v).astype(int), np.rint(u).astype(int)
    there = clouds.bilinear(truth, u, v)
    on = inner[near]
    covered = np.zeros_like(head)
    covered[near] = True
    return {
        "off": (points[:, 2] - there)[on],
        "sigma": vertices["sigma"][on],
        "on_head": int(head[near].sum()),
        "covered": (covered & head).sum() / head.sum(),
        "picture": (u, v, points, triangles, np.where(on, points[:, 2] - there, np.nan)),
    }


def experiment(slcal, folder):
    """The table; writes the picture beside it."""
    slcal(f"demo --out {folder}/demo --force")
    rig_file = clouds.ROOT / "crates/slcal-cli/demo/truth_rig.json"
    rig = json.loads(rig_file.read_text())
    stripes = f"--rig {rig_file} --pattern {folder}/demo/stripes.json"
    slcal(f"reconstruct {stripes} {folder}/demo/head.jpg -o {folder}/demo_head.ply --force")
    surface(folder, rig)
    lines = [
        "| way | photographs | points on the head | share of its lit pixels | rms error, mm | σ, mm | error within 1σ, % "
        f"| off by more than {GROSS_MM:g} mm | processor time, s |",
        "|---" * 9 + "|",
    ]
    found = {}
    for way, pattern in WAYS.items():
        place = f"{folder}/demo/stripes.json"
        if pattern:
            slcal(f"pattern {pattern} --projector 1024x768 --out-dir {folder}/{way} --force")
            place = f"{folder}/{way}/sequence.json"
        scene = folder / f"head_{way}"
        mesh = f"--surface {folder}/head.obj --mesh-frame camera --wall 800 --wall-albedo 0.4"
        slcal(f"simulate scene --rig {rig_file} {mesh} {LIGHT} --seed {SEED} --pattern {place} --out {scene} --force")
        photos = scene if pattern else scene / "photo.png"
        frames = len(list(scene.glob("frame_*.png"))) if pattern else 1
        cloud = folder / f"{way}.ply"
        line = f"reconstruct --rig {rig_file} --pattern {place} {photos} --mesh -o {cloud} --jobs 1 --force"
        seconds, _ = processor_seconds(slcal, line)
        r = found[way] = errors(scene, cloud, rig)
        fine = np.abs(r["off"]) <= GROSS_MM
        off, sigma = r["off"][fine], r["sigma"][fine]
        cells = [way, str(frames), f"{r['on_head']}", f"{100 * r['covered']:.1f} %", f"{np.sqrt((off**2).mean()):.3f}"]
        cells += [f"{np.median(sigma):.3f}", f"{100 * (np.abs(off) < sigma).mean():.0f}", str((~fine).sum()), f"{seconds:.2f}"]
        lines.append(f"| {' | '.join(cells)} |")
    pictures = {way: found[way]["picture"] for way in ("stripes", "phase")}
    clouds.head_figure(folder / "experiment_heads.png", pictures)
    return "\n".join(lines)
