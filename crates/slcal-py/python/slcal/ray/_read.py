"""Photographs from the content of their files."""

from __future__ import annotations

import io
from typing import Any

from numpy.typing import NDArray

from .._slcal import read_image


def read(content: bytes, name: str, *, as_stored: bool = False) -> NDArray[Any]:
    """The pixels, by the reader of the command line: upright, 8 or 16 bit."""
    file = io.BytesIO(content)
    file.name = name
    return read_image(file, as_stored=as_stored)
