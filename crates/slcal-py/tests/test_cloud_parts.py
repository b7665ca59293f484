"""Clouds by index and within a box."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import slcal
from slcal import simulate


@pytest.fixture
def cloud() -> slcal.PointCloud:
    return slcal.PointCloud(
        [[0, 0, 900], [10, 0, 1000], [0, 10, 1100], [10, 10, 1200]],
        colors=np.arange(12).reshape(4, 3),
        sigma=[0.1, 0.2, 0.3, 0.4],
        noise=[0.01, 0.02, 0.03, 0.04],
        pixels=np.arange(8.0).reshape(4, 2),
        slits=[5, 6, 7, 8],
        confidence=[0.5, 0.6, 0.7, 0.8],
        triangles=[[0, 1, 2], [1, 3, 2]],
        frame="plane",
        camera_centre=[1, 2, -3],
    )


def test_every_array_is_indexed_as_numpy_does(cloud: slcal.PointCloud) -> None:
    for index in (
        np.array([True, False, True, True]),
        np.array([3, 1]),
        np.array([-1, 0], dtype=np.int8),
        np.array([], dtype=int),
        [2, 2, 0],
        slice(None),
        slice(1, None),
        slice(None, None, -2),
        cloud.sigma < 0.35,
        ...,
    ):
        part = cloud[index]
        for name in ("points", "colors", "sigma", "noise", "pixels", "slits", "confidence"):
            assert np.array_equal(getattr(part, name), getattr(cloud, name)[index]), (name, index)
        assert part.frame == "plane" and part.camera_centre.tolist() == [1, 2, -3]
        assert part.report is None
        assert pickle.loads(pickle.dumps(part)) == part
    assert cloud[:] == cloud


def test_triangles_follow_their_points(cloud: slcal.PointCloud) -> None:
    assert cloud[1:].triangles.tolist() == [[0, 2, 1]]
    assert cloud[[3, 2, 1, 0]].triangles.tolist() == [[3, 2, 1], [2, 0, 1]]
    assert cloud[[0, 3]].triangles.shape == (0, 3)
    # Of a point that is given twice the first counts.
    assert cloud[[1, 1, 2, 3]].triangles.tolist() == [[0, 3, 2]]


@pytest.mark.parametrize("index", [0, np.int64(1), (0, 1), None, np.zeros((2, 2), int)])
def test_what_is_no_part(cloud: slcal.PointCloud, index: object) -> None:
    with pytest.raises((TypeError, IndexError)):
        cloud[index]  # type: ignore[index]


def test_what_numpy_refuses(cloud: slcal.PointCloud) -> None:
    with pytest.raises(IndexError, match="boolean"):
        cloud[np.array([True, False])]
    with pytest.raises(IndexError, match="out of bounds"):
        cloud[np.array([4])]
    with pytest.raises(IndexError):
        cloud[np.array([0.5])]  # type: ignore[index]
    with pytest.raises(TypeError, match=r"cloud\.points\[i\]"):
        cloud[0]  # type: ignore[index]
    with pytest.raises(TypeError):
        iter(cloud)  # type: ignore[call-overload]


def test_crop(cloud: slcal.PointCloud) -> None:
    assert cloud.crop([0, 0, 900], [10, 10, 1100]) == cloud[:3]
    assert cloud.crop([-np.inf] * 3, [np.inf] * 3) == cloud
    assert cloud.crop(min=(0, 0, 950), max=(np.inf, np.inf, np.inf)) == cloud[1:]
    assert len(cloud.crop([20, 0, 0], [30, 10, 2000])) == 0
    for low, high, said in (
        ([0, 0, 2], [0, 0, 1], "max: expected no z below the 2 of min, found 1"),
        ([0, 0, np.nan], [1, 1, 1], "min: .* NaN"),
        ([0, 0], [1, 1, 1], r"min: .* shape \(2,\)"),
    ):
        with pytest.raises(slcal.Error, match=said):
            cloud.crop(low, high)
    with pytest.raises(TypeError, match="min"):
        cloud.crop("a", [1, 1, 1])  # type: ignore[arg-type]


def test_depth_limits() -> None:
    scene = simulate.scene("sphere", camera=(640, 480), focal=750)
    stripes = scene.pattern
    assert isinstance(stripes, slcal.StripePattern)
    whole = scene.rig.reconstruct(scene.photo, stripes)
    depth = whole.points[:, 2]
    near, far = np.quantile(depth, [0.2, 0.8])
    scanner = slcal.Reconstructor(scene.rig, stripes, near=near, far=far)
    for cloud in (
        scene.rig.reconstruct(scene.photo, stripes, near=near, far=far),
        scanner.reconstruct(scene.photo),
        scene.rig.triangulate(slcal.decode(scene.photo, stripes), near=near, far=far),
    ):
        assert near <= cloud.points[:, 2].min() and cloud.points[:, 2].max() <= far
        assert cloud.report.triangulate.outside_depth > 0.3 * len(whole)
    assert whole.report.triangulate.outside_depth == 0
    with pytest.raises(slcal.Error, match="far_mm"):
        scene.rig.reconstruct(scene.photo, stripes, near=2, far=1)
