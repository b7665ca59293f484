"""Files of photographs: their formats, what they say of their samples, and what cannot be read without an extra."""

import io
import struct
import sys
import warnings
import zlib

import numpy as np
import pytest
from PIL import Image

import slcal

Y, X = np.mgrid[0:48, 0:64]
#: Smooth, so that lossy formats keep it.
PICTURE = np.stack([40 + 3 * X, 200 - 3 * Y, 60 + X + Y], -1).astype(np.uint8)
#: As cameras write it that were turned: shown upright the picture is PICTURE.
TURNED = Image.fromarray(PICTURE).transpose(Image.Transpose.ROTATE_90)
TURN = Image.Exif()
TURN[0x0112] = 6


def encoded(picture, **options):
    file = io.BytesIO()
    picture.save(file, **options)
    return file.getvalue()


def read(content, **options):
    return slcal.read_image(io.BytesIO(content), **options)


def farthest(image):
    assert image.shape == PICTURE.shape
    return int(abs(image.astype(int) - PICTURE).max())


@pytest.mark.parametrize("options", [{"format": "BMP"}, {"format": "WEBP", "lossless": True}, {"format": "TIFF"}])
def test_formats_without_loss(options):
    assert (read(encoded(Image.fromarray(PICTURE), **options)) == PICTURE).all()


def test_orientation_is_applied_once():
    for options in ({"format": "JPEG", "quality": 97, "subsampling": 0}, {"format": "WEBP", "lossless": True}):
        assert farthest(read(encoded(TURNED, exif=TURN, **options))) <= 8


def test_a_png_of_linear_light_is_converted_unless_it_is_wanted_as_stored():
    png = encoded(Image.fromarray(PICTURE), format="PNG")
    body = b"gAMA" + struct.pack(">I", 100_000)
    png = png[:33] + struct.pack(">I", 4) + body + struct.pack(">I", zlib.crc32(body)) + png[33:]
    with pytest.warns(UserWarning, match="gAMA.*converted to sRGB"):
        image = read(png)
    assert image.dtype == np.uint16
    light = PICTURE / 255
    code = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert abs(image / 65535 - code).max() < 1e-5
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (read(png, as_stored=True) == PICTURE).all()


HEIC = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic"
AVIF = b"\0\0\0\x18ftypavif\0\0\0\0mif1avif"


def test_heic_without_its_package_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pillow_heif", None)
    with pytest.raises(slcal.FormatError, match=r"image: .*HEIC.*pip install 'slcal\[heif\]'"):
        read(HEIC)


@pytest.mark.parametrize("avif", [False, True])
def test_heic_and_avif(avif, monkeypatch):
    pillow_heif = pytest.importorskip("pillow_heif", reason="needs the extra slcal[heif]")
    if avif:
        whole = encoded(TURNED, format="AVIF", quality=95, subsampling="4:4:4", exif=TURN)
    else:
        file = io.BytesIO()
        heif = pillow_heif.from_pillow(TURNED)
        heif.info["exif"] = TURN.tobytes()
        heif.save(file, quality=95, chroma=444)
        whole = file.getvalue()
    image = read(whole)
    assert image.dtype == np.uint8
    assert farthest(image) <= 12
    with pytest.raises(slcal.FormatError, match="damaged or truncated"):
        read(whole[: len(whole) // 2])
    with pytest.raises(slcal.FormatError, match="damaged or truncated"):
        read(AVIF if avif else HEIC)


def test_heic_of_more_than_8_bit_keeps_them():
    pillow_heif = pytest.importorskip("pillow_heif", reason="needs the extra slcal[heif]")
    deep = PICTURE.astype(np.uint16) * 257
    file = io.BytesIO()
    heif = pillow_heif.from_bytes(mode="RGB;16", size=(64, 48), data=deep.tobytes())
    heif.save(file, quality=95, chroma=444)
    image = read(file.getvalue())
    assert image.dtype == np.uint16
    assert abs(image.astype(int) - deep).max() < 12 * 257
