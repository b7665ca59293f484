#!/usr/bin/env python3
"""Measure what memory reconstruction from Python takes beside the image: no copy of it crosses the boundary.

    python -m venv .venv && .venv/bin/pip install -r benches/requirements.txt target/wheels/slcal-*.whl
    cargo build --release -p slcal-core --example time_frame
    .venv/bin/python benches/python_memory.py [--factor 4.5] [--json FILE]

The image is the photograph of a sphere that lies in the repository, enlarged to 25 megapixels (75 MB). Each case runs in a
process of its own, which holds the image and then reconstructs; counted is by how much its resident memory rises at most above what it
was before, and by how much Python's own allocations (tracemalloc, which NumPy's arrays report to) rise. The example `time_frame`
does the same in Rust alone, and is what the binding is compared with. A part cut out of a larger array has to be
copied: it shows that a copy is seen. Linux only (/proc/self/clear_refs). Exit code 1 when a case takes more than a tenth of an image
more than Rust alone.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PHOTO = ROOT / "fixtures/sphere.jpg"
RIG = ROOT / "crates/slcal-cli/demo/truth_rig.json"
# Case -> whether it must do without a copy.
CASES = {
    "rgb": True,
    "bgr view": True,
    "rgb 16 bit": True,
    "reconstructor": True,
    "grey": True,
    "cut out": False,
}
MOST_SHARE_OF_IMAGE = 0.1


def megabytes(process, what):
    """A figure of /proc/PID/status: VmRSS, or VmHWM, its peak."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith(what)).split()[1]) * 1024 / 1e6


def forget_peak(process):
    Path(f"/proc/{process}/clear_refs").write_text("5")


def measure(case, folder):
    """In a process of its own: the rise of resident memory and of Python's allocations, MB."""
    import tracemalloc

    import numpy as np

    import slcal

    rig = slcal.Rig.load(folder / "rig.json")
    stripes = slcal.StripePattern.load(folder / "stripes.json")
    image = np.load(folder / "frame.npy")
    if case == "bgr view":
        image = np.ascontiguousarray(image[..., ::-1])[..., ::-1]
    elif case == "rgb 16 bit":
        image = image.astype(np.uint16) * 257
    elif case == "grey":
        image = np.ascontiguousarray(image[..., 1])
    elif case == "cut out":
        wide = np.zeros((image.shape[0], image.shape[1] + 16, 3), np.uint8)
        wide[:, 8:-8] = image
        image = wide[:, 8:-8]
    work = slcal.Reconstructor(rig, stripes).reconstruct if case == "reconstructor" else rig.reconstruct
    arguments = (image,) if case == "reconstructor" else (image, stripes)
    slcal.decode(stripes.image(), stripes)  # What is made once is made.
    forget_peak("self")
    before = megabytes("self", "VmRSS")
    try:
        cloud = work(*arguments)
    except slcal.Error:
        cloud = None  # Grey pictures are refused, after they have crossed.
    peak = megabytes("self", "VmHWM") - before
    del cloud
    tracemalloc.start()
    try:
        cloud = work(*arguments)
    except slcal.Error:
        cloud = ()
    traced = tracemalloc.get_traced_memory()[1] / 1e6
    print(json.dumps({"peak_mb": peak, "traced_mb": traced, "image_mb": image.nbytes / 1e6, "points": len(cloud)}))


def measure_rust(example, folder):
    """The same of the example, whose image is in memory before the first line."""
    command = [str(x) for x in (example, folder / "rig.json", folder / "stripes.json", folder / "frame.png")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        # It answers an unknown word by giving up, and nothing else before its image is there: wait until memory settles.
        last = -1.0
        while megabytes(process.pid, "VmRSS") != last or last < 60:
            last = megabytes(process.pid, "VmRSS")
            try:
                process.wait(0.5)
                sys.exit("time_frame gave up, what it said stands above")
            except subprocess.TimeoutExpired:
                pass
        forget_peak(process.pid)
        before = megabytes(process.pid, "VmRSS")
        print("cloud", file=process.stdin, flush=True)
        points = int(process.stdout.readline().split()[1])
        peak = megabytes(process.pid, "VmHWM") - before
        process.stdin.close()
    return {"peak_mb": peak, "points": points}


def prepare(folder, factor):
    """Frame, rig and pattern as files."""
    import cv2
    import numpy as np

    import slcal

    photo = cv2.imread(str(PHOTO))
    size = [round(side * factor) for side in (photo.shape[1], photo.shape[0])]
    frame = cv2.resize(photo, size, interpolation=cv2.INTER_LINEAR)
    cv2.imwrite(str(folder / "frame.png"), frame, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    np.save(folder / "frame.npy", frame[..., ::-1].copy())
    rig = slcal.Rig.load(RIG)
    # Pixel centres at integers: x' + 1/2 = factor (x + 1/2).
    k = np.diag([factor, factor, 1]) @ rig.camera.K
    k[:2, 2] += (factor - 1) / 2
    camera = slcal.Camera(k, size, rig.camera.distortion)
    slcal.Rig(camera, rig.projector, rig.projector_from_camera).save(folder / "rig.json")
    slcal.StripePattern((1024, 768)).save(folder / "stripes.json")
    return size


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--factor", type=float, default=4.5, help="enlargement of the 1280x960 photograph")
    parser.add_argument("--example", type=Path, default=ROOT / "target/release/examples/time_frame")
    parser.add_argument("--json", type=Path, help="write all figures there")
    parser.add_argument("--case", choices=CASES, help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.case:
        return measure(args.case, args.folder)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        width, height = prepare(folder, args.factor)
        figures = {"rust alone": measure_rust(args.example, folder)}
        print(f"{width} x {height} px: {width * height / 1e6:.1f} megapixels")
        print(f"{'rust alone':14s} {figures['rust alone']['peak_mb']:8.1f} MB above the image, {figures['rust alone']['points']} points")
        holds = True
        for case, without_copy in CASES.items():
            command = [sys.executable, __file__, "--case", case, "--folder", str(folder)]
            said = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
            found = figures[case] = json.loads(said)
            beyond = (found["peak_mb"] - figures["rust alone"]["peak_mb"]) / found["image_mb"]
            asked = f", asked: <= {MOST_SHARE_OF_IMAGE:g}" if without_copy else ", which is a copy"
            print(
                f"{case:14s} {found['peak_mb']:8.1f} MB above the image of {found['image_mb']:.1f} MB, {found['points']} points; "
                f"Python's own {found['traced_mb']:.2f} MB; beyond Rust alone {beyond:+.3f} images{asked}",
                flush=True,
            )
            holds &= not without_copy or (beyond <= MOST_SHARE_OF_IMAGE and found["traced_mb"] < 1)
    if args.json:
        args.json.write_text(json.dumps(figures, indent=1))
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())
