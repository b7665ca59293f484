"""Colours with the same meaning in every picture, and colour scales."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._extras import need

if TYPE_CHECKING:
    from matplotlib.colors import Colormap

#: On photographs: bright colours with a dark outline, visible on black and on white.
SHEET = "#ff3cc8"
EDGE_POINT = "#ffdc00"
CORNER = "#00dcff"
FIRST_CORNER = "#ff7800"
RESIDUAL = "#50ff50"
RIM = "#101010"

#: In 3-D: colours of medium brightness, visible on white and on black backgrounds.
CAMERA = "#2a8fd8"
PROJECTOR = "#ee7f1d"
PLANE = "#8f8f8f"
BASELINE = "#c8509f"

#: Distance of the hues of neighbouring slits, as a share of the circle: with the golden angle they differ most.
_GOLDEN_SHARE = 0.618_033_988_75
#: Minimum brightness of a slit's colour: dark blues and reds are invisible on dark photographs.
_LEAST_LUMA = 0.55
#: Luminance of red, green and blue (Rec. 709).
LUMA = np.array([0.2126, 0.7152, 0.0722])

#: Percentiles of the values at the ends of a colour scale, so that a few outliers do not take all of it.
_ROBUST_PERCENT = (2.0, 98.0)


#: Scales are parts of matplotlib's maps, whose dark and pale ends are invisible on dark photographs and on white
#: backgrounds.
_SCALE_PART = (0.3, 0.93)


def scale(name: str, part: tuple[float, float] = _SCALE_PART) -> Colormap:
    """A part of the colour map with this name."""
    shades = need("matplotlib").colormaps[name](np.linspace(*part, 256))
    cut: Colormap = need("matplotlib.colors").ListedColormap(shades, name=f"slcal-{name}")
    return cut


def of_slits(slits: NDArray[Any]) -> NDArray[np.float64]:
    """A bright colour per slit, (N, 3) in 0 to 1; neighbours differ in hue."""
    hue = (np.asarray(slits, dtype=float)[:, None] * _GOLDEN_SHARE % 1.0) * 6.0
    k = (np.array([5.0, 3.0, 1.0]) + hue) % 6.0
    pure = 1.0 - np.clip(np.minimum(k, 4.0 - k), 0.0, 1.0)
    luma = pure @ LUMA
    white = np.clip((_LEAST_LUMA - luma) / (1.0 - luma), 0.0, 1.0)[:, None]
    return np.asarray(pure + (1.0 - pure) * white)


def robust_range(values: NDArray[np.float64]) -> tuple[float, float]:
    """Limits of a colour scale: the 2nd and the 98th percentile, never equal."""
    low, high = (float(v) for v in np.percentile(values, _ROBUST_PERCENT))
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        room = 0.5 * abs(low) or 0.5
        return low - room, high + room
    return low, high
