"""Projector-camera calibration from one photograph and one-shot structured-light reconstruction.

Pixels have integer centres; pictures are (height, width, 3) arrays of uint8 in RGB order.
"""

from ._slcal import CheckerPattern, StripePattern, __version__

__all__ = ["CheckerPattern", "StripePattern", "__version__"]
