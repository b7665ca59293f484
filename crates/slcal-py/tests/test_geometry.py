import copy
import math
import pickle

import numpy as np
import pytest

import slcal

K = [[1500.0, 0.5, 630.0], [0.0, 1490.0, 470.0], [0.0, 0.0, 1.0]]
DISTORTION = [-0.12, 0.05, 0.001, -0.002, 0.01]


@pytest.fixture
def camera():
    return slcal.Camera(K, (1280, 960), DISTORTION)


def test_projection_is_the_plumb_bob_model(camera):
    x, y, z = 150.0, -90.0, 1000.0
    a, b = x / z, y / z
    k1, k2, p1, p2, k3 = DISTORTION
    r2 = a * a + b * b
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    u = a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a * a)
    v = b * radial + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b
    expected = [K[0][0] * u + K[0][1] * v + K[0][2], K[1][1] * v + K[1][2]]
    assert camera.project([[x, y, z]])[0] == pytest.approx(expected, rel=1e-13)


def test_projection_and_undistortion_round_trip(camera):
    rng = np.random.default_rng(1)
    points = np.stack([*rng.uniform(-300, 300, (2, 50)), rng.uniform(800, 1200, 50)], axis=1)
    seen = camera.project(points)
    assert np.allclose(camera.undistort(seen), points[:, :2] / points[:, 2:], atol=1e-12)
    rays = camera.rays(seen)
    assert np.allclose(np.linalg.norm(rays, axis=1), 1)
    assert np.allclose(np.cross(rays, points), 0, atol=1e-8)


def test_points_come_in_any_form_of_numbers(camera):
    points = np.array([[10, 20, 1000], [-30, 40, 900]])
    expected = camera.project(points.astype(float))
    for given in (points.tolist(), points.astype(np.float32), points.astype(np.uint16) * 1, points[:, None, :], points[::-1][::-1]):
        if given is not None and np.asarray(given).min() >= -30 and np.asarray(given).max() <= 1000:
            assert (camera.project(given) == expected).all()
    assert camera.project([10, 20, 1000]).shape == (1, 2)
    assert camera.project(np.zeros((0, 3))).shape == (0, 2)


def test_points_without_a_pixel_are_refused(camera):
    with pytest.raises(slcal.Error, match="row 1"):
        camera.project([[0, 0, 1000], [0, 0, -1000]])
    with pytest.raises(slcal.Error, match=r"finite.*row 2") as caught:
        camera.project([[0, 0, 1], [0, 0, 1], [0, np.nan, 1]])
    assert caught.value.what == "points"
    with pytest.raises(slcal.Error, match=r"shape \(N, 3\).*shape \(4, 2\)"):
        camera.project(np.ones((4, 2)))
    with pytest.raises(TypeError, match="complex"):
        camera.project(np.ones((4, 3), complex))
    with pytest.raises(TypeError, match="points"):
        camera.project("nonsense")
    with pytest.raises(TypeError, match="points"):
        camera.project(None)


def test_no_result_is_infinite():
    thin = slcal.Camera(np.diag([1e-300, 1e-300, 1]), (10, 10))
    for way in (thin.undistort, thin.rays):
        with pytest.raises(slcal.Error, match="row 1"):
            way([[0, 0], [1e300, 1e300]])
    with pytest.raises(slcal.Error, match="row 0"):
        slcal.Camera(np.diag([1e300, 1e300, 1]), (10, 10)).project([[1e300, 0, 1e-5]])


def test_cameras_by_other_names():
    wide = slcal.Camera.from_fov((1280, 960), 60)
    left, right = wide.rays([[-0.5, 479.5], [1279.5, 479.5]])
    assert math.degrees(math.acos(left @ right)) == pytest.approx(60)
    film = slcal.Camera.from_35mm((3600, 2400), 50)
    assert film.K[0, 0] == pytest.approx(5000)
    projector = slcal.Camera.from_throw((1000, 700), 1.5)
    assert projector.K.tolist() == [[1500, 0, 499.5], [0, 1500, 699.5], [0, 0, 1]]
    for wrong in (0, -1, math.nan, math.inf, 180):
        with pytest.raises(slcal.Error):
            slcal.Camera.from_fov((10, 10), wrong)
    for wrong in (0, -1, math.nan, math.inf):
        with pytest.raises(slcal.Error):
            slcal.Camera.from_throw((10, 10), wrong)
        with pytest.raises(slcal.Error):
            slcal.Camera.from_35mm((10, 10), wrong)


def test_no_camera_is_refused():
    for wrong in (np.eye(2), np.zeros((3, 3)), [[-1, 0, 0], [0, 1, 0], [0, 0, 1]], [[1, 0, 0], [0, 1, 0], [0, 1, 1]]):
        with pytest.raises(slcal.Error):
            slcal.Camera(wrong, (10, 10))
    for wrong in ((0, 10), (10,), (10.5, 10), "ab", None, (1, 2, 3)):
        with pytest.raises(slcal.Error, match="size"):
            slcal.Camera(np.eye(3), wrong)
    with pytest.raises(slcal.Error, match="distortion"):
        slcal.Camera(np.eye(3), (10, 10), [0, 0, 0, 0, 0, 0.1])
    # As OpenCV gives it: one row, and zeros for what is not used.
    assert slcal.Camera(np.eye(3), (10, 10), np.zeros((1, 8))).distortion.tolist() == [0] * 5


def test_poses_are_a_group():
    rng = np.random.default_rng(2)
    a, b = (slcal.Pose(rng.normal(size=3), rng.normal(size=3) * 100) for _ in range(2))
    points = rng.normal(size=(20, 3)) * 500
    assert np.allclose((a @ b).transform(points), a.transform(b.transform(points)))
    assert np.allclose(a.inverse().transform(a.transform(points)), points)
    assert np.allclose((a @ a.inverse()).matrix, np.eye(4), atol=1e-12)
    assert np.allclose(a.matrix[:3] @ np.append(points[0], 1), a.transform(points[:1])[0])
    assert slcal.Pose(a.rvec, a.t).R == pytest.approx(a.R)
    with pytest.raises(TypeError):
        a @ 3


def test_no_rotation_is_refused():
    for wrong in (2 * np.eye(3), np.diag([1, 1, -1]), np.full((3, 3), np.nan), np.eye(2)):
        with pytest.raises(slcal.Error):
            slcal.Pose(wrong, [0, 0, 0])
    with pytest.raises(slcal.Error):
        slcal.Pose(np.eye(3), [0, 0])


def test_values_are_values(camera):
    pose = slcal.Pose([0.1, 0.2, 0.3], [1, 2, 3])
    for value in (camera, pose):
        assert pickle.loads(pickle.dumps(value)) == value
        assert copy.deepcopy(value) == value
        assert value != 3
        assert type(value).__name__ in repr(value)
    assert camera != slcal.Camera(K, (1280, 960))
    with pytest.raises(AttributeError):
        camera.width = 3
    k = camera.K
    k[0, 0] = 0
    assert camera.K[0, 0] == 1500
