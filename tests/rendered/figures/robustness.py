"""Stripes of photographs that are noisier, blurred, miscoloured, turned, cropped or of another size."""

import math
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from . import truth as truths
from . import variants
from .common import STRIPED_SCENES, run
from .stripes import VIEWS

RIGHT_PERCENT = 99.0
FOUND_PERCENT = 93.0
# Percentage points that right and found may lose beside the photograph as rendered.
CHANGE_POINTS = 1.0
REFERENCE = "as rendered"
HARDER = ("noise 3", "blur 1.5 px", *variants.CROSSTALK, "coloured object", "all coloured", "JPEG 90", "middle half", "middle quarter", "strong + frames")
THE_SAME = ("half size", "double size", "turned 90", "turned 180", "turned 270", "mirrored", "16 bit", "with frames")
# A crossing nearer to the border of a part than this may be cut, px.
BORDER_PX = 12


def judged_rows(truth, mapping, matches):
    """The matches in pixels as rendered, those alone that lie nearest to a row of known truth, with that row as their own: at
    another size no row falls on it exactly. A slit moves little in a quarter or half of a row."""
    u, v = mapping.back(matches[:, 0], matches[:, 1])
    rows = {}
    across = np.unique(np.round(v, 6))
    for row in truth.rows:
        near = across[np.abs(across - row) <= 0.5] if len(across) else across
        if len(near):
            rows[float(near[np.abs(near - row).argmin()])] = float(row)
    kept = [(x, rows[y], c) for x, y, c in zip(u, np.round(v, 6), matches[:, 2]) if y in rows]
    return np.array(kept).reshape(-1, 3)


def visible(crossings, part):
    if part is None:
        return crossings
    left, top, right, bottom = part
    return [c for c in crossings if left + BORDER_PX <= c[1] < right - BORDER_PX and top <= c[0] < bottom]


def score_matches_of(ctx, scene, view, file):
    """Scores of a file of matches of a view as it is."""
    truth = truths.load(ctx.shared, scene, view)
    return truths.score_matches(truth, truth.crossings(), truths.read_matches(file))


def frames_of(scene, view):
    """Option -> photograph of the dark and of the white projector; None when the view has none."""
    frames = {f"--{light}": scene / f"{view}_{light}.png" for light in ("black", "white")}
    return frames if all(f.exists() for f in frames.values()) else None


def score_variant(slcal, scene, view, name, truth, crossings, folder):
    frames = frames_of(scene, view) if name in variants.WITH_FRAMES else {}
    if frames is None:
        return {}
    image, mapping = variants.make(name, scene / f"{view}.png", truth)
    more = []
    for option, frame in frames.items():
        more += [option, variants.write(variants.make(name, frame, truth)[0], folder / f"{scene.name}_{frame.name}")]
    photo = variants.write(image, folder / f"{scene.name}_{view}{'.jpg' if 'JPEG' in name else '.png'}")
    out = photo.with_suffix(".csv")
    r = run(slcal, "decode", "--pattern", scene / "patterns/stripes.json", photo, *more, "-o", out, "--force")
    if r.returncode:
        said = r.stderr.strip().splitlines()
        return {"error": f"exit {r.returncode}: {said[0].split(photo.name + ': ')[-1] if said else ''}"}
    matches = judged_rows(truth, mapping, truths.read_matches(out))
    return truths.score_matches(truth, visible(crossings, mapping.part), matches)


def score_view(slcal, shared, scene, view, names, folder):
    """Scores of all variants of one view: a process of its own does one view after the other."""
    truth = truths.load(shared, scene, view)
    crossings = truth.crossings()
    return {name: score_variant(slcal, scene, view, name, truth, crossings, Path(folder)) for name in names}


def score_all(ctx, names=tuple(variants.VARIANTS)):
    """(scene, view) -> variant -> scores."""
    keys = [(scene, view) for scene in STRIPED_SCENES for view in VIEWS]
    with ProcessPoolExecutor(ctx.jobs) as pool:
        tasks = {k: pool.submit(score_view, ctx.slcal, ctx.shared, ctx.rendered / k[0], k[1], names, ctx.tmp) for k in keys}
        return {k: task.result() for k, task in tasks.items()}


def print_matrix(scores, names):
    print("     right / found, per cent")
    print(f"     {'':18s}" + "".join(f"{scene[6:9] + ' ' + view[8:]:>14s}" for scene, view in scores))
    for name in names:
        cells = []
        for by_name in scores.values():
            r = by_name[name]
            cells.append(f"{r['right']:7.2f}/{r['found']:6.2f}" if "right" in r else f"{r.get('error', '-')[:6]:>14s}")
        print(f"     {name:18s}" + "".join(cells), flush=True)
    said = Counter(by_name[name]["error"][:150] for by_name in scores.values() for name in names if "error" in by_name[name])
    for line, times in said.most_common(6):
        print(f"     {times} x {line}")


def worst(scores, name, figure, beside=None):
    """The smallest value over the views, beside that of another variant when one is named; None when one was not decoded."""
    values = []
    for by_name in scores.values():
        r, base = by_name[name], by_name[beside] if beside else {figure: 0.0}
        if not r:  # no frames of this view
            continue
        values.append(r[figure] - base[figure] if figure in r and figure in base else math.nan)
    return None if any(math.isnan(v) for v in values) else min(values)


def check(table, ctx):
    names = tuple(n for n in variants.VARIANTS if not ctx.variants or n in (REFERENCE, *ctx.variants))
    scores = score_all(ctx, names)
    print_matrix(scores, names)
    for name in [n for n in HARDER if n in names]:
        table.at_least(f"{name}, the worst view: right", worst(scores, name, "right"), RIGHT_PERCENT, " %")
        table.at_least(f"{name}, the worst view: found", worst(scores, name, "found"), FOUND_PERCENT, " %")
    for name in [n for n in THE_SAME if n in names]:
        for figure in ("right", "found"):
            table.at_least(f"{name}, the worst view: change of {figure}", worst(scores, name, figure, REFERENCE), -CHANGE_POINTS, " points")
