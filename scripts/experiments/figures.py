"""The plots of docs/experiments.md."""

import csv

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"two-vp": "#c2571a", "ml": "#1a6fc2"}


def rows(path):
    """The CSV of `slcal simulate noise`, by method; empty fields become NaN."""
    table = {"two-vp": [], "ml": []}
    with open(path, newline="") as f:
        for row in csv.DictReader(f):
            number = lambda v: float(v) if v else float("nan")
            table[row["method"]].append({k: v if k == "method" else number(v) for k, v in row.items()})
    return table


def noise_figure(path, table, truth):
    """Reprojection, 3D error, focal lengths and translation against noise, both methods beside the bound."""
    figure, axes = plt.subplots(2, 3, figsize=(11, 6.2), layout="constrained")
    axes = axes.ravel()
    with_deviation = [
        ("camera: reprojection, px", "camera_reprojection_px"),
        ("projector: reprojection, px", "projector_reprojection_px"),
        ("3D error, % of the cube's edge", "cube_position_percent"),
    ]
    for axis, (title, name) in zip(axes, with_deviation):
        for i, (method, data) in enumerate(table.items()):
            x = [r["level_px"] + (i - 0.5) * 0.012 for r in data]
            y, s = ([r[f"{name}_{k}"] for r in data] for k in ("mean", "std"))
            axis.errorbar(x, y, s, label=method, color=COLOURS[method], marker="o", ms=3, lw=1.2, capsize=2)
        axis.set_title(title, fontsize=10)
    with_bound = [
        ("camera: focal length, rms error, %", "camera_focal_px", 100 / truth["camera_focal_px"]),
        ("projector: focal length, rms error, %", "projector_focal_px", 100 / truth["projector_focal_px"]),
        ("translation, rms error, mm", "translation_mm", 1),
    ]
    for axis, (title, name, scale) in zip(axes[3:], with_bound):
        for method, data in table.items():
            x, y = ([r[k] for r in data] for k in ("level_px", f"{name}_rms"))
            axis.plot(x, [v * scale for v in y], label=method, color=COLOURS[method], marker="o", ms=3, lw=1.2)
        bound = [r[f"{name}_bound"] * scale for r in table["ml"]]
        axis.plot(x, bound, "k--", lw=1, label="Cramér–Rao bound")
        axis.set_title(title, fontsize=10)
    for axis in axes:
        axis.set_xlabel("noise, px (1σ)", fontsize=9)
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
        axis.tick_params(labelsize=8)
        axis.legend(fontsize=8, frameon=False)
    save(figure, path)


def planes_figure(path, errors, names):
    """Focal lengths, baseline and points off the truth by way, every dot one calibration, on a logarithmic scale."""
    keys = [
        ("f_cam", "camera: focal length off, %"),
        ("f_proj", "projector: focal length off, %"),
        ("baseline", "baseline off, %"),
        ("points_mm", "points in space off, mm (rms)"),
    ]
    figure, axes = plt.subplots(1, 4, figsize=(12, 3.1), layout="constrained", sharey=True)
    for axis, (key, title) in zip(axes, keys):
        for i, name in enumerate(names):
            values = [max(abs(e[key]), 1e-4) for e in errors[name]]
            colour = COLOURS.get(name.split(",")[0], "#555555")
            step = 0.5 / max(len(values), 1)
            y = [len(names) - i + (k - len(values) / 2) * step for k in range(len(values))]
            axis.plot(values, y, ".", ms=3, alpha=0.5, color=colour)
        axis.set_xscale("log")
        axis.set_title(title, fontsize=9)
        axis.set_yticks([len(names) - i for i in range(len(names))], names)
        axis.tick_params(labelsize=8)
        axis.grid(alpha=0.3, axis="x")
    save(figure, path)


def save(figure, path):
    """As a small PNG without metadata that changes from run to run."""
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)
