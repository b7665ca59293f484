#!/usr/bin/env python3
"""Calibrates a webcam and a projector, then scans objects in front of them.

    pip install ./crates/slcal-py opencv-python
    python examples/webcam.py --size A4 --projector 1920x1080 --screen-at 1920,0

The projector is a second display; --screen-at is the position of its top-left pixel. It shows pictures full
screen, at its native resolution, with keystone correction off. In the window "camera", press SPACE to take a
photograph and Q to continue. First photograph the sheet under the checkerboard until the calibration is good,
then as many objects under the stripes as you like. From the first photograph on, camera and projector must
not move, and their zoom and focus must not change.

With --images DIR photographs are read from a folder instead, first sheet*.*, then scan*.*, in order of their
names. Nothing is shown then; project the pictures that `slcal pattern` draws while you take the photographs.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

import slcal

Image = NDArray[np.uint8]

MOST_SATURATED = 0.02  # Of the stripes; a saturated channel hides the colour.
AVERAGED = 5  # Frames; webcams are noisy, and the scene does not move.
STALE = 10  # Frames that a driver may have buffered before the projector's picture changed.


class Folder:
    """Photographs from a folder."""

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise SystemExit(
                f"{folder} is no folder; --images takes a folder with sheet1.jpg, ..., scan1.jpg, ..."
            )
        self.folder = folder

    def of(self, kind: str, projected: Image) -> Iterator[tuple[str, Image]]:
        """Names and RGB photographs of the `kind` sheet or scan, until there are no more."""
        for path in sorted(self.folder.glob(f"{kind}*")):
            bgr = cv2.imread(str(path))
            if bgr is None:
                print(f"{path.name}: OpenCV cannot read it; skipped", file=sys.stderr)
                continue
            yield path.stem, bgr[..., ::-1].astype(np.uint8, copy=False)  # OpenCV has blue first, slcal red.


class Webcam:
    """A camera and the projector's display."""

    def __init__(self, index: int, screen_at: tuple[int, int], exposure: float | None) -> None:
        self.camera = cv2.VideoCapture(index)
        if not self.camera.isOpened():
            raise SystemExit(
                f"camera {index} does not open: is it plugged in, does another program use it? (--camera N)"
            )
        # The largest picture that it has. Its automatic functions would change between photographs.
        for what, value in ((cv2.CAP_PROP_FRAME_WIDTH, 10_000), (cv2.CAP_PROP_FRAME_HEIGHT, 10_000)):
            self.camera.set(what, value)
        self.camera.set(cv2.CAP_PROP_AUTOFOCUS, 0)
        if exposure is not None:
            self.camera.set(cv2.CAP_PROP_AUTO_EXPOSURE, 1)  # By hand, with most drivers.
            self.camera.set(cv2.CAP_PROP_EXPOSURE, exposure)
        try:
            cv2.namedWindow("projector", cv2.WINDOW_NORMAL)
        except cv2.error as error:
            raise SystemExit("no windows: install opencv-python, not opencv-python-headless") from error
        cv2.moveWindow("projector", *screen_at)
        cv2.setWindowProperty("projector", cv2.WND_PROP_FULLSCREEN, cv2.WINDOW_FULLSCREEN)

    def frame(self) -> Image:
        read, bgr = self.camera.read()
        if not read:
            raise SystemExit("the camera gives no more pictures; was it unplugged?")
        return bgr.astype(np.uint8, copy=False)

    def of(self, kind: str, projected: Image) -> Iterator[tuple[str, Image]]:
        """The same while `projected` is shown."""
        cv2.imshow("projector", np.ascontiguousarray(projected[..., ::-1]))
        print(f"photographs of the {kind}: SPACE takes one, Q goes on")
        taken = 0
        while True:
            cv2.imshow("camera", self.frame())
            key = cv2.waitKey(1) & 0xFF
            if key == ord("q"):
                return
            if key == ord(" "):
                for _ in range(STALE):
                    self.frame()
                mean = np.mean([self.frame() for _ in range(AVERAGED)], axis=0)
                taken += 1
                yield f"{kind}{taken}", mean.round().astype(np.uint8)[..., ::-1]


def calibrate(
    photos: Folder | Webcam, checker: slcal.CheckerPattern, size: str | tuple[float, float]
) -> slcal.Rig | None:
    """Takes photographs of the sheet until another one would improve little."""
    views: list[slcal.Detection] = []
    rig = None
    for name, photo in photos.of("sheet", checker.image()):
        try:
            seen = slcal.detect(photo, size, checker)
            height, width = photo.shape[:2]
            observations = slcal.Observations((width, height), checker.projector, [*views, seen])
            rig = slcal.calibrate_observations(observations)
        except (
            slcal.CalibrationError
        ) as error:  # For example seen face-on; together with other views it is still useful.
            print(f"{name}: {error}\n  Tilt the sheet and take another photograph.")
            views.append(seen)
            continue
        except slcal.Error as error:  # Sheet or pattern not found: says why and what to do.
            print(f"{name}: {error}\n  Take another photograph.{hint(photo)}")
            continue
        views.append(seen)
        print(f"{name}: {rig}")
        for note in seen.notes:
            print(f"  note: {note}")
        for warning in rig.quality.warnings:
            print(f"  {warning.message}; {warning.advice}")
        advice = rig.advise(checker)
        if rig.quality.verdict == "good" and not advice.worth_it:
            print("Another photograph would improve little: calibrated.")
            break
        if advice.next is not None:
            print(f"  next: {advice.next.in_words}")
    return rig


def hint(photo: Image) -> str:
    """Advice on exposure for a photograph in which nothing is found."""
    if np.percentile(photo, 90) < 60:
        return " It is dark: use more light or a longer exposure."
    if (photo == 255).all(axis=2).mean() > 0.2:
        return " Much of it is saturated: use less light or a shorter exposure."
    return ""


def scan(photos: Folder | Webcam, rig: slcal.Rig, stripes: slcal.StripePattern, out: Path) -> int:
    """Turns every photograph of stripes into a cloud; returns their number."""
    clouds = 0
    for name, photo in photos.of("scan", stripes.image()):
        try:
            cloud = rig.reconstruct(photo, stripes)
        except slcal.Error as error:
            print(f"{name}: {error}\n  Take another photograph.{hint(photo)}")
            continue
        cloud.save(out / f"{name}.ply")
        clouds += 1
        print(f"{name}: {len(cloud)} points, sigma {np.median(cloud.sigma):.2f} mm (median)")
        saturated = cloud.report.decode.saturated
        if saturated > MOST_SATURATED:
            print(f"  {saturated:.0%} of the stripes are saturated: use a shorter exposure")
    return clouds


def pair(text: str, between: str = "x") -> tuple[int, int]:
    first, second = text.removesuffix("mm").split(between)
    return int(first), int(second)


def size_of(text: str) -> str | tuple[float, float]:
    """Width and height in millimetres, or what slcal understands: A4, letter, 11x8.5in."""
    try:
        return pair(text)
    except ValueError:
        return text


def main() -> int:
    layout = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=layout)
    parser.add_argument("--size", type=size_of, required=True, help="of the sheet: A4, letter, 297x210, 11x8.5in")
    parser.add_argument("--projector", type=pair, default=(1024, 768), metavar="WxH", help="its resolution")
    parser.add_argument("--camera", type=int, default=0, metavar="N", help="which camera")
    parser.add_argument("--exposure", type=float, metavar="X", help="in the units of the camera's driver")
    parser.add_argument("--screen-at", type=lambda t: pair(t, ","), default=(1920, 0), metavar="X,Y")
    parser.add_argument("--images", type=Path, metavar="DIR", help="photographs instead of a camera")
    parser.add_argument("--out", type=Path, default=Path("scans"), metavar="DIR")
    args = parser.parse_args()

    args.out.mkdir(parents=True, exist_ok=True)
    photos = Folder(args.images) if args.images else Webcam(args.camera, args.screen_at, args.exposure)
    rig = calibrate(photos, slcal.CheckerPattern(args.projector), args.size)
    if rig is None:
        print("No photograph calibrated the rig.", file=sys.stderr)
        return 1
    rig.save(args.out / "rig.json")
    clouds = scan(photos, rig, slcal.StripePattern(args.projector), args.out)
    print(f"{clouds} clouds and rig.json in {args.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
