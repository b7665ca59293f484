"""Detections and matches, drawn on their photograph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import CornerDetection, Detection, Matches, Rig, SheetDetection, View, ViewObservation
from . import _check, _colors, _picture, _residuals, _sheet, _stripes
from ._extras import need

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Names of the sheet's corners, in their order.
CORNER_NAMES = ("TL", "TR", "BR", "BL")


def overlay(
    image: NDArray[np.uint8] | NDArray[np.uint16],
    found: Detection | SheetDetection | CornerDetection | ViewObservation | Matches,
    ax: Axes | None = None,
    *,
    rig: Rig | None = None,
    view: int = 0,
    magnify: float | None = None,
    gamma: Literal["srgb", "linear"] | float = "srgb",
) -> Axes:
    """Draws detections or matches on their photograph.

    For a detection or an observation: the sheet's outline with its corners named TL TR BR BL, the points
    measured on its edges, and the corners of the projected pattern, the first one in orange. For matches: a
    curve per stripe on the dimmed photograph. Each slit has its own colour (neighbours differ most), and some have
    their number beside the curve.

    With `rig`, arrows also show the residuals, from the predicted to the observed position of the pattern's
    corners and the edge points. They are magnified; a reference arrow above the picture gives the scale. The
    outline is then the predicted one, with distortion.

    Parameters
    ----------
    image : ndarray
        The photograph, (H, W, 3) RGB or (H, W), uint8 or uint16.
    found : Detection, SheetDetection, CornerDetection, ViewObservation or Matches
        What to draw.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default the axes of a new pyplot figure.
    rig : Rig, optional
        The calibrated rig for the residuals.
    view : int
        Which of the rig's views the photograph is.
    magnify : float, optional
        Magnification of the residuals; by default a round number that makes long ones (the 90th percentile) a
        fortieth of the image's diagonal.
    gamma : "srgb", "linear" or float
        The transfer curve of the image; it affects only the appearance of the photograph.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in pixels.

    Raises
    ------
    ImportError
        When matplotlib is not installed.
    TypeError
        When `image` is no array of uint8 or uint16, or `found` is something else.
    slcal.Error
        When shapes are wrong, the image is not of the size of the rig's camera, what was found lies outside
        of it, the rig has no such view, or nothing was found that can be compared with it.

    Examples
    --------
    >>> import slcal, slcal.viz
    >>> checker = slcal.CheckerPattern((1024, 768))
    >>> corners = slcal.detect_corners(checker.image(), checker)
    >>> ax = slcal.viz.overlay(checker.image(), corners)
    >>> ax.get_legend().get_texts()[0].get_text()
    '70 of 70 corners of the pattern'
    >>> ax.figure.savefig("corners.png")  # doctest: +SKIP
    """
    picture = _check.image(image)
    if rig is not None:
        _check.image_of(picture, rig.camera)
    if isinstance(found, Matches):
        if rig is not None:
            raise Error(
                "rig: residuals are drawn for what was found of a sheet, not for matches; leave rig out"
            )
        return _draw_matches(picture, found, ax, gamma)
    seen = _sheet.of(found)
    _check.pixels_in(seen.camera_px, picture, "corners of the pattern")
    for side, points in seen.edges.items():
        _check.pixels_in(points, picture, f"points of the {side} edge")
    height, width = picture.shape[:2]
    residuals = None
    if rig is not None:
        residuals = _residuals.measure(rig, _view(rig, view), seen, float(np.hypot(width, height)), magnify)
    shown = _picture.displayed(picture, gamma)
    ax = _picture.axes(ax, width, height)
    _picture.show(ax, shown, seen.corners)
    _draw_sheet(ax, seen, None if residuals is None else residuals.outline)
    _draw_pattern(ax, seen, 7.0 if rig is None else 4.0)
    if residuals is not None:
        _residuals.draw(ax, residuals)
    _picture.legend(ax)
    return ax


def _view(rig: Rig, view: int) -> View:
    views = rig.views
    if not 0 <= view < len(views):
        raise Error(f"view: expected one of the rig's {len(views)} views, counted from 0, found {view}")
    return views[view]


def _draw_matches(
    picture: NDArray[Any], matches: Matches, ax: Axes | None, gamma: Literal["srgb", "linear"] | float
) -> Axes:
    pixels, slits = matches.pixels, matches.slits
    _check.pixels_in(pixels, picture, "matches")
    shown = _picture.dimmed(_picture.displayed(picture, gamma))
    ax = _picture.axes(ax, picture.shape[1], picture.shape[0])
    _picture.show(ax, shown)
    _stripes.draw(ax, pixels, slits)
    return ax


def _rim(width: float) -> list[Any]:
    """A dark outline, which makes bright colours visible on white."""
    effects = need("matplotlib.patheffects")
    return [effects.withStroke(linewidth=width, foreground=_colors.RIM)]


def _draw_sheet(ax: Axes, seen: _sheet.SheetParts, expected: NDArray[np.float64] | None) -> None:
    """Draws the outline (predicted, or straight between corners), the points of the edges, and the names of the corners."""
    corners, outline, label = seen.corners, expected, "sheet, as the rig expects it"
    if outline is None and corners is not None:
        outline, label = np.concatenate([corners, corners[:1]]), "sheet"
    if outline is not None:
        look: dict[str, Any] = {"color": _colors.SHEET, "linewidth": 1.2, "path_effects": _rim(2.2)}
        ax.plot(*outline.T, label=label, gid="sheet", **look)
    sides = [points for points in seen.edges.values() if len(points)]
    if sides:
        points = np.concatenate(sides)
        ax.plot(
            *points.T,
            ".",
            color=_colors.EDGE_POINT,
            markersize=3.5,
            markeredgewidth=0.0,
            path_effects=_rim(0.6),
            label=f"{len(points)} edge points",
            gid="edge-points",
        )
    if corners is not None:
        inwards = corners.mean(axis=0) - corners
        inwards /= np.maximum(np.hypot(*inwards.T), 1e-9)[:, None]
        for corner, name, (x, y) in zip(corners, CORNER_NAMES, inwards, strict=True):
            ax.annotate(
                name,
                (float(corner[0]), float(corner[1])),
                xytext=(17 * x, -17 * y),  # Points upwards, pixels downwards.
                textcoords="offset points",
                ha="center",
                va="center",
                fontsize=11,
                fontweight="bold",
                color=_colors.SHEET,
                path_effects=_rim(2.5),
                annotation_clip=False,
            )


def _draw_pattern(ax: Axes, seen: _sheet.SheetParts, size: float) -> None:
    points = seen.camera_px
    if len(points) == 0:
        return
    # Rows of the board are joined; the way back to the next row's start would cross it.
    broken = np.flatnonzero(np.abs(np.diff(seen.projector_px[:, 1])) > 1e-6) + 1
    rows = np.insert(points, broken, np.nan, axis=0)
    ax.plot(*rows.T, color=_colors.CORNER, linewidth=0.7, gid="pattern-rows")
    of = "" if seen.expected is None else f" of {seen.expected}"
    ax.plot(
        *points.T,
        "o",
        markerfacecolor="none",
        markeredgecolor=_colors.CORNER,
        markersize=size,
        markeredgewidth=1.2,
        path_effects=_rim(2.0),
        label=f"{len(points)}{of} corners of the pattern",
        gid="pattern-corners",
    )
    ax.plot(
        *points[:1].T,
        "o",
        markerfacecolor="none",
        markeredgecolor=_colors.FIRST_CORNER,
        markersize=size,
        markeredgewidth=1.8,
        label="its first" if len(points) > 1 else None,
        gid="pattern-first",
    )
