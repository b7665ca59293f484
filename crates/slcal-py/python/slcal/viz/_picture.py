"""A photograph on 2-D axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from . import _colors
from ._extras import need

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Longer side of a new figure's picture, inches.
_SIDE_INCHES = 9.0
#: How much of the photograph's saturation and brightness remains under curves, so that their colours stand out
#: from the stripes.
_COLOR_KEPT, _LIGHT_KEPT = 0.4, 0.7
#: Narrower axes have their legend in two columns.
_LEGEND_INCHES = 5.5
#: Maximum margin around the image for corners outside of it, as a share of its size.
_SURROUNDINGS = 0.5


def axes(ax: Axes | None, width: float, height: float) -> Axes:
    """The axes given, or those of a new figure for a picture of this shape."""
    plt = need("matplotlib.pyplot")
    if ax is not None:
        if hasattr(ax, "get_zlim"):
            raise Error(
                "ax: expected flat axes for a picture, found 3-D ones; leave ax out or give plt.subplots()[1]"
            )
        return ax
    scale = _SIDE_INCHES / max(width, height)
    # Room for the legend below, and never so flat that it does not fit.
    size = (max(width * scale, 4.0), max(height * scale, 2.0) + 0.5)
    figure: Figure = plt.figure(figsize=size, layout="constrained")
    return figure.add_subplot()


def displayed(image: NDArray[Any], gamma: Literal["srgb", "linear"] | float) -> NDArray[np.uint8]:
    """The image for a screen: sRGB, 8 bit."""
    if gamma == "srgb":
        return image if image.dtype == np.uint8 else (image // 257).astype(np.uint8)
    if gamma != "linear" and not (isinstance(gamma, (int, float)) and 0 < gamma < np.inf):
        raise Error(f'gamma: expected "srgb", "linear" or a positive number, found {gamma!r}')
    most = np.iinfo(image.dtype).max
    light = np.linspace(0.0, 1.0, most + 1) ** (1.0 if gamma == "linear" else float(gamma))
    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(255.0 * srgb).astype(np.uint8)[image])


def dimmed(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture with less saturation and brightness, for curves on top of it."""
    if picture.ndim == 2:
        return _weighted(picture, _LIGHT_KEPT).astype(np.uint8)
    channels = [picture[..., c] for c in range(3)]
    red, green, blue = (_weighted(c, float(w)) for c, w in zip(channels, _colors.LUMA, strict=True))
    mixed = _weighted((red + green + blue).astype(np.uint8), _LIGHT_KEPT * (1.0 - _COLOR_KEPT))
    return np.stack(
        [(_weighted(c, _LIGHT_KEPT * _COLOR_KEPT) + mixed).astype(np.uint8) for c in channels], axis=-1
    )


def _weighted(channel: NDArray[np.uint8], weight: float) -> NDArray[np.uint16]:
    """The channel times a weight below 1, by a lookup table, which saves the memory of floating point."""
    return np.asarray(np.rint(weight * np.arange(256)).astype(np.uint16)[channel])


def show(ax: Axes, picture: NDArray[np.uint8], beyond: NDArray[np.float64] | None = None) -> None:
    """Draws the picture with pixel centres at integers. The view includes points `beyond` its border."""
    height, width = picture.shape[:2]
    if picture.ndim == 2:
        ax.imshow(picture, cmap="gray", vmin=0, vmax=255)
    else:
        ax.imshow(picture)
    low, high = np.array([-0.5, -0.5]), np.array([width - 0.5, height - 0.5])
    if beyond is not None and len(beyond):
        reach, margin = _SURROUNDINGS * (high - low), 0.03 * float((high - low).max())
        first, last = beyond.min(axis=0), beyond.max(axis=0)
        low = np.where(first < low, np.maximum(first - margin, low - reach), low)
        high = np.where(last > high, np.minimum(last + margin, high + reach), high)
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(high[1], low[1])
    ax.set_axis_off()


def legend(ax: Axes) -> None:
    """A legend below the picture, where it hides nothing."""
    handles, labels = ax.get_legend_handles_labels()
    if handles:
        inches = ax.bbox.width / ax.figure.dpi
        ax.legend(
            handles,
            labels,
            loc="upper center",
            bbox_to_anchor=(0.5, 0.0),
            ncols=len(handles) if inches > _LEGEND_INCHES else 2,
            # Dark as the photographs' own darker parts: the colours are made for these.
            facecolor=_colors.RIM,
            edgecolor="none",
            labelcolor="white",
            framealpha=1.0,
            borderaxespad=0.4,
            handletextpad=0.4,
            columnspacing=1.4,
        )
