"""The parts of a detected sheet, from any of slcal's results."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._slcal import CornerDetection, Detection, SheetDetection, ViewObservation


@dataclass(frozen=True)
class SheetParts:
    """The sheet's corners TL TR BR BL (4, 2), points of its edges by side, the pattern's corners (N, 2)."""

    corners: NDArray[np.float64] | None = None
    edges: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    camera_px: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    projector_px: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    #: How many corners the pattern has, where it is known.
    expected: int | None = None


def of(found: Any) -> SheetParts:
    """The parts of a detection or an observation.

    Raises
    ------
    TypeError
        For anything else.
    """
    if isinstance(found, Detection):
        sheet, pattern = of(found.sheet), of(found.corners)
        return SheetParts(sheet.corners, sheet.edges, pattern.camera_px, pattern.projector_px, pattern.expected)
    if isinstance(found, SheetDetection):
        return SheetParts(found.corners, found.edges)
    if isinstance(found, CornerDetection):
        return SheetParts(camera_px=found.camera_px, projector_px=found.projector_px, expected=found.expected)
    if isinstance(found, ViewObservation):
        pairs = found.pairs
        return SheetParts(found.sheet_corners, found.sheet_edges or {}, pairs[:, :2], pairs[:, 2:])
    raise TypeError(
        "found: expected a slcal.Detection, SheetDetection, CornerDetection, ViewObservation or Matches, "
        f"found {type(found).__name__}; slcal.detect and slcal.decode make them"
    )
