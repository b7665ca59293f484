#!/usr/bin/env python3
"""Measure what a call from Python costs beside the work, and how much two threads do in the time of one.

    python -m venv .venv && .venv/bin/pip install numpy target/wheels/slcal-*.whl
    .venv/bin/python benches/python_calls.py [--rounds 40] [--json FILE]

Small calls: the median of many, which must stay below 50 microseconds each. Threads: two Python threads reconstruct different
photographs, and one thread does the work of both; rounds take turns and the best of each counts, for whatever else the machine does only
slows them down. Two must do at least 1.7 times as much as one. On a busy machine the clock on the wall cannot tell; there the
account of the scheduler does (Linux): of each thread the time without that in which it was ready and waited for a core, so that what
is left is work, and waiting for each other. Exit code 1 when a bound does not hold.
"""

import argparse
import json
import os
import statistics
import sys
import threading
import time
from pathlib import Path

import numpy as np

import slcal

ROOT = Path(__file__).resolve().parent.parent
RIG = ROOT / "crates/slcal-cli/demo/truth_rig.json"
PHOTOS = [ROOT / "fixtures/sphere.jpg", ROOT / "crates/slcal-cli/demo/head.jpg"]
MOST_MICROSECONDS = 50.0
LEAST_RATIO = 1.7
# Calls that are timed together: the clock's own cost vanishes.
CALLS = 20


def small_calls(rig):
    """Name -> a call on ten points."""
    points = np.random.default_rng(1).uniform((-100, -80, 900), (100, 80, 1100), (10, 3))
    pixels = rig.camera.project(points)
    columns = rig.projector.project(rig.projector_from_camera.transform(points))[:, 0]
    cloud = rig.triangulate(pixels, columns)
    matches = slcal.Matches(pixels, columns)
    as_lists = pixels.tolist(), columns.tolist()
    calls = {
        "rig.triangulate(arrays)": lambda: rig.triangulate(pixels, columns),
        "rig.triangulate(lists)": lambda: rig.triangulate(*as_lists),
        "rig.triangulate(matches)": lambda: rig.triangulate(matches),
        "slcal.Matches(arrays)": lambda: slcal.Matches(pixels, columns),
        "slcal.PointCloud(array)": lambda: slcal.PointCloud(points),
        "camera.project": lambda: rig.camera.project(points),
        "camera.undistort": lambda: rig.camera.undistort(pixels),
        "np.asarray(cloud)": lambda: np.asarray(cloud),
        "len(cloud)": lambda: len(cloud),
        "cloud.report": lambda: cloud.report,
    }
    for name in ("points", "colors", "sigma", "noise", "pixels", "slits", "confidence", "triangles", "frame", "camera_centre"):
        calls[f"cloud.{name}"] = lambda name=name: getattr(cloud, name)
    return calls


def microseconds(call, rounds):
    """Median over rounds of the mean of some calls."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(CALLS):
            call()
        times.append((time.perf_counter() - start) / CALLS * 1e6)
    return statistics.median(times)


def waited_for_a_core():
    """Seconds that this thread was ready to run and did not; None where the system does not tell."""
    try:
        return int(Path("/proc/thread-self/schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError, ValueError):
        return None


def in_threads(works):
    """Seconds from the start of all works, each in a thread of its own, to the end of the last: by the clock on the wall, and
    without the time in which they waited for a core."""
    ready = threading.Barrier(len(works) + 1)
    without_waiting = []

    def run(work):
        ready.wait()
        start, before = time.perf_counter(), waited_for_a_core()
        work()
        after = waited_for_a_core()
        waited = 0.0 if before is None else after - before
        without_waiting.append(time.perf_counter() - start - waited)

    threads = [threading.Thread(target=run, args=(work,)) for work in works]
    for thread in threads:
        thread.start()
    ready.wait()
    start = time.perf_counter()
    for thread in threads:
        thread.join()
    return time.perf_counter() - start, max(without_waiting)


def threads_figures(rig, stripes, rounds, frames):
    """Best seconds of one thread and of two, by either account, and how much more two do in the middle of the rounds."""
    images = [slcal.read_image(p) for p in PHOTOS]
    scanners = [slcal.Reconstructor(rig, stripes) for _ in images]

    def work(scanner, image):
        for _ in range(frames):
            scanner.reconstruct(image)

    works = [lambda s=s, i=i: work(s, i) for s, i in zip(scanners, images, strict=True)]
    one, two = [], []
    for _ in range(rounds):
        one.append(in_threads([lambda: [w() for w in works]]))
        two.append(in_threads(works))
    one, two = np.array(one), np.array(two)
    return one.min(axis=0), two.min(axis=0), np.median(one / two, axis=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument("--frames", type=int, default=4, help="photographs per thread and round")
    parser.add_argument("--json", type=Path, help="write all figures there")
    args = parser.parse_args()
    rig = slcal.Rig.load(RIG)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    print(f"{os.cpu_count()} cores, load {load:.1f} at the start")
    holds, figures = True, {"calls_us": {}}
    for name, call in small_calls(rig).items():
        call()
        took = figures["calls_us"][name] = microseconds(call, 10 * args.rounds)
        print(f"{name:28s} {took:7.2f} us, asked: <= {MOST_MICROSECONDS:g}", flush=True)
        holds &= took <= MOST_MICROSECONDS
    one, two, middle = threads_figures(rig, slcal.StripePattern((1024, 768)), args.rounds, args.frames)
    best = one / two
    for i, account in enumerate(["on the wall", "without waiting for a core"]):
        print(
            f"{account:28s} one thread {1e3 * one[i]:.1f} ms, two {1e3 * two[i]:.1f} ms: x {best[i]:.2f} at best, "
            f"{middle[i]:.2f} in the middle, asked: >= {LEAST_RATIO:g}"
        )
    figures["threads"] = {"one_s": one.tolist(), "two_s": two.tolist(), "best": best.tolist(), "middle": middle.tolist()}
    holds &= best.max() >= LEAST_RATIO
    if args.json:
        args.json.write_text(json.dumps(figures, indent=1))
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())
