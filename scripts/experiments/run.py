#!/usr/bin/env python3
"""Run the experiments of docs/experiments.md again, and put their tables and figures there.

    cargo build --release -p slcal-cli
    python3 -m venv .venv && .venv/bin/pip install -r scripts/experiments/requirements.txt
    .venv/bin/python scripts/experiments/run.py            # --quick for a look, --check changes nothing

It takes a quarter of an hour, most of it for rendering stacks. Everything is seeded: apart from times, the same binary and the same
OpenCV give the same tables. OpenCV is the classic way's; slcal itself does
not use it.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import classic
import colours
import doors
import figures
import heads
import page
import stacks
from measure import Rig, against_truth, pixels, reprojection

ROOT = Path(__file__).resolve().parents[2]

# R. Orghidan, J. Salvi, M. Gordan, C. Florea, J. Batlle, "Structured light self-calibration with vanishing points",
# Machine Vision and Applications 25:489-500 (2014), Table 1: reprojection error per plane, px.
PAPER_CAMERA = [2.03, 1.46, 2.55, 2.04, 1.44, 1.98, 1.21, 2.00, 2.51, 1.27]
PAPER_PROJECTOR = [1.16, 1.08, 0.41, 3.36, 0.16, 2.79, 1.45, 0.11, 0.21, 1.33]

# The tilts and rigs of the second table: (what, options of `slcal simulate noise`).
GEOMETRIES = [
    ("25°, 28°", "--tilt 25,28"),
    ("15°, 15°", "--tilt 15,15"),
    ("5°, 5°", "--tilt 5,5"),
    ("30°, 0°", "--tilt 30,0"),
    ("0°, 30°", "--tilt 0,30"),
    ("25°, 28°; principal points unknown", "--tilt 25,28 --principal-points prior"),
    ("25°, 28°; unknown, lens shift 0.5", "--tilt 25,28 --principal-points prior --lens-shift 0.5"),
]

# The two rigs of the ten planes: options of `slcal simulate views`.
RIGS = {
    "plain": "--camera-offset 9,-7 --projector-offset -8",
    "usual": "--camera-offset 9,-7 --projector-offset -8 --lens-shift 0.5 --distortion -0.12",
}
PLANES = 10
NOISE_PX = 0.1
# A printed board of so many corners on the sheet, for the classic way only.
BOARD = (10, 7)
WAYS = ["two-vp, one", "ml, one", "ml, all", "ml, all, told", "classic, sheet", "classic, board"]


# Tables that can be made alone, by their names on the page.
ALONE = {"doors": doors, "colours": colours, "stacks": stacks, "heads": heads}
QUICK = {"stacks": {"sets": 1, "draws": 2}}


class Slcal:
    """The binary."""

    def __init__(self, path):
        self.path = path

    def __call__(self, line, check=True):
        run = subprocess.run([self.path, "-q", *line.split()], capture_output=True, text=True)
        if check and run.returncode:
            sys.exit(f"slcal {line}\n{run.stderr}")
        return run


def noise_experiment(slcal, folder, draws):
    """Fig. 7-11; returns the Markdown table."""
    place = folder / "noise.csv"
    out = slcal(f"simulate noise --levels 1/10 --draws {draws} --csv {place} --json").stdout
    truth = json.loads(out)["truth"]
    table = figures.rows(place)
    figures.noise_figure(folder / "experiment_noise.png", table, truth)
    lines = [
        "| noise, px | method | camera reprojection, px | projector reprojection, px | 3D error, % | f camera, rms % (bound) "
        "| f projector, rms % (bound) | translation, rms mm (bound) |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for pair in zip(table["two-vp"], table["ml"]):
        for r in pair:
            if round(r["level_px"] * 10) not in (1, 2, 5, 10):
                continue
            pm = lambda name, n: f"{r[name + '_mean']:.{n}f} ± {r[name + '_std']:.{n}f}"
            rms = lambda name, unit, n: f"{r[name + '_rms'] / unit:.{n}f} ({r[name + '_bound'] / unit:.{n}f})"
            lines.append(
                f"| {r['level_px']:g} | {r['method']} | {pm('camera_reprojection_px', 3)} "
                f"| {pm('projector_reprojection_px', 3)} | {pm('cube_position_percent', 2)} "
                f"| {rms('camera_focal_px', truth['camera_focal_px'] / 100, 3)} "
                f"| {rms('projector_focal_px', truth['projector_focal_px'] / 100, 3)} "
                f"| {rms('translation_mm', 1, 2)} |"
            )
    return "\n".join(lines)


def geometry_experiment(slcal, draws):
    """Both methods at 0.2 px under other tilts, and with unknown principal points."""
    lines = [
        "| tilt about X, Y | method | no real focal length | refused | f camera: rms, median error | bound "
        "| f projector: rms, median error | bound |",
        "|---|---|---|---|---|---|---|---|",
    ]
    show = lambda v: "–" if v is None else f"{v:.2f} %" if v < 100 else f"{v:.0f} %" if v < 1e4 else f"{v:.0e} %"
    for what, options in GEOMETRIES:
        report = json.loads(slcal(f"simulate noise --levels 0.2 --draws {draws} --json {options}").stdout)
        level, truth = report["levels"][0], report["truth"]
        for m in level["methods"]:
            cells = []
            for name in ("camera_focal_px", "projector_focal_px"):
                percent = lambda v: None if v is None else 100 * v / truth[name]
                cells += [f"{show(percent(m[name]['rms']))}, {show(percent(m[name]['median']))}"]
                cells += [show(percent(level["bound"][name]))]
            share = lambda n: f"{100 * n / m['draws']:.0f} %"
            lines.append(
                f"| {what} | {m['method']} | {share(m['imaginary'])} | {share(m['refused'])} | {' | '.join(cells)} |"
            )
    return "\n".join(lines)


def sheet_boards(observations):
    """The sheet's own four corners as the classic way's board."""
    boards = []
    for v in observations["views"]:
        w, h = v["size_mm"]
        boards.append((np.array([[0, 0], [w, 0], [w, h], [0, h]], float), np.array(v["sheet_corners_px"])[:, :2]))
    return boards


def printed_boards(truth, size, seed):
    """A printed board that fills the sheet, seen with the same noise."""
    rng = np.random.default_rng(seed)
    (columns, rows), (w, h) = BOARD, size
    x, y = np.meshgrid((np.arange(columns) + 0.5) * w / columns, (np.arange(rows) + 0.5) * h / rows)
    mm = np.column_stack([x.ravel(), y.ravel()])
    flat = np.column_stack([mm, np.zeros(len(mm))])
    boards = []
    for r, t in truth.views:
        px = pixels(flat @ r.T + t, truth.camera_k, truth.camera_d)
        boards.append((mm, px + rng.normal(0, NOISE_PX, px.shape)))
    return boards


def calibrate(slcal, folder, observations, method, model=""):
    """The rig by slcal, which is told that the sheet is flat, or None."""
    place = folder / "seen.json"
    place.write_text(json.dumps(observations))
    line = f"calibrate --observations {place} --method {method} --flatness flat {model} --allow-degenerate --json"
    run = slcal(line, check=False)
    return Rig.from_json(run.stdout) if run.returncode == 0 else None


def ten_planes(slcal, folder, options, seed):
    """All ways on one draw of ten planes: {way: [(error of the rig, [(camera px, projector px) per plane it explains])]}."""
    seen_at, truth_at = folder / "views.json", folder / "truth.json"
    slcal(
        f"simulate views --poses {PLANES} --noise {NOISE_PX} --seed {seed} {options} -o {seen_at} --truth {truth_at} --force"
    )
    seen = json.loads(seen_at.read_text())
    truth = Rig.from_json(truth_at.read_text())
    result = {way: [] for way in WAYS}

    def put(way, rig, views):
        if rig is None:
            result[way].append((None, [None] * len(views)))
            return
        residuals = [reprojection(rig, pose, view) for pose, view in zip(rig.views, views)]
        result[way].append((against_truth(rig, truth), residuals))

    for view in seen["views"]:
        one = {**seen, "views": [view]}
        put("two-vp, one", calibrate(slcal, folder, one, "two-vp"), [view])
        put("ml, one", calibrate(slcal, folder, one, "ml"), [view])
    put("ml, all", calibrate(slcal, folder, seen, "ml"), seen["views"])
    distorted = "--distortion" in options
    # What the classic way is told, too.
    told = f"--distortion {'k1k2' if distorted else 'none'} --projector-distortion none"
    put("ml, all, told", calibrate(slcal, folder, seen, "ml", told), seen["views"])
    guess = 1.5 * seen["projector"]["width"]
    size = seen["views"][0]["size_mm"]
    for way, boards in [
        ("classic, sheet", sheet_boards(seen)),
        ("classic, board", printed_boards(truth, size, seed)),
    ]:
        put(way, classic.calibrate(seen, boards, distorted, guess), seen["views"])
    return result


def planes_experiment(slcal, folder, name, repeats):
    """Table 1's protocol; returns the table per plane of the first draw and the table against the truth over all draws."""
    draws = [ten_planes(slcal, folder, RIGS[name], seed) for seed in range(1, repeats + 1)]
    per_plane = {}
    for way, runs in draws[0].items():
        per_plane[way] = [r for _, residuals in runs for r in residuals]
    head = "| plane | paper | " + " | ".join(WAYS) + " |"
    lines = [head, "|---" * (len(WAYS) + 2) + "|"]
    show = lambda r: "no rig" if r is None else f"{r[0]:.3f}, {r[1]:.3f}"
    for i in range(PLANES):
        cells = [show(per_plane[way][i]) for way in WAYS]
        lines.append(f"| {i + 1} | {PAPER_CAMERA[i]:.2f}, {PAPER_PROJECTOR[i]:.2f} | " + " | ".join(cells) + " |")
    paper = f"{np.mean(PAPER_CAMERA):.2f}, {np.mean(PAPER_PROJECTOR):.2f}"
    means = []
    for way in WAYS:
        real = np.array([r for r in per_plane[way] if r is not None])
        means.append(f"{real[:, 0].mean():.3f}, {real[:, 1].mean():.3f}" if len(real) else "–")
    lines.append(f"| mean | {paper} | " + " | ".join(means) + " |")
    errors = {way: [e for d in draws for e, _ in d[way]] for way in WAYS}
    return "\n".join(lines), truth_table(errors), errors


def truth_table(errors):
    """Median and rms error over all calibrations by each way, and how often error bars hold the truth."""
    sure = [e for e in errors["ml, one"] if e and e["verdict"] in ("good", "fair")]
    rows = {}
    for way, runs in errors.items():
        rows[way] = runs
        if way == "ml, one":
            rows["ml, one, called good or fair"] = sure
    lines = [
        "| way | rigs | none | refused | f camera, % | f projector, % | baseline, % | points in space, mm | their shape, mm "
        "| truth within 1.96 σ: f camera, f projector |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    digits = lambda v: f"{v:.3f}" if v < 10 else f"{v:.1f}" if v < 1e4 else f"{v:.0e}"
    for way, runs in rows.items():
        real = [e for e in runs if e is not None]
        cells = [str(len(runs)), str(len(runs) - len(real)), str(sum(e["verdict"] == "degenerate" for e in real))]
        for key in ("f_cam", "f_proj", "baseline", "points_mm", "shape_mm"):
            values = np.abs([e[key] for e in real])
            cells.append(f"{digits(np.median(values))} ({digits(np.sqrt((values**2).mean()))})" if real else "–")
        held = [e["inside"] for e in real if e["inside"] and e["verdict"] != "degenerate"]
        share = 100 * np.mean(held, axis=0) if held else None
        cells.append("–" if share is None else f"{share[0]:.0f} %, {share[1]:.0f} %")
        lines.append(f"| {way} | {' | '.join(cells)} |")
    return "\n".join(lines)


def alone(slcal, folder, title, is_quick):
    """One of the tables that can be made alone, in a folder of its own; its pictures go to `folder`."""
    own = folder / title
    own.mkdir()
    table = ALONE[title].experiment(slcal, own, **(QUICK.get(title, {}) if is_quick else {}))
    for picture in own.glob("experiment_*.png"):
        picture.rename(folder / picture.name)
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--slcal", default=ROOT / "target/release/slcal", type=Path)
    parser.add_argument("--quick", action="store_true", help="few draws")
    parser.add_argument("--only", choices=ALONE, help="this table alone")
    parser.add_argument("--check", action="store_true", help="print the tables, change nothing")
    args = parser.parse_args()
    if not args.slcal.exists():
        sys.exit(f"{args.slcal}: no such program; cargo build --release -p slcal-cli")
    slcal = Slcal(str(args.slcal.resolve()))
    draws, repeats = (10, 2) if args.quick else (200, 20)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if args.only:
            tables = {args.only: alone(slcal, folder, args.only, args.quick)}
            print(tables[args.only])
            if not args.check:
                page.put(folder, tables)
            return
        tables = {"noise": noise_experiment(slcal, folder, 10 if args.quick else 50)}
        tables["geometry"] = geometry_experiment(slcal, draws)
        for title in ALONE:
            tables[title] = alone(slcal, folder, title, args.quick)
        for rig in RIGS:
            planes, truth, errors = planes_experiment(slcal, folder, rig, repeats)
            tables[f"planes {rig}"], tables[f"truth {rig}"] = planes, truth
            real = {way: [e for e in runs if e is not None] for way, runs in errors.items()}
            figures.planes_figure(folder / f"experiment_planes_{rig}.png", real, WAYS)
        for title, table in tables.items():
            print(f"\n{title}\n\n{table}")
        if not args.check:
            page.put(folder, tables)


if __name__ == "__main__":
    main()
