"""Residuals: observed minus predicted positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import Rig, View
from . import _colors
from ._extras import need
from ._sheet import SheetParts

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: The ends of a side in the order of the sheet's corners TL TR BR BL.
_SIDES = {"top": (0, 1), "right": (1, 2), "bottom": (2, 3), "left": (3, 0)}
#: Number of straight segments along a side's image: within 1/1000 px of the curve that distortion makes of it.
_PARTS = 256
#: Maximum number of arrows of edge points per side.
_ARROWS_PER_SIDE = 40
#: Length of the arrow of a long residual (the 90th percentile), as a share of the image's diagonal.
_ARROW_SHARE = 0.025
#: Shorter residuals are rounding errors, px, and are not magnified further.
_LEAST_PX = 1e-6


def outline_mm(size_mm: tuple[float, float]) -> NDArray[np.float64]:
    """Corners TL TR BR BL in the sheet's frame, (4, 3)."""
    width, height = size_mm
    return np.array([[0.0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]])


def expected_pairs(rig: Rig, view: View, projector_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Camera pixels (N, 2) predicted by the rig for the projector's pixels (N, 2) on the view's sheet."""
    if rig.projector is None or rig.projector_from_camera is None:
        raise Error("rig: expected one with a projector, found the camera alone; calibrate it with a pattern")
    sheet_from_projector = (rig.projector_from_camera @ view.camera_from_sheet).inverse()
    centre = sheet_from_projector.t
    direction = rig.projector.rays(projector_px) @ sheet_from_projector.R.T
    on_sheet = centre - (centre[2] / direction[:, 2])[:, None] * direction
    return rig.camera.project(view.camera_from_sheet.transform(on_sheet))


def side_px(rig: Rig, view: View, side: str) -> NDArray[np.float64]:
    """The image of a side as predicted by the rig, a curve of points (P + 1, 2)."""
    first, last = (outline_mm(view.size_mm)[i] for i in _SIDES[side])
    share = np.linspace(0.0, 1.0, _PARTS + 1)[:, None]
    return rig.camera.project(view.camera_from_sheet.transform(first + share * (last - first)))


def expected_side(curve: NDArray[np.float64], edge_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """The points (N, 2) of a side's image (P + 1, 2) closest to the edge points (N, 2)."""
    start, part = curve[:-1], np.diff(curve, axis=0)
    # Every edge point against every part, (N, P).
    along = ((edge_px[:, None] - start) * part).sum(axis=2) / (part**2).sum(axis=1)
    foot = start + np.clip(along, 0.0, 1.0)[..., None] * part
    nearest = np.argmin(((foot - edge_px[:, None]) ** 2).sum(axis=2), axis=1)
    return np.asarray(foot[np.arange(len(edge_px)), nearest])


@dataclass(frozen=True)
class Arrows:
    """Predicted positions and residuals, (N, 2) each, px."""

    name: str
    expected: NDArray[np.float64]
    residual: NDArray[np.float64]
    color: str


@dataclass(frozen=True)
class Residuals:
    """All arrows of a picture, and their magnification."""

    arrows: list[Arrows]
    scale: float
    diagonal_px: float
    #: The sheet's outline as the rig expects it, bent as the lens bends it, (N, 2) px.
    outline: NDArray[np.float64]


def measure(rig: Rig, view: View, seen: SheetParts, diagonal_px: float, magnify: float | None) -> Residuals:
    """Residuals of pattern corners and edge points: observed minus predicted."""
    arrows: list[Arrows] = []
    if len(seen.camera_px):
        expected = expected_pairs(rig, view, seen.projector_px)
        arrows.append(Arrows("pattern", expected, seen.camera_px - expected, _colors.RESIDUAL))
    for side, points in seen.edges.items():
        few = points[:: max(1, -(-len(points) // _ARROWS_PER_SIDE))]
        if len(few):
            expected = expected_side(side_px(rig, view, side), few)
            arrows.append(Arrows(side, expected, few - expected, _colors.EDGE_POINT))
    measured = any(len(points) for points in seen.edges.values())
    if not measured and seen.corners is not None:  # Corners given by hand: there are no points in between.
        expected = rig.camera.project(view.camera_from_sheet.transform(outline_mm(view.size_mm)))
        arrows.append(Arrows("sheet", expected, seen.corners - expected, _colors.RESIDUAL))
    if not arrows:
        raise Error("found: expected corners or edge points to compare with the rig, found none")
    if magnify is not None and not (np.isfinite(magnify) and magnify > 0):
        raise Error(f"magnify: expected a positive number, found {magnify}")
    long = float(np.percentile(np.concatenate([np.hypot(*a.residual.T) for a in arrows]), 90))
    fitting = _ARROW_SHARE * diagonal_px / max(long, _LEAST_PX)
    scale = _round(fitting) if magnify is None else float(magnify)
    return Residuals(
        arrows, scale, diagonal_px, np.concatenate([side_px(rig, view, side) for side in _SIDES])
    )


def draw(ax: Axes, residuals: Residuals) -> None:
    """Draws all arrows, and a reference arrow above the picture."""
    drawn: Any = None
    for arrows in residuals.arrows:
        drawn = _arrows(ax, arrows, residuals.scale)
    length = _round(0.05 * residuals.diagonal_px / residuals.scale)
    text = f"{length:g} px  (seen \u2212 expected, drawn {residuals.scale:g} times as long)"
    ax.quiverkey(drawn, 0.12, 1.02, length, text, labelpos="E", coordinates="axes", color="#2a9d2a")


def _round(value: float) -> float:
    """The next lower value of 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-9)) * power)


def _arrows(ax: Axes, arrows: Arrows, scale: float) -> Any:
    drawn = ax.quiver(
        *arrows.expected.T,
        *arrows.residual.T,
        color=arrows.color,
        angles="xy",
        scale_units="xy",
        scale=1.0 / scale,
        units="dots",
        width=1.6 * ax.figure.dpi / 100.0,
        headwidth=4.0,
        headlength=4.5,
        headaxislength=4.0,
        minlength=0.5,
        zorder=4,
        gid=f"residuals-{arrows.name}",
    )
    effects = need("matplotlib.patheffects")
    drawn.set_path_effects([effects.withStroke(linewidth=1.5, foreground=_colors.RIM)])
    return drawn
