"""Figures of detections, rigs and clouds: with matplotlib, and in the rerun viewer.

The extra ``viz`` of the package installs both; neither is imported before one of these functions is called. Each
function draws on the given axes, or on those of a new pyplot figure, and returns the axes. None of them shows a
window, chooses a backend or changes matplotlib's settings.

Coordinates are those of slcal: pixels have integer centres, lengths are millimetres, and in 3-D x points right,
y down, z forward. 3-D axes are oriented accordingly: y points down in the figure.
"""

from ._cloud import cloud
from ._overlay import overlay
from ._rerun import to_rerun
from ._rig import rig

__all__ = ["cloud", "overlay", "rig", "to_rerun"]
