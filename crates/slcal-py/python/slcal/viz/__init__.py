"""Pictures of what slcal sees, knows and makes: with matplotlib, and in the rerun viewer.

``pip install slcal[viz]`` brings both; neither is imported before one of these functions is called. Every
function that draws takes the axes to draw on, or makes a new pyplot figure, and returns the axes; none of
them shows a window, chooses a backend or changes matplotlib's settings.

Coordinates are those of the rest of slcal: pixels have integer centres, lengths are millimetres, and in space
x points right, y down, z forward. The 3-D axes are turned so that they look that way: y runs down the
picture.
"""

from ._cloud import cloud
from ._overlay import overlay
from ._rerun import to_rerun
from ._rig import rig

__all__ = ["cloud", "overlay", "rig", "to_rerun"]
