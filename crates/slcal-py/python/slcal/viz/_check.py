"""Checks of arguments, with their error messages."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import Camera, PointCloud, Rig

#: How far outside the image's border a measured pixel may lie; beyond, image and pixels do not belong together.
_BORDER_PX = 0.5


def image(picture: Any) -> NDArray[Any]:
    """A photograph as the rest of slcal takes them: (H, W, 3) or (H, W), uint8 or uint16."""
    if not isinstance(picture, np.ndarray):
        raise TypeError(
            f"image: expected a NumPy array of uint8 or uint16, found {type(picture).__name__}; "
            "read files with slcal.read_image"
        )
    if picture.dtype not in (np.uint8, np.uint16):
        raise TypeError(
            f"image: expected uint8 or uint16, found {picture.dtype}; "
            "scale it and convert it with .astype(np.uint8)"
        )
    if picture.ndim not in (2, 3) or (picture.ndim == 3 and picture.shape[2] != 3) or 0 in picture.shape:
        raise Error(
            f"image: expected the shape (H, W, 3) or (H, W), found {picture.shape}; "
            "leave an alpha channel out with image[..., :3]"
        )
    return picture


def image_of(picture: NDArray[Any], camera: Camera) -> None:
    """Refuses an image of another size than the camera's."""
    height, width = picture.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise Error(
            f"image: expected {camera.width} x {camera.height} px, the size of the rig's camera, "
            f"found {width} x {height} px; give the photograph as it was taken by that camera"
        )


def pixels_in(pixels: NDArray[np.float64], picture: NDArray[Any], what: str) -> None:
    """Refuses pixels outside the image: it is another one, or was scaled or rotated."""
    height, width = picture.shape[:2]
    reach = np.array([width - 1, height - 1]) + _BORDER_PX
    outside = ((pixels < -_BORDER_PX) | (pixels > reach)).any(axis=1)
    if outside.any():
        x, y = pixels[int(np.argmax(outside))]
        raise Error(
            f"{what}: expected pixels of this image of {width} x {height} px, found {int(outside.sum())} of "
            f"{len(pixels)} outside of it, the first at ({x:.1f}, {y:.1f}); "
            "give the image in which they were found, at its full size"
        )


def found(value: Any) -> str:
    """What an argument is, in words."""
    if isinstance(value, (str, os.PathLike)):
        return "a path"
    return "an array" if isinstance(value, np.ndarray) else f"a {type(value).__name__}"


def rig(value: Any) -> Rig:
    """A rig."""
    if not isinstance(value, Rig):
        raise TypeError(
            f"rig: expected a Rig, found {found(value)}: slcal.Rig.load(path) reads a file, "
            "slcal.calibrate(photos, size_mm, pattern) makes one"
        )
    return value


def cloud(points: Any) -> PointCloud:
    """A cloud that has points."""
    if not isinstance(points, PointCloud):
        raise TypeError(
            f"cloud: expected a PointCloud, found {found(points)}: slcal.PointCloud.load(path) reads a file, "
            "slcal.PointCloud(points) takes an (N, 3) array"
        )
    if len(points) == 0:
        raise Error("cloud: expected at least one point, found none; there is nothing to draw")
    return points


def positive(value: int, name: str) -> int:
    """A count that is at least one."""
    if value < 1:
        raise Error(f"{name}: expected at least 1, found {value}")
    return value
