"""Decoded stripes as curves on the photograph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _colors

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Points of one slit are joined over at most this many lines of the photograph, so that only small gaps close.
_JOINED_LINES = 3
#: They are joined when they are at most this many times farther across the stripes than along them; otherwise they
#: are two curves.
_JOINED_LEAN = 2.0
#: Number of slits that are labelled.
_NUMBERED = 16


def joined(pixels: NDArray[np.float64], slits: NDArray[Any]) -> NDArray[np.intp]:
    """For each point the next one along its stripe: (N,) indices, -1 where the stripe ends."""
    if len(pixels) == 0:
        return np.empty(0, dtype=np.intp)
    along = _along(pixels)
    line, across = np.round(pixels[:, along]).astype(np.int64), pixels[:, 1 - along]
    line -= line.min()
    # Lines of all slits one after another, each with room for its neighbours' positions.
    _, slit = np.unique(slits, return_inverse=True)
    strip = slit * (int(line.max()) + 1 + _JOINED_LINES) + line
    room = float(np.ptp(across)) + 1.0
    place = strip * (4.0 * room) + (across - across.min())
    order = np.argsort(place, kind="stable")
    places = place[order]
    following = np.full(len(pixels), -1, dtype=np.intp)
    for step in range(1, _JOINED_LINES + 1):
        todo = np.flatnonzero(following < 0)
        wanted = place[todo] + step * (4.0 * room)
        at = np.searchsorted(places, wanted)
        sides = order[np.clip(np.stack([at - 1, at]), 0, len(order) - 1)]
        lean = np.abs(across[sides] - across[todo]) / step
        lean[strip[sides] != strip[todo] + step] = np.inf
        best = np.argmin(lean, axis=0)
        near = lean[best, np.arange(len(todo))] <= _JOINED_LEAN
        chosen = sides[best, np.arange(len(todo))][near]
        # Of two points with the same next one, one goes on.
        _, first = np.unique(chosen, return_index=True)
        free = first[~np.isin(chosen[first], following)]
        following[todo[near][free]] = chosen[free]
    return following


def _along(pixels: NDArray[np.float64]) -> int:
    """Which coordinate is that of the decoder's scanlines: the one with integer values."""
    whole = (pixels == np.round(pixels)).sum(axis=0)
    return int(whole[1] >= whole[0])


def curves(following: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Indices of the points of each curve, in order along it; a single point is a curve of one."""
    # Every point knows how far it is to one further on; both double until all know their curve's end.
    end = np.where(following < 0, np.arange(len(following)), following)
    steps = (following >= 0).astype(np.int64)
    while (end[end] != end).any():
        steps += steps[end]
        end = end[end]
    order = np.lexsort((-steps, end))
    return np.split(order, np.flatnonzero(np.diff(end[order])) + 1) if len(order) else []


def draw(ax: Axes, pixels: NDArray[np.float64], slits: NDArray[Any]) -> None:
    """Draws a curve per slit in its colour, a dot for a point without neighbours, and the numbers of some slits."""
    known = np.unique(slits[slits >= 0])
    numbered = known[:: max(1, -(-len(known) // _NUMBERED))]
    pieces: dict[int, list[NDArray[np.intp]]] = {}
    for piece in curves(joined(pixels, slits)):
        pieces.setdefault(int(slits[piece[0]]), []).append(piece)
    for slit, color in zip(known.tolist(), _colors.of_slits(known), strict=True):
        long = [pixels[p] for p in pieces[slit] if len(p) > 1]
        short = np.concatenate([np.empty((0, 2)), *(pixels[p] for p in pieces[slit] if len(p) == 1)])
        gap = np.full((1, 2), np.nan)
        curve = np.concatenate([np.empty((0, 2)), *(part for piece in long for part in (piece, gap))])
        ax.plot(*curve.T, color=color, linewidth=1.3, solid_capstyle="round", gid=f"slit-{slit}")
        ax.plot(*short.T, ".", color=color, markersize=2.5, gid=f"slit-{slit}-dots")
    for odd, slit in enumerate(numbered.tolist()):
        own = pixels[slits == slit]
        along = _along(pixels)
        _number(ax, slit, own[np.argmin(own[:, along])], along == 1, bool(odd % 2))
    unknown = pixels[slits < 0]
    if len(unknown):
        ax.plot(*unknown.T, ".", color=_colors.CORNER, markersize=2.5, gid="no-slit")


def _number(ax: Axes, slit: int, start: NDArray[np.float64], upright: bool, further: bool) -> None:
    """A slit's number where its stripe starts, at the top or at the left.

    Every other one stands a little further along the stripe, or they would run into one another.
    """
    x, y = (max(float(c), 0.0) for c in start)
    shift = 13 if further else 4
    ax.annotate(
        str(slit),
        (x, y),
        xytext=(0, -shift) if upright else (1.6 * shift, 0),
        textcoords="offset points",
        ha="center" if upright else "left",
        va="top" if upright else "center",
        fontsize=7,
        color=tuple(_colors.of_slits(np.array([slit]))[0]),
        bbox={"boxstyle": "round,pad=0.15", "facecolor": _colors.RIM, "edgecolor": "none"},
    )
