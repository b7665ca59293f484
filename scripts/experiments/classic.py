"""The classic way, with OpenCV: the camera from points of known place on the sheet, the projected corners carried onto the
sheet by the plane's homography, the projector as a second camera that sees those, then both together."""

import cv2
import numpy as np

from measure import Rig, bearings

CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-12)
# One focal length, no tangential distortion: what slcal assumes as well.
BASE = cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K3
NO_DISTORTION = cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2


def single(objects, images, size, focal, flags):
    """calibrateCamera from a start: K, distortion, poses (R, t) per view."""
    guess = np.array([[focal, 0, (size[0] - 1) / 2], [0, focal, (size[1] - 1) / 2], [0, 0, 1]], float)
    flags |= BASE | cv2.CALIB_USE_INTRINSIC_GUESS
    _, k, d, rvecs, tvecs = cv2.calibrateCamera(
        [o.astype(np.float32) for o in objects], [i.astype(np.float32) for i in images],
        size, guess, np.zeros(5), flags=flags, criteria=CRITERIA,
    )  # fmt: skip
    return k, d.ravel()[:5], [(cv2.Rodrigues(r)[0], t.ravel()) for r, t in zip(rvecs, tvecs)]


def start_focal(objects, images, size):
    """Zhang's closed form, as OpenCV has it."""
    k = cv2.initCameraMatrix2D(
        [o.astype(np.float32) for o in objects], [i.astype(np.float32) for i in images], size, 1.0
    )
    return k[0, 0]


def calibrate(observations, boards, distorted, projector_focal):
    """boards: per view the points of known place on the sheet (mm, (N, 2)) and their camera pixels ((N, 2)).
    projector_focal: where the projector's refinement starts (Zhang's closed form fails on shifted lenses)."""
    camera, panel = observations["camera"], observations["projector"]
    camera_size = (camera["width"], camera["height"])
    panel_size = (panel["width"], panel["height"])
    pairs = [np.array([p[:4] for p in v["pairs"]], float) for v in observations["views"]]
    flat = [np.column_stack([mm, np.zeros(len(mm))]) for mm, _ in boards]
    seen = [px for _, px in boards]
    no_distortion = 0 if distorted else NO_DISTORTION
    focal = start_focal(flat, seen, camera_size)
    k, d, poses = single(flat, seen, camera_size, focal, no_distortion)
    lit = []
    for (mm, px), p in zip(boards, pairs):
        ideal = lambda q: bearings(np.ascontiguousarray(q), k, d)[:, :2]
        h, _ = cv2.findHomography(ideal(px), mm)
        on_sheet = cv2.perspectiveTransform(ideal(p[:, :2]).reshape(-1, 1, 2), h).reshape(-1, 2)
        lit.append(np.column_stack([on_sheet, np.zeros(len(on_sheet))]))
    projector_pixels = [p[:, 2:] for p in pairs]
    kp, dp, _ = single(lit, projector_pixels, panel_size, projector_focal, NO_DISTORTION)
    out = cv2.stereoCalibrate(
        [o.astype(np.float32) for o in lit], [p[:, :2].astype(np.float32) for p in pairs],
        [q.astype(np.float32) for q in projector_pixels], k, d, kp, dp, camera_size,
        flags=cv2.CALIB_FIX_INTRINSIC, criteria=CRITERIA,
    )  # fmt: skip
    return Rig(k, d, kp, dp, out[5], out[6].ravel(), poses)
