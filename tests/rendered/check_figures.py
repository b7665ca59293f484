#!/usr/bin/env python3
"""Measure the binary on rendered photographs with ground truth, and fail where a figure misses its bound.

    check_figures.py --slcal target/release/slcal --shared ../shared [--only stripes,robustness] [--brief]

Uses the scorer that lies beside the data and measures what it does not: own clouds beside true surfaces, the same
photographs noisier, blurred, miscoloured, turned and at other sizes, every estimate's error in units of its own sigma, input
that must be refused, a 24-megapixel photograph within its memory, photographs with all that real ones have, and real
photographs of a sheet; figures/ has a module for each. A figure that is missed for a known reason (figures/shortfalls.py) is
printed so and counted apart. Says so and passes where the data is not at hand.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

from figures import bad_input, calibration, effects, memory, point_sigma, real, robustness, stripes, surfaces
from figures.common import Context, Table
from figures.variants import VARIANTS

CHECKS = {
    "calibration": calibration.check,
    "effects": effects.check,
    "stripes": stripes.check,
    "surfaces": surfaces.check,
    "point_sigma": point_sigma.check,
    "robustness": robustness.check,
    "bad_input": bad_input.check,
    "memory": memory.check,
    "real": real.check,
}


def names(text):
    chosen = [name.strip() for name in text.split(",") if name.strip()]
    unknown = [name for name in chosen if name not in CHECKS]
    if unknown or not chosen:
        raise argparse.ArgumentTypeError(f"{', '.join(unknown) or 'nothing'}: choose from {', '.join(CHECKS)}")
    return chosen


def variant_names(text):
    chosen = tuple(name.strip() for name in text.split(",") if name.strip())
    unknown = [name for name in chosen if name not in VARIANTS]
    if unknown:
        raise argparse.ArgumentTypeError(f"{', '.join(unknown)}: choose from {', '.join(VARIANTS)}")
    return chosen


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slcal", required=True, type=Path)
    parser.add_argument("--shared", required=True, type=Path)
    parser.add_argument("--only", type=names, default=list(CHECKS), metavar="NAMES", help=f"of {','.join(CHECKS)}; all by default")
    parser.add_argument("--brief", action="store_true", help="tables, and beside them only the figures that are missed")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="views worked on at once (robustness)")
    parser.add_argument("--variants", type=variant_names, default=(), metavar="NAMES", help=f"for robustness, of {','.join(VARIANTS)}; all by default")
    args = parser.parse_args()
    if not (args.shared / "tools/score_rendered.py").is_file():
        print(f"skipped: no rendered photographs at {args.shared}")
        return 0
    table = Table(args.brief)
    with tempfile.TemporaryDirectory() as folder:
        ctx = Context(args.slcal.resolve(), args.shared.resolve(), Path(folder), max(args.jobs, 1), args.variants)
        for name in args.only:
            start = time.monotonic()
            print(f"== {name}", flush=True)
            CHECKS[name](table, ctx)
            print(f"     ({time.monotonic() - start:.0f} s)", flush=True)
    print(f"figures: {table.passed} passed, {table.failed} failed, {table.known} missed for known reasons")
    return 1 if table.failed else 0


if __name__ == "__main__":
    sys.exit(main())
