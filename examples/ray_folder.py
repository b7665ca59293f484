"""Reconstruct a folder of photographs, on this machine or on a Ray cluster.

    python examples/ray_folder.py 'scan/*.png' rig.json stripes.json clouds
    python examples/ray_folder.py s3://bucket/scan rig.json stripes.json s3://bucket/clouds --address auto

Photographs that cannot be reconstructed are listed at the end, and the exit code is 1. A second run does only what is
missing; finished clouds stay as they are.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence

import ray

import slcal.ray


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code."""
    parser = argparse.ArgumentParser(description="Reconstruct a folder of photographs on a Ray cluster.")
    parser.add_argument("photos", help="a folder, a pattern such as 'scan/*.png', or either of them on a store (s3://...)")
    parser.add_argument("rig", help="the calibrated rig")
    parser.add_argument("pattern", help="the stripes that were projected")
    parser.add_argument("output", help="the folder for the clouds and results.parquet")
    parser.add_argument("--mesh", action="store_true", help="write the triangles between the points too")
    parser.add_argument("--overwrite", action="store_true", help="replace clouds of another rig, pattern or options")
    parser.add_argument("--workers", type=int, metavar="N", help="how many photographs are worked on at a time")
    parser.add_argument("--address", help="the cluster, 'auto' for that of this machine; its own cores when not given")
    args = parser.parse_args(arguments)

    ray.init(address=args.address or "local", logging_level=logging.WARNING, log_to_driver=False)
    try:
        table = slcal.ray.reconstruct(
            args.photos,
            args.rig,
            args.pattern,
            args.output,
            mesh=args.mesh,
            overwrite=args.overwrite,
            workers=args.workers,
        )
    except (slcal.Error, OSError) as error:
        print(f"ray_folder: {error}", file=sys.stderr)
        return 2

    rows = table.to_pylist()
    failed = [row for row in rows if row["error"] is not None]
    skipped = sum(row["skipped"] for row in rows)
    points = sum(row["points"] or 0 for row in rows)
    print(f"{len(rows) - len(failed)} of {len(rows)} frames ({skipped} of them from an earlier run), {points} points")
    for row in failed:
        print(f"{row['frame']}: {row['error_type']}: {row['error']}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
