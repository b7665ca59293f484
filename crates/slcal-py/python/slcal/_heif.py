"""HEIC and AVIF by pillow-heif and Pillow, which the extra `heif` brings."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import FormatError

#: Transfer functions of ITU-T H.273 that have no white of their own.
_HDR = {16: "PQ (HDR)", 18: "HLG (HDR)"}


def read(content: bytes, name: str, *, avif: bool) -> NDArray[Any]:
    """The photograph, upright: (H, W, 3) or (H, W), uint8, or uint16 where it has more than 8 bit.

    Raises
    ------
    slcal.FormatError
        When the packages are missing, or the file cannot be decoded.
    """
    kind = "an AVIF picture" if avif else "a HEIC picture"
    try:
        picture = _avif(content) if avif else _heic(content)
    except ImportError as missing:
        raise _refused(
            f"{name}: expected a photograph that slcal reads by itself, found {kind}; pip install 'slcal[heif]', "
            "or convert it to JPEG (iPhone: Settings, Camera, Formats, \"Most Compatible\")"
        ) from missing
    except _Hdr as found:
        raise _refused(f"{name}: expected samples coded as sRGB, found {found}; convert it to sRGB first") from None
    except Exception as error:  # Whatever the decoders raise at damaged files.
        raise _refused(
            f"{name}: expected a photograph, found {kind} that cannot be decoded ({error}); "
            "it is damaged or truncated; copy it again"
        ) from error
    return np.ascontiguousarray(picture[..., :3] if picture.ndim == 3 else picture)


class _Hdr(Exception):
    """Samples that cannot be taken for sRGB."""


def _heic(content: bytes) -> NDArray[Any]:
    import pillow_heif

    # libheif turns the picture as the file says; the EXIF orientation says the same once more.
    picture = pillow_heif.open_heif(io.BytesIO(content), convert_hdr_to_8bit=False)
    transfer = (picture.info.get("nclx_profile") or {}).get("transfer_characteristics")
    if transfer in _HDR:
        raise _Hdr(_HDR[transfer])
    return np.asarray(picture)


def _avif(content: bytes) -> NDArray[Any]:
    from PIL import Image, ImageOps, features

    if not features.check("avif"):
        raise ImportError("Pillow without AVIF")
    # Pillow hands the turn on as EXIF orientation.
    picture = ImageOps.exif_transpose(Image.open(io.BytesIO(content)))
    return np.asarray(picture if picture.mode in ("L", "RGB", "RGBA") else picture.convert("RGB"))


def _refused(message: str) -> FormatError:
    return FormatError(message, what="photograph", detail=message)
