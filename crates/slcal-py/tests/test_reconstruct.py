"""Clouds of photographs and of matches against the scenes that they show."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from common import DEMO, REPOSITORY

import slcal
from slcal import simulate

CAMERA = slcal.Camera([[1500, 0, 639.5], [0, 1500, 479.5], [0, 0, 1]], (1280, 960), [-0.1, 0.02, 0.001, 0, 0])
PROJECTOR = slcal.Camera([[1700, 0, 511.5], [0, 1700, 383.5], [0, 0, 1]], (1024, 768))
RIG = slcal.Rig(CAMERA, PROJECTOR, slcal.Pose([-0.13, 0.2, 0.01], [-210, -130, 20]))


@pytest.fixture(scope="module")
def scene() -> simulate.Scene:
    return simulate.scene("sphere", camera=(640, 480), focal=750)


def seen(count: int, seed: int = 1) -> tuple[Any, Any, Any]:
    """Points before the rig, their camera pixels and their projector pixels."""
    random = np.random.default_rng(seed)
    points = random.uniform((-150, -100, 900), (150, 100, 1200), (count, 3))
    pose = RIG.projector_from_camera
    assert pose is not None
    return points, CAMERA.project(points), PROJECTOR.project(pose.transform(points))


@pytest.mark.parametrize("known", ["columns", "rows", "both"])
def test_points_come_back_in_their_order(known: str) -> None:
    points, pixels, panel = seen(500)
    columns = panel[:, 0] if known != "rows" else None
    rows = panel[:, 1] if known != "columns" else None
    cloud = RIG.triangulate(pixels, columns, rows)
    assert len(cloud) == 500
    assert np.abs(cloud.points - points).max() < 1e-6
    assert np.array_equal(cloud.pixels, pixels)
    assert cloud.report is not None
    assert cloud.report.points == 500
    assert cloud.report.decode is None
    assert RIG.triangulate(slcal.Matches(pixels, columns, rows)) == cloud


def test_what_is_not_known_is_counted() -> None:
    points, pixels, panel = seen(20)
    columns, rows = panel[:, 0].copy(), panel[:, 1].copy()
    columns[[3, 7]] = np.nan
    cloud = RIG.triangulate(pixels, columns)
    assert np.abs(cloud.points - np.delete(points, [3, 7], axis=0)).max() < 1e-6
    assert cloud.report is not None
    assert cloud.report.triangulate.invalid == 2
    rows[7] = np.nan
    both = RIG.triangulate(pixels, columns, rows)
    assert np.abs(both.points - np.delete(points, 7, axis=0)).max() < 1e-6
    with pytest.raises(slcal.DecodeError, match="20 without coordinates"):
        RIG.triangulate(pixels, np.full(20, np.nan))
    pixels[5, 1] = np.nan
    with pytest.raises(slcal.Error, match="row 5"):
        RIG.triangulate(pixels, columns)


def test_noise_of_a_point_follows_that_of_its_match() -> None:
    _, pixels, panel = seen(50)
    one = RIG.triangulate(pixels, panel[:, 0], sigma_px=0.1)
    two = RIG.triangulate(pixels, panel[:, 0], sigma_px=np.full(50, 0.2))
    assert two.noise == pytest.approx(2 * one.noise, rel=1e-9)
    assert RIG.triangulate(pixels, panel[:, 0]) == one
    matches = slcal.Matches(pixels, panel[:, 0], sigma_px=0.05)
    assert RIG.triangulate(matches).noise == pytest.approx(one.noise / 2, rel=1e-9)
    assert RIG.triangulate(matches, sigma_px=0.1) == one
    # By how much the point moves when its pixel does, column held: measured.
    moved = RIG.triangulate(pixels + (0.01, 0), panel[:, 0])
    straight = slcal.Rig(CAMERA, PROJECTOR, RIG.projector_from_camera).triangulate(pixels, panel[:, 0])
    assert np.linalg.norm(moved.points - straight.points, axis=1).max() < 1


@pytest.mark.parametrize(
    ("pixels", "options", "error", "words"),
    [
        ([[1, 2]], {}, slcal.Error, "columns"),
        ([[1, 2]], {"columns": [1, 2]}, slcal.Error, "columns"),
        ([1, 2, 3], {"columns": [1]}, slcal.Error, "pixels"),
        ([[1, 2]], {"columns": [1], "sigma_px": -1}, slcal.Error, "sigma_px"),
        ([[1, 2]], {"columns": [1], "sigma_px": [1, 2]}, slcal.Error, "sigma_px"),
        ([[1, 2]], {"columns": [1], "cull": -2}, slcal.Error, "cull"),
        ([[1, 2]], {"columns": [1], "cull": "some"}, slcal.Error, "auto"),
        ([[1, 2]], {"columns": [1], "frame": "world"}, slcal.Error, "frame"),
        ([[1, 2]], {"columns": [1], "frame": "plane"}, slcal.Error, "view"),
        ([["a", "b"]], {"columns": [1]}, TypeError, "pixels"),
        (None, {"columns": [1]}, TypeError, "pixels"),
        ([[1, 2]], {"columns": ["a"]}, TypeError, "columns"),
        (slcal.Matches([[1, 2]], [3]), {"columns": [3]}, slcal.Error, "Matches"),
    ],
)
def test_what_cannot_be_triangulated(pixels: Any, options: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        RIG.triangulate(pixels, **options)


def test_a_rig_without_projector_gives_no_points() -> None:
    with pytest.raises(slcal.Error, match="projector"):
        slcal.Rig(CAMERA).triangulate([[1, 2]], [3])
    with pytest.raises(slcal.Error, match="projector"):
        slcal.Reconstructor(slcal.Rig(CAMERA), slcal.StripePattern((1024, 768)))


def test_a_scene_is_reconstructed(scene: simulate.Scene) -> None:
    cloud = scene.rig.reconstruct(scene.photo, scene.pattern, mesh=True)
    u, v = cloud.pixels.round().astype(int).T
    off = np.abs(cloud.points[:, 2] - scene.depth[v, u])
    on_ball = scene.surface[v, u] == 1
    assert len(cloud) > 0.9 * len(scene.matches)
    assert np.median(off) < 0.5
    assert cloud.points[on_ball].shape[0] > 1000
    fit = slcal.PointCloud(cloud.points[on_ball]).fit_sphere()
    assert fit.radius_mm == pytest.approx(180, abs=0.5)
    assert fit.centre_mm == pytest.approx((0, 0, 1000), abs=0.7)
    assert cloud.report is not None
    assert cloud.report.points == len(cloud)
    assert cloud.report.triangles == len(cloud.triangles) > 0
    assert cloud.report.decode is not None
    assert cloud.report.decode == slcal.decode(scene.photo, scene.pattern).report
    normals = np.cross(*(cloud.points[cloud.triangles[:, i]] - cloud.points[cloud.triangles[:, 0]] for i in (1, 2)))
    assert (np.einsum("ij,ij->i", normals, cloud.points[cloud.triangles[:, 0]]) < 0).mean() > 0.99, "they face the camera"


def test_decode_and_triangulate_equal_reconstruct(scene: simulate.Scene) -> None:
    whole = scene.rig.reconstruct(scene.photo, scene.pattern)
    matches = slcal.decode(scene.photo, scene.pattern)
    assert scene.rig.triangulate(matches, cull="auto") == whole
    everything = scene.rig.triangulate(matches)
    assert len(everything) > len(whole)
    assert scene.rig.reconstruct(scene.photo, scene.pattern, cull="off") == everything
    assert len(scene.rig.reconstruct(scene.photo, scene.pattern, min_confidence=0.99)) < len(whole)


def test_the_plane_frame_is_the_sheet() -> None:
    made = simulate.scene("sheet", "stripes", camera=(640, 480), focal=750)
    cloud = made.rig.reconstruct(made.photo, made.pattern, frame="plane")
    assert cloud.frame == "plane"
    assert np.median(np.abs(cloud.points[:, 2])) < 0.5
    assert cloud.points[:, 0].min() > -5
    assert cloud.points[:, 0].max() < 600
    pose = made.rig.views[0].camera_from_sheet
    assert cloud.camera_centre == pytest.approx(pose.inverse().t)
    camera = made.rig.reconstruct(made.photo, made.pattern)
    assert pose.transform(cloud.points) == pytest.approx(camera.points, abs=1e-9)


def test_a_reconstructor_gives_what_one_call_gives(scene: simulate.Scene) -> None:
    other = simulate.scene("plane", camera=(640, 480), focal=750)
    scanner = slcal.Reconstructor(scene.rig, scene.pattern, mesh=True)
    assert "640x480" in repr(scanner)
    expected = [scene.rig.reconstruct(s.photo, s.pattern, mesh=True) for s in (scene, other)]
    first = scanner.reconstruct(scene.photo)
    assert scanner.reconstruct(other.photo) == expected[1]
    assert first == expected[0], "the cloud is its own"
    with pytest.raises(slcal.DecodeError):
        scanner.reconstruct(np.zeros((480, 640, 3), np.uint8))
    again = scanner.reconstruct(scene.photo, black=scene.black, white=scene.white)
    assert again == scene.rig.reconstruct(
        scene.photo, scene.pattern, mesh=True, black=scene.black, white=scene.white
    )
    assert scanner.reconstruct(scene.photo) == expected[0]
    assert scanner.reconstruct(scene.photo).report == expected[0].report


def test_threads_give_the_same_bits(scene: simulate.Scene) -> None:
    photos = [
        scene.photo, *(simulate.scene(s, camera=(640, 480), focal=750).photo for s in ("plane", "step"))
    ] * 4  # fmt: skip
    expected = [scene.rig.reconstruct(p, scene.pattern) for p in photos]
    shared = slcal.Reconstructor(scene.rig, scene.pattern)
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda p: scene.rig.reconstruct(p, scene.pattern), photos)) == expected
        assert list(pool.map(shared.reconstruct, photos)) == expected


def test_python_goes_on_meanwhile(scene: simulate.Scene) -> None:
    large = np.repeat(np.repeat(scene.photo, 4, axis=0), 4, axis=1)
    ticks, done = [0], threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks[0] += 1
            done.wait(1e-4)

    thread = threading.Thread(target=tick)
    thread.start()
    before = ticks[0]
    try:
        slcal.decode(large, scene.pattern)
    except slcal.DecodeError:
        pass
    meanwhile = ticks[0] - before
    done.set()
    thread.join()
    assert meanwhile > 10


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        (lambda image: image[:100], slcal.Error, "640x480"),
        (lambda image: image[..., 0].copy(), slcal.Error, "colour"),
        (lambda image: image.astype(np.float32), TypeError, "float32"),
        (lambda image: None, TypeError, "imread"),
        (lambda image: np.zeros_like(image), slcal.DecodeError, "stripes"),
        (lambda image: image[..., ::-1].copy(), slcal.DecodeError, "red and blue"),
    ],
)
def test_what_is_no_photograph_of_this_rig(scene: simulate.Scene, change: Any, error: type[Exception], words: str) -> None:
    image = change(scene.photo)
    with pytest.raises(error, match=words):
        scene.rig.reconstruct(image, scene.pattern)
    with pytest.raises(error, match=words):
        slcal.Reconstructor(scene.rig, scene.pattern).reconstruct(image)


def test_a_pattern_of_another_panel_is_refused(scene: simulate.Scene) -> None:
    other = slcal.StripePattern((1280, 800))
    with pytest.raises(slcal.Error, match="1280x800"):
        scene.rig.reconstruct(scene.photo, other)
    with pytest.raises(slcal.Error, match="1280x800"):
        slcal.Reconstructor(scene.rig, other)
    with pytest.raises(TypeError):
        scene.rig.reconstruct(scene.photo, slcal.CheckerPattern((1024, 768)))  # type: ignore[arg-type]


@pytest.mark.parametrize("photo", [REPOSITORY / "fixtures/sphere.jpg", DEMO / "board.jpg"], ids=lambda p: p.stem)
def test_rendered_photographs(photo: Path) -> None:
    rig = slcal.Rig.load(DEMO / "truth_rig.json")
    cloud = rig.reconstruct(slcal.read_image(photo), slcal.StripePattern((1024, 768)))
    fit = cloud.fit_sphere() if photo.stem == "sphere" else cloud.fit_plane()
    assert fit.report.inliers > 3000
    assert fit.report.rms_percent < 0.05
