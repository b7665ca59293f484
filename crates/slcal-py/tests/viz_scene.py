"""A rig with known numbers, and what it sees, computed here from the textbook's formulas alone."""

import json

import numpy as np
import slcal

WIDTH, HEIGHT = 1280, 960
CAMERA_K = np.array([[1500.0, 0, 630.0], [0, 1500.0, 490.0], [0, 0, 1]])
CAMERA_DISTORTION = np.array([-0.12, 0.03, 1e-3, -5e-4, 0.0])
#: Lens shift: the principal point lies at the panel's lower edge.
PROJECTOR_K = np.array([[1600.0, 0, 511.5], [0, 1600.0, 767.5], [0, 0, 1]])
SIZE_MM = (594.0, 420.0)
CORNERS_MM = np.array([[0.0, 0, 0], [594, 0, 0], [594, 420, 0], [0, 420, 0]])


def rotation(x_deg: float, y_deg: float, z_deg: float = 0.0) -> np.ndarray:
    (cx, sx), (cy, sy), (cz, sz) = ((np.cos(a), np.sin(a)) for a in np.radians([x_deg, y_deg, z_deg]))
    turn_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    turn_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    turn_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return turn_z @ turn_y @ turn_x


PROJECTOR_R, PROJECTOR_T = rotation(-3.0, 9.0, 0.5), np.array([-180.0, -300.0, 20.0])
SHEET_R = rotation(20.0, -25.0, 2.0)
SHEET_T = np.array([0.0, 0.0, 1100.0]) - SHEET_R @ np.array([297.0, 210.0, 0.0])


def project(K: np.ndarray, distortion: np.ndarray, points: np.ndarray) -> np.ndarray:
    """OpenCV's plumb-bob model."""
    k1, k2, p1, p2, k3 = distortion
    x, y = (points[:, :2] / points[:, 2:]).T
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    bent_x = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    bent_y = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.column_stack([bent_x, bent_y, np.ones(len(points))]) @ K[:2].T


def camera_px(sheet_mm: np.ndarray) -> np.ndarray:
    """Where the camera sees points (N, 3) of the sheet."""
    return project(CAMERA_K, CAMERA_DISTORTION, sheet_mm @ SHEET_R.T + SHEET_T)


def projector_px(sheet_mm: np.ndarray) -> np.ndarray:
    """Which of the projector's pixels lights points (N, 3) of the sheet."""
    in_camera = sheet_mm @ SHEET_R.T + SHEET_T
    return project(PROJECTOR_K, np.zeros(5), in_camera @ PROJECTOR_R.T + PROJECTOR_T)


def rig(views: int = 1, projector: bool = True) -> slcal.Rig:
    stereo = {"R": PROJECTOR_R.tolist(), "t": PROJECTOR_T.tolist()}
    from_sheet = {"R": SHEET_R.tolist(), "t": SHEET_T.tolist()}
    in_projector = {
        "R": (PROJECTOR_R @ SHEET_R).tolist(),
        "t": (PROJECTOR_R @ SHEET_T + PROJECTOR_T).tolist(),
    }

    def device(K: np.ndarray, distortion: np.ndarray, width: int, height: int) -> dict:
        return {"width": width, "height": height, "K": K.tolist(), "distortion": distortion.tolist()}

    def vanishing(K: np.ndarray, R: np.ndarray) -> list:
        return (K @ R).T[:2].tolist()

    view = {
        "photo": "sheet.jpg",
        "size_mm": SIZE_MM,
        "camera_from_sheet": from_sheet,
        "projector_from_sheet": in_projector if projector else None,
        "vanishing_points": {
            "camera": vanishing(CAMERA_K, SHEET_R),
            "projector": vanishing(PROJECTOR_K, PROJECTOR_R @ SHEET_R) if projector else None,
        },
        "corners_px": camera_px(CORNERS_MM).tolist(),
    }
    written = {
        "schema": "slcal-rig/1",
        "units": "mm",
        "pixel_centre": "integer",
        "camera": device(CAMERA_K, CAMERA_DISTORTION, WIDTH, HEIGHT),
        "projector": device(PROJECTOR_K, np.zeros(5), 1024, 768) if projector else None,
        "projector_from_camera": stereo if projector else None,
        "views": [view] * views,
        "method": "ml",
    }
    return slcal.Rig.from_json(json.dumps(written))


def photo(dtype: type = np.uint8) -> np.ndarray:
    """Any picture of the camera's size."""
    grey = np.linspace(0, np.iinfo(dtype).max, WIDTH).astype(dtype)
    return np.broadcast_to(grey[None, :, None], (HEIGHT, WIDTH, 3)).copy()
