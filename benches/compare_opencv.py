#!/usr/bin/env python3
"""Time `slcal calibrate` beside OpenCV on the same 12-megapixel photograph, one thread on either side.

    python -m venv .venv && .venv/bin/pip install -r benches/requirements.txt
    .venv/bin/python benches/compare_opencv.py [--slcal target/release/slcal] [--repeat 9] [--json FILE]

The photograph is fixtures/tilted_half.jpg enlarged to 4000x3000 with a little noise, as PNG and as JPEG. `slcal calibrate` is
timed as a whole process: start, reading the file, finding sheet and checkerboard, camera and projector with their
uncertainty, writing rig.json. OpenCV is timed inside a process that is up already: reading and turning grey, finding and
refining the corners, calibrateCamera. Repetitions are interleaved, and every bound is held against medians of one clock,
user and system time of the process: with one thread on either side it is what the wall shows on an idle machine, and other
work does not add to it. Wall-clock and OpenCV without its reading are printed for the record. Exit code 1 when slcal misses
its bounds: a tenth of findChessboardCornersSB with CALIB_CB_ACCURACY, no longer than findChessboardCorners with
cornerSubPix, both with reading and calibrateCamera, and ten photographs in no more than twelve times the time of one.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
SIZE = (4000, 3000)
SHEET = "594x420mm"
INNER = (10, 7)
VIEWS = 10
NOISE_CODES = 1.5
SHARE_OF_ACCURATE = 0.1
SHARE_OF_PLAIN = 1.0
TIMES_ONE_VIEW = 12.0
WALL, PROCESSOR = 0, 1


def clocks():
    own, children = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return np.array([time.perf_counter(), sum(u.ru_utime + u.ru_stime for u in (own, children))])


def timed(function, *args):
    """Seconds of wall-clock and of processor time, and the result."""
    before = clocks()
    result = function(*args)
    return clocks() - before, result


def draw(folder):
    """Ten photographs that differ in their noise, as PNG, and the first as JPEG."""
    small = cv2.imread(str(ROOT / "fixtures/tilted_half.jpg"))
    if small is None:
        sys.exit("fixtures/tilted_half.jpg cannot be read")
    large = cv2.resize(small, SIZE, interpolation=cv2.INTER_CUBIC).astype(np.int16)
    rng = np.random.default_rng(1)
    paths = []
    for i in range(VIEWS):
        noise = np.round(rng.standard_normal((SIZE[1], SIZE[0], 3), dtype=np.float32) * NOISE_CODES).astype(np.int16)
        photo = np.clip(large + noise, 0, 255).astype(np.uint8)
        paths.append(folder / f"photo{i}.png")
        cv2.imwrite(str(paths[-1]), photo)
        if i == 0:
            cv2.imwrite(str(folder / "photo0.jpg"), photo, [cv2.IMWRITE_JPEG_QUALITY, 92])
    return paths


def slcal(binary, pattern, folder, photos):
    command = [binary, "calibrate", *photos, "--size", SHEET, "--pattern", pattern, "-o", folder / "rig.json", "--force", "-q"]
    # One thread: the command starts none; libraries that would are told not to.
    environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"slcal failed ({done.returncode}): {done.stderr}")


def read_grey(path):
    return cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2GRAY)


def accurate(grey):
    found, corners = cv2.findChessboardCornersSB(grey, INNER, flags=cv2.CALIB_CB_ACCURACY)
    return calibrated(found, corners, grey)


def plain(grey):
    found, corners = cv2.findChessboardCorners(grey, INNER)
    if found:
        corners = cv2.cornerSubPix(grey, corners, (11, 11), (-1, -1), (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 0.01))
    return calibrated(found, corners, grey)


def calibrated(found, corners, grey):
    if found:
        board = np.zeros((INNER[0] * INNER[1], 3), np.float32)
        board[:, :2] = np.mgrid[: INNER[0], : INNER[1]].T.reshape(-1, 2)
        cv2.calibrateCamera([board], [corners], grey.shape[::-1], None, None)
    return found


def measure(binary, folder, repeat):
    pattern = folder / "checker.json"
    subprocess.run([str(binary), "pattern", "checker", "--projector", "1024x768", "-o", str(folder / "checker.png")], check=True, capture_output=True)
    photos = draw(folder)
    jpeg = folder / "photo0.jpg"
    times = {}

    def note(name, seconds):
        times.setdefault(name, []).append(seconds)

    for i in range(repeat):
        for kind, path in (("PNG", photos[0]), ("JPEG", jpeg)):
            note(f"slcal, {kind}", timed(slcal, binary, pattern, folder, [path])[0])
            seconds, grey = timed(read_grey, path)
            note(f"reading, {kind}", seconds)
            for name, function in (("plain", plain), ("accurate", accurate)):
                if name == "accurate" and (kind == "JPEG" or i % 3):
                    # It takes seconds and does not depend on the file's format: a third of the repetitions will do.
                    continue
                seconds, found = timed(function, grey)
                if not found:
                    print(f"OpenCV did not find the board ({name})", file=sys.stderr)
                note(f"{name}, {kind}", seconds)
        if i % 3 == 0:
            note("slcal, ten views", timed(slcal, binary, pattern, folder, photos)[0])
    return {name: np.median(np.array(values), axis=0) for name, values in times.items()}


def report(t):
    missed = []
    print(f"{'':58s} {'wall':>9s} {'processor':>10s}")
    for name, value in t.items():
        print(f"{name:58s} {value[0] * 1e3:7.0f} ms {value[1] * 1e3:7.0f} ms")
    print()
    rows = []
    for kind in ("PNG", "JPEG"):
        mine, reading = t[f"slcal, {kind}"], t[f"reading, {kind}"]
        best, quick = t["accurate, PNG"], t[f"plain, {kind}"]
        rows += [
            (f"{kind}: slcal / (reading + SB, accuracy + calibrateCamera)", mine / (reading + best), SHARE_OF_ACCURATE),
            (f"{kind}: slcal / (SB, accuracy + calibrateCamera)", mine / best, None),
            (f"{kind}: slcal / (reading + corners + subpix + calibrateCamera)", mine / (reading + quick), SHARE_OF_PLAIN),
            (f"{kind}: slcal / (corners + subpix + calibrateCamera)", mine / quick, None),
        ]
    rows.append(("PNG: ten views / one view", t["slcal, ten views"] / t["slcal, PNG"], TIMES_ONE_VIEW))
    for what, ratio, bound in rows:
        asked = f"asked of processor time: <= {bound:g}" if bound else "for the record"
        print(f"{what:58s} {ratio[0]:9.3f} {ratio[1]:10.3f}   {asked}")
        if bound and ratio[PROCESSOR] > bound:
            missed.append(what)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slcal", type=Path, default=ROOT / "target/release/slcal")
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--json", type=Path, help="write the medians here as well")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    with tempfile.TemporaryDirectory() as folder:
        times = measure(args.slcal.resolve(), Path(folder), max(args.repeat, 1))
    missed = report(times)
    if args.json:
        args.json.write_text(json.dumps({k: dict(zip(("wall_s", "processor_s"), map(float, v))) for k, v in times.items()}, indent=1))
    for what in missed:
        print(f"MISSED {what}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
