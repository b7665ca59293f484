"""What OpenCV computes as well, slcal computes the same; and each takes what the other gives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slcal

cv2: Any = pytest.importorskip("cv2", reason="OpenCV is not installed: pip install opencv-python-headless")

#: Strong barrel distortion with decentring, of the camera, and pincushion distortion, of the projector.
CAMERA = slcal.Camera(
    [[1210.0, 0.0, 655.3], [0.0, 1195.0, 461.8], [0.0, 0.0, 1.0]],
    (1280, 960),
    [-0.31, 0.12, 2e-3, -1.5e-3, -0.02],
)
#: Its lens shift puts the axis below the panel.
PROJECTOR = slcal.Camera(
    [[1650.0, 0.0, 498.0], [0.0, 1655.0, 851.0], [0.0, 0.0, 1.0]],
    (1024, 768),
    [0.08, -0.05, -1e-3, 8e-4, 0.01],
)
POSE = slcal.Pose(R=[0.21, -0.33, 0.05], t=[-310.0, 160.0, 45.0])
RIG = slcal.Rig(CAMERA, PROJECTOR, POSE)


def points_before_both(n: int = 400) -> Any:
    """Points that camera and projector see, (N, 3) mm."""
    rng = np.random.default_rng(11)
    xyz = np.stack(
        [rng.uniform(-600, 600, 50 * n), rng.uniform(-450, 450, 50 * n), rng.uniform(700, 2500, 50 * n)], 1
    )
    kept = np.ones(len(xyz), bool)
    for device, pose in ((CAMERA, None), (PROJECTOR, POSE)):
        seen = cv2.projectPoints(xyz, *pose_of(pose), device.K, device.distortion)[0][:, 0]
        kept &= ((seen > 0) & (seen < np.array(device.size) - 1)).all(1)
    assert kept.sum() >= n
    return xyz[kept][:n]


def pose_of(pose: slcal.Pose | None) -> tuple[Any, Any]:
    return (np.zeros(3), np.zeros(3)) if pose is None else (pose.rvec, pose.t)


def undistorted(pixels: Any, device: slcal.Camera) -> Any:
    """``cv2.undistortPoints`` iterated to the end: its usual five rounds are not enough here."""
    until = (cv2.TERM_CRITERIA_COUNT, 500, 0.0)
    if hasattr(cv2, "undistortPointsIter"):  # OpenCV 4.
        args = (pixels[:, None], device.K, device.distortion, np.eye(3), np.eye(3), until)
        return cv2.undistortPointsIter(*args)[:, 0]
    return cv2.undistortPoints(pixels[:, None], device.K, device.distortion, criteria=until)[:, 0]


def relative(found: Any, expected: Any) -> float:
    """Largest distance between rows, over the length of the expected ones."""
    off = np.linalg.norm(found - expected, axis=1)
    return float((off / np.linalg.norm(expected, axis=1)).max())


@pytest.mark.parametrize("device", [CAMERA, PROJECTOR], ids=["camera", "projector"])
def test_projection(device: slcal.Camera) -> None:
    points = points_before_both()
    pose = None if device is CAMERA else POSE
    ours = device.project(points if pose is None else pose.transform(points))
    theirs = cv2.projectPoints(points, *pose_of(pose), device.K, device.distortion)[0][:, 0]
    assert np.abs(ours - theirs).max() < 1e-9  # px


@pytest.mark.parametrize("device", [CAMERA, PROJECTOR], ids=["camera", "projector"])
def test_undistortion(device: slcal.Camera) -> None:
    w, h = device.size
    pixels = np.stack(np.meshgrid(np.linspace(0, w - 1, 33), np.linspace(0, h - 1, 25)), -1).reshape(-1, 2)
    ours, theirs = device.undistort(pixels), undistorted(pixels, device)
    assert np.abs(ours - theirs).max() < 1e-9
    rays = np.c_[theirs, np.ones(len(theirs))]
    assert np.abs(device.rays(pixels) - rays / np.linalg.norm(rays, axis=1, keepdims=True)).max() < 1e-9


def test_rotation_vectors() -> None:
    rng = np.random.default_rng(5)
    axes = rng.normal(size=(200, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    # To 179.9 degrees: at 180 both signs of the axis say the same.
    for rvec in axes * np.r_[0, 1e-10, 1e-5, rng.uniform(0, np.radians(179.9), 197)][:, None]:
        R = cv2.Rodrigues(rvec)[0]
        assert np.abs(slcal.Pose(rvec, [0, 0, 0]).R - R).max() < 1e-9
        assert np.abs(slcal.Pose(R, [0, 0, 0]).rvec - rvec).max() < 1e-9


def test_composition_of_poses() -> None:
    other = slcal.Pose([-0.7, 0.2, 1.1], [12.0, -40.0, 900.0])
    both = POSE @ other
    rvec, t = cv2.composeRT(other.rvec, other.t, POSE.rvec, POSE.t)[:2]
    assert np.abs(both.rvec - rvec[:, 0]).max() < 1e-9
    assert np.abs(both.t - t[:, 0]).max() < 1e-9 * np.linalg.norm(t)


def test_triangulation_by_column_and_row() -> None:
    """On positions without noise the least squares of both have the same answer, the point itself.

    With noise they differ: ``cv2.triangulatePoints`` minimises an algebraic error over free points, slcal the
    distance on the panel over points of the camera's ray.
    """
    points = points_before_both()
    pixels, lit = CAMERA.project(points), PROJECTOR.project(POSE.transform(points))
    ours = RIG.triangulate(pixels, lit[:, 0], lit[:, 1]).points
    assert len(ours) == len(points)

    camera, projector = undistorted(pixels, CAMERA), undistorted(lit, PROJECTOR)
    theirs = triangulated(np.eye(3, 4), POSE.matrix[:3], camera, projector)
    assert relative(ours, theirs) < 1e-9
    assert relative(ours, points) < 1e-9


def test_triangulation_on_pixels_without_distortion() -> None:
    camera, projector = (slcal.Camera(d.K, d.size) for d in (CAMERA, PROJECTOR))
    points = points_before_both()
    pixels, lit = camera.project(points), projector.project(POSE.transform(points))
    inside = (lit > 0).all(1) & (lit < np.array(projector.size) - 1).all(1)
    ours = (
        slcal.Rig(camera, projector, POSE).triangulate(pixels[inside], lit[inside, 0], lit[inside, 1]).points
    )
    P = projector.K @ POSE.matrix[:3]
    theirs = triangulated(camera.K @ np.eye(3, 4), P, pixels[inside], lit[inside])
    assert inside.sum() > 300
    assert relative(ours, theirs) < 1e-9


@pytest.mark.parametrize("axis", [0, 1], ids=["columns", "rows"])
def test_triangulation_by_one_coordinate(axis: int) -> None:
    """A column alone is a plane of light (bent by the lens), which OpenCV has no function for: the point is
    where the camera's ray meets it, so that OpenCV, told the row as well, must give the same."""
    points = points_before_both()
    pixels, lit = CAMERA.project(points), PROJECTOR.project(POSE.transform(points))
    ours = RIG.triangulate(pixels, **{("columns", "rows")[axis]: lit[:, axis]})
    # Where the ray nearly runs along the plane of light there is no point.
    ours_by_pixel = {tuple(p): x for p, x in zip(ours.pixels, ours.points, strict=True)}
    kept = [i for i, p in enumerate(pixels) if tuple(p) in ours_by_pixel]
    assert len(kept) > 300
    theirs = triangulated(
        np.eye(3, 4), POSE.matrix[:3], undistorted(pixels[kept], CAMERA), undistorted(lit[kept], PROJECTOR)
    )
    assert relative(np.array([ours_by_pixel[tuple(pixels[i])] for i in kept]), theirs) < 1e-9


def triangulated(P1: Any, P2: Any, first: Any, second: Any) -> Any:
    homogeneous = cv2.triangulatePoints(P1, P2, first.T.copy(), second.T.copy())
    return (homogeneous[:3] / homogeneous[3]).T


def test_rigs_to_opencv_and_back() -> None:
    parameters = RIG.to_opencv()
    again = slcal.Rig.from_opencv(parameters)
    for ours, theirs in ((RIG.camera, again.camera), (RIG.projector, again.projector)):
        assert ours is not None and theirs is not None
        assert (
            (ours.K == theirs.K).all()
            and (ours.distortion == theirs.distortion).all()
            and ours.size == theirs.size
        )
    assert again.projector_from_camera is not None
    assert np.abs(again.projector_from_camera.R - POSE.R).max() < 1e-15
    assert (again.projector_from_camera.t == POSE.t).all()

    # OpenCV's own functions take them as they are: the transform is as stereoCalibrate gives it.
    p = parameters
    rectified = cv2.stereoRectify(
        cameraMatrix1=p["camera_K"], distCoeffs1=p["camera_dist"], cameraMatrix2=p["projector_K"],
        distCoeffs2=p["projector_dist"], imageSize=tuple(p["camera_size"].tolist()), R=p["R"], T=p["t"],
    )  # fmt: skip
    R1, R2, P1, P2 = rectified[:4]
    points = points_before_both()
    # Each in its own frame, so that the baseline, the last column of P2, has no part.
    seen = (P1[:, :3] @ R1 @ points.T, P2[:, :3] @ R2 @ POSE.transform(points).T)
    along = 0 if abs(P2[0, 3]) > abs(P2[1, 3]) else 1
    first, second = (x[1 - along] / x[2] for x in seen)
    assert np.abs(first - second).max() < 1e-7, "rectified, a point has the same row in both"
    assert np.linalg.norm(P2[:, 3]) / P2[0, 0] == pytest.approx(RIG.baseline_mm, rel=1e-12)


def test_rigs_from_stereo_calibration() -> None:
    """The whole way of someone who has calibrated with OpenCV: boards, stereoCalibrate, a rig."""
    rng = np.random.default_rng(2)
    board = np.stack([*np.meshgrid(np.arange(9.0), np.arange(6.0)), np.zeros((6, 9))], -1).reshape(-1, 3) * 30
    camera, projector = (slcal.Camera(d.K, d.size, [*d.distortion[:2], 0, 0, 0]) for d in (CAMERA, PROJECTOR))
    seen: tuple[list[Any], list[Any]] = ([], [])
    for _ in range(8):
        rvec, t = rng.uniform(-0.5, 0.5, 3), rng.uniform([-200, -150, 900], [0, 0, 1100])
        for device, pose, positions in zip(
            (camera, projector), (slcal.Pose(np.eye(3), [0, 0, 0]), POSE), seen, strict=True
        ):
            corners = device.project((pose @ slcal.Pose(rvec, t)).transform(board))
            positions.append(corners.astype(np.float32))
    objects = [board.astype(np.float32)] * 8
    _, K1, d1, K2, d2, R, T, *_ = cv2.stereoCalibrate(
        objects, *seen, camera.K, camera.distortion, projector.K, projector.distortion, camera.size,
        flags=cv2.CALIB_FIX_INTRINSIC,
    )  # fmt: skip
    rig = slcal.Rig.from_opencv(
        camera_K=K1, camera_dist=d1, camera_size=camera.size,
        projector_K=K2, projector_dist=d2, projector_size=projector.size, R=R, t=T,
    )  # fmt: skip
    assert rig.projector_from_camera is not None
    # Single precision is what stereoCalibrate takes.
    assert np.abs(rig.projector_from_camera.t - POSE.t).max() < 0.05
    assert np.abs(rig.projector_from_camera.R - POSE.R).max() < 1e-4
    assert rig.method == "opencv" and rig.quality is None


@pytest.mark.parametrize("name", ["camera.yml", "camera.xml"])
def test_files_that_opencv_wrote(name: str, tmp_path: Path) -> None:
    file = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_WRITE)
    file.write("image_width", CAMERA.width)
    file.write("image_height", CAMERA.height)
    file.write("camera_matrix", CAMERA.K)
    file.write("distortion_coefficients", CAMERA.distortion[None])
    file.release()
    assert slcal.Camera.load(tmp_path / name) == CAMERA


def test_photographs_that_opencv_reads(tmp_path: Path) -> None:
    """Its channels are the other way round, and that is all."""
    rgb = np.random.default_rng(3).integers(0, 256, (20, 30, 3), np.uint8)
    for name in ("a.png", "b.tiff"):
        assert cv2.imwrite(str(tmp_path / name), rgb[..., ::-1])
        assert (slcal.read_image(tmp_path / name) == cv2.imread(str(tmp_path / name))[..., ::-1]).all()
        assert (slcal.read_image(tmp_path / name) == rgb).all()
    deep = rgb.astype(np.uint16) * 257 + 3
    assert cv2.imwrite(str(tmp_path / "deep.png"), deep[..., ::-1])
    assert (slcal.read_image(tmp_path / "deep.png") == deep).all()
