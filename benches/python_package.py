#!/usr/bin/env python3
"""What the Python package adds to the library: time of a call, memory of a large photograph, gain by threads.

    python -m venv .venv && .venv/bin/pip install numpy ./crates/slcal-py
    .venv/bin/python benches/python_package.py [--json]

The photograph is fixtures/sphere.jpg, 1280x960, reconstructed with the rig that took it; the large one is the
same, each pixel repeated to 24 megapixels. Exit code 1 when a call on small inputs costs more than 50 µs,
when reconstructing the large photograph takes twice its memory or more, or when two threads are less than
1.7 times as fast as one (on two cores or more).
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import slcal

ROOT = Path(__file__).resolve().parent.parent
PHOTO = ROOT / "fixtures/sphere.jpg"
RIG = ROOT / "crates/slcal-cli/demo/truth_rig.json"
LARGE = (6000, 4000)  # 24 megapixels.
MOST_US, LEAST_RATIO = 50.0, 1.7
REPEAT, FRAMES = 7, 16


def best(work: Callable[[], object], calls: int) -> float:
    """Seconds of a call: the least of some rounds, since other work on the machine only adds."""
    rounds = []
    for _ in range(REPEAT):
        start = time.perf_counter()
        for _ in range(calls):
            work()
        rounds.append((time.perf_counter() - start) / calls)
    return min(rounds)


def call_costs(rig: slcal.Rig) -> dict[str, float]:
    """µs of calls on one point."""
    assert rig.projector is not None
    camera, point = rig.camera, np.array([[10.0, 20.0, 1000.0]])
    pixel = camera.project(point)
    column = np.array([rig.projector.width / 2])
    calls: dict[str, Callable[[], object]] = {
        "Camera.project": lambda: camera.project(point),
        "Camera.undistort": lambda: camera.undistort(pixel),
        "Rig.triangulate": lambda: rig.triangulate(pixel, column),
        "rig.camera.K": lambda: rig.camera.K,
    }
    return {name: 1e6 * best(call, 2000) for name, call in calls.items()}


def peak_mb() -> float:
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


def memory(rig: slcal.Rig, photo: np.ndarray, stripes: slcal.StripePattern) -> None:
    """Prints by how many MB the peak of memory grew in one call on a large photograph, in this process
    alone."""
    factor = np.array([LARGE[0] / photo.shape[1], LARGE[1] / photo.shape[0]])
    rows = (np.arange(LARGE[1]) / factor[1]).astype(int)
    columns = (np.arange(LARGE[0]) / factor[0]).astype(int)
    large = np.empty((LARGE[1], LARGE[0], 3), np.uint8)
    for i, row in enumerate(rows):  # Line by line, so that nothing larger was ever there.
        large[i] = photo[row, columns]
    scale = np.diag([*factor, 1.0])
    camera = slcal.Camera(scale @ rig.camera.K, LARGE)
    rig = slcal.Rig(camera, rig.projector, rig.projector_from_camera)
    before = peak_mb()
    points = len(rig.reconstruct(large, stripes))
    print(json.dumps({"photo_mb": large.nbytes / 1e6, "more_mb": peak_mb() - before, "points": points}))


def threads(rig: slcal.Rig, photo: np.ndarray, stripes: slcal.StripePattern) -> dict[str, float]:
    """Frames a second by one thread and by two, taking turns."""

    def rate(workers: int) -> float:
        scanners = [slcal.Reconstructor(rig, stripes) for _ in range(workers)]
        share = FRAMES // workers

        def work(scanner: slcal.Reconstructor) -> None:
            for _ in range(share):
                scanner.reconstruct(photo)

        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, scanners))  # Warm.
            start = time.perf_counter()
            list(pool.map(work, scanners))
            return FRAMES / (time.perf_counter() - start)

    rates = [(rate(1), rate(2)) for _ in range(REPEAT)]
    one, two = (max(r) for r in zip(*rates, strict=True))
    return {"one_fps": one, "two_fps": two, "ratio": two / one}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--memory", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    rig, photo = slcal.Rig.load(RIG), slcal.read_image(PHOTO)
    stripes = slcal.StripePattern((1024, 768))
    if args.memory:
        memory(rig, photo, stripes)
        return 0

    costs = call_costs(rig)
    alone = subprocess.run([sys.executable, __file__, "--memory"], check=True, capture_output=True, text=True)
    large = json.loads(alone.stdout)
    speed = threads(rig, photo, stripes)
    result = {"call_us": costs, "memory": large, "threads": speed}
    if args.json:
        print(json.dumps(result))
    else:
        for name, cost in costs.items():
            print(f"{name:<18} {cost:6.1f} µs a call on one point")
        print(f"{large['photo_mb']:.0f} MB of photograph: {large['more_mb']:.0f} MB more at the peak")
        one, two, ratio = speed["one_fps"], speed["two_fps"], speed["ratio"]
        print(f"one thread {one:.1f}, two threads {two:.1f} frames a second: {ratio:.2f} times")
    slow = max(costs.values()) > MOST_US
    # Beside the photograph only what is kept of it by decoding and the points; a copy in single precision
    # would take four times its bytes.
    heavy = large["more_mb"] > 2 * large["photo_mb"]
    serial = (os.cpu_count() or 1) >= 2 and speed["ratio"] < LEAST_RATIO
    return int(slow or heavy or serial)


if __name__ == "__main__":
    sys.exit(main())
