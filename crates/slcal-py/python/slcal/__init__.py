"""Projector-camera calibration from one photograph and one-shot structured-light reconstruction.

Arrays in, arrays out, in OpenCV's conventions: x right, y down, z forward; pixels have integer centres; lengths are
millimetres. Photographs are (H, W, 3) or (H, W) arrays of uint8 or uint16 in RGB order (OpenCV reads BGR: give
``image[..., ::-1]``).
"""

from ._errors import CalibrationError, DecodeError, DetectionError, Error, FormatError
from ._slcal import (
    Camera,
    CheckerPattern,
    CornerDetection,
    Covariance,
    Detection,
    Matches,
    Observations,
    PointCloud,
    Pose,
    Reconstructor,
    Rig,
    SheetDetection,
    StripePattern,
    View,
    ViewObservation,
    __version__,
    decode,
    detect,
    detect_corners,
    detect_sheet,
    evaluate,
    load_pattern,
    observe,
    read_image,
)

__all__ = [
    "CalibrationError",
    "Camera",
    "CheckerPattern",
    "CornerDetection",
    "Covariance",
    "DecodeError",
    "Detection",
    "DetectionError",
    "Error",
    "FormatError",
    "Matches",
    "Observations",
    "PointCloud",
    "Pose",
    "Reconstructor",
    "Rig",
    "SheetDetection",
    "StripePattern",
    "View",
    "ViewObservation",
    "__version__",
    "decode",
    "detect",
    "detect_corners",
    "detect_sheet",
    "evaluate",
    "load_pattern",
    "observe",
    "read_image",
]
