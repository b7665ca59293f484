"""Projector-camera calibration from one photograph and one-shot structured-light reconstruction.

Arrays in, arrays out, in OpenCV's conventions: x right, y down, z forward; pixels have integer centres; lengths are
millimetres. Photographs are (H, W, 3) or (H, W) arrays of uint8 or uint16 in RGB order (OpenCV reads BGR: give
``image[..., ::-1]``).
"""

from ._errors import CalibrationError, DecodeError, DetectionError, Error, FormatError
from ._slcal import (
    Camera,
    CheckerPattern,
    Covariance,
    Matches,
    PointCloud,
    Pose,
    Reconstructor,
    Rig,
    StripePattern,
    View,
    __version__,
    decode,
    evaluate,
    load_pattern,
    read_image,
)

__all__ = [
    "CalibrationError",
    "Camera",
    "CheckerPattern",
    "Covariance",
    "DecodeError",
    "DetectionError",
    "Error",
    "FormatError",
    "Matches",
    "PointCloud",
    "Pose",
    "Reconstructor",
    "Rig",
    "StripePattern",
    "View",
    "__version__",
    "decode",
    "evaluate",
    "load_pattern",
    "read_image",
]
