"""EXIF tags through Python: read from files, and what a calibration makes of them."""

from __future__ import annotations

import io
import pickle
import struct
from typing import Any

import numpy as np
import pytest
from common import DEMO

import slcal
from slcal import simulate

SIZE = (594, 420)


@pytest.fixture(scope="module")
def checker() -> slcal.CheckerPattern:
    return slcal.CheckerPattern(projector=(1024, 768))


@pytest.fixture(scope="module")
def photos(checker: slcal.CheckerPattern) -> list[Any]:
    tilts = [(25, 28), (-25, -28)]
    return [simulate.scene("sheet", pattern=checker, tilt=tilt).photo for tilt in tilts]


def codes(rig: slcal.Rig) -> list[str]:
    return [w.code for w in rig.quality.warnings]


def with_orientation(jpeg: bytes, value: int) -> bytes:
    """The file with an EXIF block of one entry."""
    tiff = b"II*\0" + struct.pack("<IHHHIHHI", 8, 1, 0x0112, 3, 1, value, 0, 0)
    segment = b"Exif\0\0" + tiff
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + jpeg[2:]


def test_tags_are_read_and_kept() -> None:
    plain = (DEMO / "sheet.jpg").read_bytes()
    assert slcal.read_tags(io.BytesIO(b"not a photograph")) is None
    tags = slcal.read_tags(io.BytesIO(with_orientation(plain, 6)))
    assert tags is not None
    assert tags.orientation == 6
    assert tags.focal_mm is None
    made = slcal.PhotoTags(model="Canon PowerShot G10", focal_mm=6.1, pixels=(4416, 3312), orientation=8)
    assert pickle.loads(pickle.dumps(made)) == made != tags
    assert "PowerShot G10" in repr(made)
    focal = made.focal((4416, 3312))
    assert focal["source"] == "sensor-table"
    assert focal["focal_px"] == pytest.approx(4416 * 6.1 / 7.44)
    with pytest.raises(slcal.Error, match="4416x3312"):
        made.focal((4416, 2484))


def test_what_contradicts_the_result_is_told(photos: list[Any], checker: slcal.CheckerPattern) -> None:
    def rig(**tags: Any) -> slcal.Rig:
        return slcal.calibrate(photos[:1], SIZE, checker, tags=[slcal.PhotoTags(**tags)])

    right = 1500 / np.hypot(1280, 960) * 43.267
    assert not {"exif-focal-differs", "cropped"} & set(codes(rig(focal_35mm=right, pixels=(1280, 960))))
    assert "exif-focal-differs" in codes(rig(focal_35mm=0.6 * right))
    cropped = rig(pixels=(1600, 1000))
    assert "cropped" in codes(cropped)
    assert cropped.quality.verdict == "weak"
    prior = slcal.calibrate(
        photos[:1], SIZE, checker, tags=[slcal.PhotoTags(focal_35mm=right)], exif=True, distortion="none"
    )
    assert prior.camera.K[0, 0] == pytest.approx(1500, rel=0.05)
    with pytest.raises(slcal.Error, match="focal length"):
        slcal.calibrate(photos[:1], SIZE, checker, tags=[slcal.PhotoTags()], exif=True)
    with pytest.raises(slcal.Error, match="tags"):
        slcal.calibrate(photos[:1], SIZE, checker, exif=True)
    with pytest.raises(slcal.Error, match="one for each"):
        slcal.calibrate(photos[:1], SIZE, checker, tags=[None, None])
    with pytest.raises(TypeError, match="PhotoTags"):
        slcal.calibrate(photos[:1], SIZE, checker, tags=["EXIF"])  # type: ignore[list-item]


def test_photographs_that_are_turned_differently_are_turned_back(
    photos: list[Any], checker: slcal.CheckerPattern
) -> None:
    # As a reader gives it that follows the tag: turned clockwise.
    turned = np.ascontiguousarray(np.rot90(photos[1], -1))
    tags = [slcal.PhotoTags(), slcal.PhotoTags(orientation=6)]
    rig = slcal.calibrate([photos[0], turned], SIZE, checker, tags=tags)
    expected = slcal.calibrate(photos, SIZE, checker)
    assert "orientation-differs" in codes(rig)
    assert rig.camera.K[0, 0] == pytest.approx(expected.camera.K[0, 0], rel=1e-3)
    seen = slcal.observe([photos[0], turned], SIZE, checker, tags=tags)
    assert slcal.calibrate_observations(seen).camera.K[0, 0] == pytest.approx(rig.camera.K[0, 0])
    with pytest.raises(slcal.Error):
        slcal.calibrate([photos[0], turned], SIZE, checker)


def test_overexposure_is_measured(checker: slcal.CheckerPattern) -> None:
    for exposure, blown_out in [(0.8, False), (3.0, True)]:
        photo = simulate.scene("sheet", pattern=checker, exposure=exposure).photo
        rig = slcal.calibrate([photo], SIZE, checker)
        clipped = rig.views[0].clipped_percent or 0.0
        assert (clipped > 50) == blown_out
        assert ("clipped" in codes(rig)) == blown_out
        assert slcal.detect(photo, SIZE, checker).clipped_percent == pytest.approx(clipped)
