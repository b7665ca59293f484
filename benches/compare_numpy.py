#!/usr/bin/env python3
"""Time `slcal.decode` on a stack of Gray code beside a decoder in vectorised NumPy, one thread on either side.

    python -m venv .venv && .venv/bin/pip install numpy target/wheels/slcal-*.whl
    .venv/bin/python benches/compare_numpy.py [--repeat 15] [--json FILE]

42 photographs of 1280x1024 px, 8-bit grey, in the order of OpenCV's GrayCodePattern for a projector of 1024x768 px: ten bits of the
columns, each followed by its inverse, ten of the rows likewise, white, black. They show a sphere before a wall, are simulated once and
lie in memory, in one array. NumPy does the ordinary work: the contrast of each bit and its inverse, whose sign is the bit; pixels are left
out whose contrast is low in any bit or between white and black; Gray code becomes columns and rows. It is written in two ways: as one
writes it, with the stack in 16 bits, and tuned, frame by frame without leaving 8 bits. `slcal.decode` does more: checks of the frames,
their noise, positions within the cells, their uncertainty, and pixels on a border. Repetitions are interleaved; medians of processor time
are compared. Exit code 1 when slcal is less than three times as fast as the ordinary way, or both do not find the same cells.
"""

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path

# One thread: NumPy has none for this work; slcal's are told not to be more.
os.environ["RAYON_NUM_THREADS"] = "1"

import numpy as np  # noqa: E402

import slcal  # noqa: E402
from slcal import simulate  # noqa: E402

CAMERA, PANEL = (1280, 1024), (1024, 768)
LEAST_RATIO = 3.0
# Grey levels between white and black, and between a bit and its inverse, from which a pixel counts.
LIT, DECIDED = 30, 8
# Projector px: half a cell, and what noise and the blur of its border add.
SAME_CELL_PX = 1.5


def photographs(pattern):
    """(42, 1024, 1280) uint8."""
    scene = simulate.scene("sphere", pattern, camera=CAMERA, focal=1500.0, projector=PANEL, noise=2.0, seed=1)
    return np.stack([np.asarray(frame)[..., 1] for frame in scene.frames])


def ordinary(frames, bits):
    """Columns and rows, (H, W) float32 with NaN where a pixel is left out: by contrasts, as one writes it."""
    stack = frames.astype(np.int16)
    lit = stack[-2] - stack[-1] >= LIT
    planes = []
    for first, n in ((0, bits[0]), (2 * bits[0], bits[1])):
        contrast = stack[first : first + 2 * n : 2] - stack[first + 1 : first + 2 * n : 2]
        decided = (np.abs(contrast) >= DECIDED).all(axis=0)
        binary = np.bitwise_xor.accumulate(contrast > 0, axis=0)
        weights = 1 << np.arange(n - 1, -1, -1)
        code = np.tensordot(weights.astype(np.float32), binary, axes=1)
        planes.append(np.where(lit & decided, code, np.nan).astype(np.float32))
    return planes


def in_bytes(frames, bits):
    """The same without any number of more than 8 bits but the code: what NumPy does at most."""
    white, black = frames[-2], frames[-1]
    lit = (white > black) & (white - black >= LIT)
    planes = []
    for first, n in ((0, bits[0]), (2 * bits[0], bits[1])):
        binary = np.zeros(frames.shape[1:], np.uint8)
        code = np.zeros(frames.shape[1:], np.uint16)
        decided = lit.copy()
        for i in range(first, first + 2 * n, 2):
            bit, inverse = frames[i], frames[i + 1]
            binary ^= bit > inverse
            code <<= 1
            code |= binary
            decided &= np.maximum(bit, inverse) - np.minimum(bit, inverse) >= DECIDED
        planes.append(np.where(decided, code, np.float32(np.nan)))
    return planes


def processor_seconds(work):
    start = time.process_time()
    made = work()
    return time.process_time() - start, made


def agreement(here, there):
    """Pixels that both found, the share of them in the same cell, and pixels that either found."""
    (column, row), found = here, np.isfinite(there.column) & np.isfinite(there.row)
    both = np.isfinite(column) & np.isfinite(row) & found
    off = np.maximum(np.abs(column - there.column)[both], np.abs(row - there.row)[both])
    return both.sum(), (off <= SAME_CELL_PX).mean(), (np.isfinite(column) & np.isfinite(row)).sum(), found.sum()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=15)
    parser.add_argument("--json", type=Path, help="write the medians here as well")
    parser.add_argument("--stack", type=Path, metavar="FILE.npy", help="take the photographs from this file, or keep them there")
    args = parser.parse_args()
    pattern = slcal.SequencePattern(PANEL, preset="opencv-gray")
    bits = [sum(f.get("axis") == axis for f in pattern.frames) // 2 for axis in ("columns", "rows")]
    if args.stack and args.stack.exists():
        frames = np.load(args.stack)
    else:
        frames = photographs(pattern)
        if args.stack:
            np.save(args.stack, frames)
    print(f"{len(frames)} frames of {frames.shape[2]}x{frames.shape[1]} px, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    works = {
        "numpy": lambda: ordinary(frames, bits),
        "numpy in bytes": lambda: in_bytes(frames, bits),
        "slcal.decode": lambda: slcal.decode(frames, pattern),
    }
    times, made = {name: [] for name in works}, {}
    for repetition in range(args.repeat + 1):
        for name, work in works.items():
            seconds, made[name] = processor_seconds(work)
            if repetition:  # The first one warms up.
                times[name].append(seconds)
    medians = {name: statistics.median(values) for name, values in times.items()}
    for name, values in times.items():
        print(f"{name:14s} {1e3 * medians[name]:7.1f} ms of processor time ({1e3 * min(values):.1f} to {1e3 * max(values):.1f})")
    both, same, n_numpy, n_slcal = agreement(made["numpy"], made["slcal.decode"])
    print(f"pixels         numpy {n_numpy}, slcal {n_slcal}, both {both}, of which {100 * same:.3f} % lie in the same cell")
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(made["numpy"], made["numpy in bytes"], strict=True))
    ratio, most = (medians[name] / medians["slcal.decode"] for name in ("numpy", "numpy in bytes"))
    print(f"slcal.decode   {ratio:.2f} times as fast as NumPy, asked: >= {LEAST_RATIO:g}; {most:.2f} times as fast as NumPy in bytes")
    if args.json:
        args.json.write_text(json.dumps({**medians, "ratio": ratio, "ratio_in_bytes": most, "same": float(same)}, indent=1))
    return 0 if ratio >= LEAST_RATIO and same > 0.999 else 1


if __name__ == "__main__":
    sys.exit(main())
