#!/usr/bin/env python3
"""Time decoding and triangulation of a frame in memory beside OpenCV's GaussianBlur of the same frame, one thread on either side.

    python -m venv .venv && .venv/bin/pip install -r benches/requirements.txt
    cargo build --release -p slcal-core --example time_frame && cargo build --release -p slcal-cli
    .venv/bin/python benches/compare_blur.py [--repeat 31] [--json FILE] [--frame PHOTO --rig RIG.json --pattern STRIPES.json]

The frames are three photographs of objects under stripes, 1280x960, that lie in the repository: a sphere, a head, a board; and
the first of them at other sizes, for the record. The example `time_frame` holds frame, rig and pattern in memory and does
its work when asked; the blur, 7x7 on the same 8-bit frame into an array that is there already, takes turns with it in one run. Bounds
are held against medians of processor time (where the system tells that of another process; the wall's elsewhere): other work
on the machine does not add to it. Exit code 1 when decoding and triangulating a frame takes more than five times as long as the blur.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
FRAMES = {
    "sphere": ROOT / "fixtures/sphere.jpg",
    "head": ROOT / "crates/slcal-cli/demo/head.jpg",
    "board": ROOT / "crates/slcal-cli/demo/board.jpg",
}
RIG = ROOT / "crates/slcal-cli/demo/truth_rig.json"
# Of the processor time of the blur, at most.
TIMES_THE_BLUR = 5.0
# Other sizes, as factors of width and height: a quarter and four times the pixels, and 12 megapixels.
FACTORS = (0.5, 2.0, 3.125)
# Repetitions at another size, as a share.
SHARE_OF_REPETITIONS = 0.3
WORKS = ("matches", "points", "cloud")
BOUNDED = "points"
KERNEL = (7, 7)
WALL, PROCESSOR = 0, 1


class Scanner:
    """The example, waiting for work."""

    def __init__(self, binary, rig, pattern, photo):
        command = [str(x) for x in (binary, rig, pattern, photo)]
        environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)

    def processor_s(self):
        """Processor time of the process so far; None where the system does not tell."""
        try:
            # The clock of another process, as clock_getcpuclockid(3) makes its number on Linux.
            return time.clock_gettime((~self.process.pid << 3) | 2)
        except (OSError, AttributeError):
            return None

    def run(self, work):
        """Wall-clock and processor seconds of one frame, and how many points it has."""
        before = self.processor_s()
        print(work, file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline().split()
        if not answer:
            sys.exit(f"time_frame gave up ({self.process.wait()}), what it said stands above")
        wall, after = float(answer[0]) / 1e3, self.processor_s()
        return np.array([wall, wall if before is None or after is None else after - before]), int(answer[1])

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def blur(frame, out):
    """Wall-clock and processor seconds."""
    before = np.array([time.perf_counter(), time.process_time()])
    cv2.GaussianBlur(frame, KERNEL, 0, dst=out)
    return np.array([time.perf_counter(), time.process_time()]) - before


def scaled_rig(rig, factor):
    """The rig with a camera whose pixels are smaller by `factor`; pixel centres at integers: x' + 1/2 = factor (x + 1/2)."""
    camera = rig["camera"]
    k = np.array(camera["K"])
    k[:2] *= factor
    k[:2, 2] += (factor - 1) / 2
    size = {side: round(camera[side] * factor) for side in ("width", "height")}
    return {**rig, "views": [], "camera": {**camera, **size, "K": k.tolist()}}


def compare(binary, folder, frame, rig, pattern, repeat):
    """Medians, name -> (wall, processor) in seconds, and how many points each work gave."""
    photo, rig_file = folder / "frame.png", folder / "rig.json"
    cv2.imwrite(str(photo), frame)
    rig_file.write_text(json.dumps(rig))
    out = np.empty_like(frame)
    scanner = Scanner(binary, rig_file, pattern, photo)
    times, points = {name: [] for name in ("blur", *WORKS)}, {}
    for i in range(repeat + 1):
        for work in WORKS:
            seconds, points[work] = scanner.run(work)
            blurred = blur(frame, out)
            if i:  # the first round warms up
                times[work].append(seconds)
                times["blur"].append(blurred)
    scanner.close()
    return {name: np.median(values, axis=0) for name, values in times.items()}, points


def report(what, medians, points, bounded):
    """Prints one frame's line per work; whether the bound holds."""
    holds = True
    ms = 1e3 * medians["blur"]
    print(f"{what:24s} {'GaussianBlur':12s} {ms[WALL]:8.2f} ms {ms[PROCESSOR]:8.2f} ms")
    for work in WORKS:
        ms, ratio = 1e3 * medians[work], medians[work] / medians["blur"]
        asked = f"   asked: <= {TIMES_THE_BLUR:g}" if bounded and work == BOUNDED else ""
        print(f"{'':24s} {work:12s} {ms[WALL]:8.2f} ms {ms[PROCESSOR]:8.2f} ms   x {ratio[WALL]:7.2f} x {ratio[PROCESSOR]:7.2f}   {points[work]} points{asked}", flush=True)
        if asked and ratio[PROCESSOR] > TIMES_THE_BLUR:
            holds = False
    return holds


def frames_of(args):
    """Name -> frame, with the rig and the pattern of all, the latter None for the default."""
    if args.frame:
        return {args.frame.stem: cv2.imread(str(args.frame))}, json.loads(args.rig.read_text()), args.pattern
    return {name: cv2.imread(str(path)) for name, path in FRAMES.items()}, json.loads(RIG.read_text()), None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--example", type=Path, default=ROOT / "target/release/examples/time_frame")
    parser.add_argument("--slcal", type=Path, default=ROOT / "target/release/slcal", help="draws the pattern")
    parser.add_argument("--repeat", type=int, default=31)
    parser.add_argument("--frame", type=Path, help="another photograph, with --rig and --pattern")
    parser.add_argument("--rig", type=Path)
    parser.add_argument("--pattern", type=Path)
    parser.add_argument("--json", type=Path, help="write the medians here as well")
    args = parser.parse_args()
    if args.frame and not (args.rig and args.pattern):
        parser.error("--frame needs --rig and --pattern")
    cv2.setNumThreads(1)
    frames, rig, pattern = frames_of(args)
    missing = [name for name, frame in frames.items() if frame is None]
    if missing:
        sys.exit(f"cannot be read: {', '.join(missing)}")
    missed, medians_of = [], {}
    print(f"{'':24s} {'':12s} {'wall':>11s} {'processor':>11s}   times the blur: wall, processor")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if pattern is None:
            panel = f"{rig['projector']['width']}x{rig['projector']['height']}"
            drawn = folder / "stripes.png"
            subprocess.run([str(args.slcal), "pattern", "stripes", "--projector", panel, "-o", str(drawn)], check=True, capture_output=True)
            pattern = drawn.with_suffix(".json")

        def one(what, frame, rig, repeat, bounded):
            what = f"{what}, {frame.shape[1]}x{frame.shape[0]}"
            medians_of[what], points = compare(args.example.resolve(), folder, frame, rig, pattern, repeat)
            if not report(what, medians_of[what], points, bounded):
                missed.append(what)

        for what, frame in frames.items():
            one(what, frame, rig, max(args.repeat, 1), True)
        what, frame = next(iter(frames.items()))
        for factor in FACTORS:
            size = round(frame.shape[1] * factor), round(frame.shape[0] * factor)
            scaled = cv2.resize(frame, size, interpolation=cv2.INTER_AREA if factor < 1 else cv2.INTER_CUBIC)
            one(what, scaled, scaled_rig(rig, factor), max(round(args.repeat * SHARE_OF_REPETITIONS), 1), False)
    if args.json:
        args.json.write_text(json.dumps({k: {n: dict(zip(("wall_s", "processor_s"), map(float, v))) for n, v in m.items()} for k, m in medians_of.items()}, indent=1))
    for what in missed:
        print(f"MISSED {what}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
