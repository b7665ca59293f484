"""3-D axes, oriented so that y points down."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from ._extras import need

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped,unused-ignore]

#: The view from above, behind and left of the devices. A roll of 180° makes y, which is up in matplotlib, point down.
#: It is a rotation, so nothing is mirrored.
_ELEVATION_DEG, _AZIMUTH_DEG, _ROLL_DEG = -24.0, 205.0, 180.0
#: Points farther from the interquartile range than this many times its width are not shown, so that a few outliers
#: do not shrink the rest.
_FAR = 8.0
#: Margin around the contents, as a share of their largest side.
_MARGIN = 0.04
#: Zoom, since matplotlib leaves a wide margin around the box.
_ZOOM = 1.05
#: Grey of panes and grid, faint on white and on black backgrounds.
_PANE, _GRID_ALPHA = (0.5, 0.5, 0.5, 0.07), 0.4


def axes(ax: Axes3D | None) -> Axes3D:
    """The given axes, or those of a new figure, labelled and oriented."""
    plt = need("matplotlib.pyplot")
    need("mpl_toolkits.mplot3d")
    if ax is None:
        ax = plt.figure(figsize=(9.0, 7.0), layout="constrained").add_subplot(projection="3d")
        for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
            axis.set_pane_color(_PANE)
            axis.gridlines.set_alpha(_GRID_ALPHA)
    elif not hasattr(ax, "get_zlim"):
        raise Error(
            'ax: expected 3-D axes, found flat ones; leave ax out or give figure.add_subplot(projection="3d")'
        )
    ax.view_init(elev=_ELEVATION_DEG, azim=_AZIMUTH_DEG, roll=_ROLL_DEG, vertical_axis="y")
    return ax


def name(ax: Axes3D, frame: str) -> None:
    """Labels of the axes: x right, y down, and z away from the camera or from the sheet's front."""
    ax.set_xlabel("x, mm (right)", labelpad=8)
    ax.set_ylabel("y, mm (down)", labelpad=8)
    ax.set_zlabel("z, mm (forward)" if frame == "camera" else "z, mm (behind the sheet)", labelpad=8)


def near(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points (N, 3) are not outliers."""
    low, high = np.percentile(points, (25.0, 75.0), axis=0)
    reach = _FAR * max(float((high - low).max()), 1e-9)
    return np.asarray(((points >= low - reach) & (points <= high + reach)).all(axis=1))


def limits(ax: Axes3D, points: NDArray[Any]) -> None:
    """Sets the limits for the points (N, 3), with equal scales on all axes."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = max(float((high - low).max()), 1e-6)
    # A flat thing gets some depth, so that the box can be drawn.
    room = np.maximum(_MARGIN * side, 0.5 * (0.15 * side - (high - low)))
    low, high = low - room, high + room
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_zlim(low[2], high[2])
    ax.set_box_aspect(high - low, zoom=_ZOOM)
