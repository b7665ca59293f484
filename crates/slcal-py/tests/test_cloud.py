"""Clouds as values, files and arrays; what is no cloud."""

from __future__ import annotations

import copy
import io
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slcal
from slcal import simulate

FORMATS = ["ply", "pcd", "xyz", "obj", "glb"]


@pytest.fixture(scope="module")
def cloud() -> slcal.PointCloud:
    scene = simulate.scene("step", camera=(640, 480), focal=750)
    return scene.rig.reconstruct(scene.photo, scene.pattern, mesh=True)


def some() -> slcal.PointCloud:
    """A cloud with different numbers everywhere."""
    n = np.arange(4.0)
    return slcal.PointCloud(
        np.stack([n, -n, 1000 + 100 * n], axis=1), colors=np.arange(12).reshape(4, 3), sigma=0.5 + n, noise=0.25 + n,
        pixels=np.stack([n, [0.5, np.nan, 2, 3]], axis=1), slits=[0, 1, 2, 65535], confidence=n / 4,
        triangles=[[0, 1, 2], [3, 2, 1]], frame="plane", camera_centre=(1, 2, -3),
    )  # fmt: skip


def test_a_cloud_of_arrays_has_what_was_given() -> None:
    made = some()
    assert len(made) == 4
    expected = {
        "points": ([[0, 0, 1000], [1, -1, 1100], [2, -2, 1200], [3, -3, 1300]], np.float64),
        "colors": (np.arange(12).reshape(4, 3), np.uint8),
        "sigma": ([0.5, 1.5, 2.5, 3.5], np.float64),
        "noise": ([0.25, 1.25, 2.25, 3.25], np.float64),
        "pixels": ([[0, 0.5], [1, np.nan], [2, 2], [3, 3]], np.float64),
        "slits": ([0, 1, 2, 65535], np.uint16),
        "confidence": ([0, 0.25, 0.5, 0.75], np.float64),
        "triangles": ([[0, 1, 2], [3, 2, 1]], np.uint32),
        "camera_centre": ([1, 2, -3], np.float64),
    }
    for name, (values, dtype) in expected.items():
        array = getattr(made, name)
        assert array.dtype == dtype, name
        assert np.array_equal(array, values, equal_nan=dtype is np.float64), name
        array[...] = 7
        assert np.array_equal(getattr(made, name), values, equal_nan=dtype is np.float64), "a copy"
    assert made.frame == "plane"
    assert made.report is None


def test_what_is_not_given_is_unknown() -> None:
    made = slcal.PointCloud([[0, 0, 1]])
    assert made.triangles.shape == (0, 3)
    assert made.sigma.tolist() == [0]
    assert np.isnan(made.pixels).all()
    assert made.frame == "camera"
    assert repr(made) == "PointCloud(1 point, 1.0 to 1.0 mm from the camera)"
    empty = slcal.PointCloud(np.empty((0, 3)))
    assert len(empty) == 0
    assert empty.points.shape == (0, 3)
    assert repr(empty) == "PointCloud(0 points)"
    assert "0" in empty._repr_html_()


@pytest.mark.parametrize(
    ("points", "options", "words"),
    [
        ([[1, 2]], {}, "points"),
        ([[1, 2, np.nan]], {}, "row 0"),
        ([[1, 2, np.inf]], {}, "points"),
        ([[1, 2, 3]], {"colors": [[1, 2, 3], [4, 5, 6]]}, "colors"),
        ([[1, 2, 3]], {"colors": [[1, 2, -3]]}, "colors"),
        ([[1, 2, 3]], {"sigma": [1, 2]}, "sigma"),
        ([[1, 2, 3]], {"sigma": -1}, "sigma"),
        ([[1, 2, 3]], {"noise": np.nan}, "noise"),
        ([[1, 2, 3]], {"pixels": [[1, 2, 3]]}, "pixels"),
        ([[1, 2, 3]], {"slits": [-1]}, "slits"),
        ([[1, 2, 3]], {"slits": [65536]}, "slits"),
        ([[1, 2, 3]], {"confidence": [1.5]}, "confidence"),
        ([[1, 2, 3]], {"triangles": [[0, 0, 1]]}, "triangles"),
        ([[1, 2, 3]], {"triangles": [[0, 0, -1]]}, "triangles"),
        ([[1, 2, 3]], {"triangles": [[0, 0]]}, "triangles"),
        ([[1, 2, 3]], {"frame": "sheet"}, "frame"),
        ([[1, 2, 3]], {"camera_centre": [1, 2]}, "camera_centre"),
    ],
)
def test_what_does_not_fit(points: Any, options: Any, words: str) -> None:
    with pytest.raises(slcal.Error, match=words):
        slcal.PointCloud(points, **options)


def test_what_is_no_array() -> None:
    for points in (None, "points", [["a", "b", "c"]], [[1, 2], [3]]):
        with pytest.raises(TypeError, match="points"):
            slcal.PointCloud(points)  # type: ignore[arg-type]


def test_a_cloud_is_an_array_of_its_points(cloud: slcal.PointCloud) -> None:
    assert np.array_equal(np.asarray(cloud), cloud.points)
    assert np.asarray(cloud, dtype=np.float32).dtype == np.float32
    assert np.array_equal(np.array(cloud, copy=True), cloud.points)
    assert np.array_equal(cloud.__array__(np.float32), cloud.points.astype(np.float32))
    if np.lib.NumpyVersion(np.__version__) >= "2.0.0":
        with pytest.raises(ValueError, match="copy"):
            np.array(cloud, copy=False)
    assert np.asarray(cloud).mean(axis=0) == pytest.approx(cloud.points.mean(axis=0))


def test_clouds_are_values(cloud: slcal.PointCloud) -> None:
    for one in (cloud, some()):
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            again = pickle.loads(pickle.dumps(one, protocol))
            assert again == one
            assert again.report == one.report
        assert copy.deepcopy(one) == one
    assert cloud != some()
    assert cloud != cloud.points.tolist()
    changed = slcal.PointCloud(some().points, sigma=some().sigma)
    assert changed != some()
    with pytest.raises(TypeError):
        hash(cloud)


def test_a_cloud_shows_itself(cloud: slcal.PointCloud) -> None:
    far = np.linalg.norm(cloud.points, axis=1)
    for shown in (repr(cloud), cloud._repr_html_()):
        assert str(len(cloud)) in shown
        assert f"{far.min():.1f} to {far.max():.1f} mm" in shown
        assert f"{np.median(cloud.sigma):.3f} mm" in shown
    assert cloud._repr_html_().startswith("<table>")
    assert cloud._repr_html_().count("<tr>") == cloud._repr_html_().count("</tr>") == 5


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_is_written_by_its_name(cloud: slcal.PointCloud, name: str, tmp_path: Path) -> None:
    expected = cloud.to_bytes(name)  # type: ignore[arg-type]
    cloud.save(tmp_path / f"cloud.{name}")
    assert (tmp_path / f"cloud.{name}").read_bytes() == expected
    cloud.save(str(tmp_path / f"CLOUD.{name.upper()}"))
    assert (tmp_path / f"CLOUD.{name.upper()}").read_bytes() == expected
    cloud.save(tmp_path / "cloud.bin", format=name)  # type: ignore[arg-type]
    assert (tmp_path / "cloud.bin").read_bytes() == expected
    stream = io.BytesIO()
    cloud.save(stream, format=name)  # type: ignore[arg-type]
    assert stream.getvalue() == expected
    if name in ("xyz", "obj"):
        text = io.StringIO()
        cloud.save(text, format=name)  # type: ignore[arg-type]
        assert text.getvalue().encode() == expected
    else:
        with pytest.raises(TypeError, match="wb"):
            cloud.save(io.StringIO(), format=name)  # type: ignore[arg-type]
    if name != "ply":
        with pytest.raises(slcal.Error, match="written only"):
            slcal.PointCloud.load(tmp_path / f"cloud.{name}")


def test_ply_holds_everything_but_pixels(cloud: slcal.PointCloud, tmp_path: Path) -> None:
    for one in (cloud, some()):
        one.save(tmp_path / "cloud.ply")
        loaded = slcal.PointCloud.load(tmp_path / "cloud.ply")
        for name in ("points", "sigma", "noise", "confidence"):
            assert np.array_equal(getattr(loaded, name), getattr(one, name).astype(np.float32)), name
        for name in ("colors", "slits", "triangles", "frame", "camera_centre"):
            assert np.array_equal(getattr(loaded, name), getattr(one, name)), name
        assert np.isnan(loaded.pixels).all()
        assert loaded == slcal.PointCloud.load(io.BytesIO(one.to_bytes()))
        assert pickle.loads(pickle.dumps(loaded)) == loaded


def test_other_readers_see_the_same(cloud: slcal.PointCloud, tmp_path: Path) -> None:
    plyfile = pytest.importorskip("plyfile")
    cloud.save(tmp_path / "cloud.ply")
    read = plyfile.PlyData.read(tmp_path / "cloud.ply")
    for name, values in zip("xyz", cloud.points.T, strict=True):
        assert np.array_equal(read["vertex"][name], values.astype(np.float32))
    assert np.array_equal(read["vertex"]["slit"], cloud.slits)
    assert np.array_equal(np.stack(read["face"]["vertex_indices"]), cloud.triangles)
    lines = cloud.to_bytes("xyz").decode().splitlines()
    numbers = [line for line in lines if line and not line.startswith(("#", "//"))]
    assert len(numbers) == len(cloud)
    assert [float(x) for x in numbers[0].split()[:3]] == pytest.approx(cloud.points[0], abs=1e-3)


def test_what_is_no_cloud_file(cloud: slcal.PointCloud, tmp_path: Path) -> None:
    for name in ("cloud", "cloud.stl", "cloud.ply.gz"):
        with pytest.raises(slcal.Error, match=r"\.ply, \.pcd, \.xyz, \.obj or \.glb") as caught:
            cloud.save(tmp_path / name)
        assert name in str(caught.value)
        assert not (tmp_path / name).exists()
    with pytest.raises(slcal.Error, match="stl"):
        cloud.save(tmp_path / "cloud.ply", format="stl")  # type: ignore[arg-type]
    with pytest.raises(slcal.Error, match="stl"):
        cloud.to_bytes("stl")  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        slcal.PointCloud.load(tmp_path / "absent.ply")
    with pytest.raises(FileNotFoundError):
        cloud.save(tmp_path / "absent/cloud.ply")
    (tmp_path / "cut.ply").write_bytes(cloud.to_bytes()[:-10])
    with pytest.raises(slcal.FormatError, match=r"cut\.ply"):
        slcal.PointCloud.load(tmp_path / "cut.ply")
    with pytest.raises(slcal.FormatError, match="ply"):
        slcal.PointCloud.load(io.BytesIO(b"solid cube"))
    with pytest.raises(TypeError, match="path"):
        slcal.PointCloud.load(3)  # type: ignore[arg-type]
    with (tmp_path / "closed.ply").open("wb") as closed:
        pass
    with pytest.raises(ValueError, match="closed"):
        cloud.save(closed)


def test_a_foreign_cloud_may_hold_what_ours_do_not() -> None:
    text = (
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
        "property float sigma\nend_header\n0 0 1 nan\n1 0 1 0.5\nnan 0 1 0.5\n"
    )
    loaded = slcal.PointCloud.load(io.StringIO(text))
    assert loaded.points.tolist() == [[0, 0, 1], [1, 0, 1]]
    assert loaded == loaded  # noqa: PLR0124 - NaN equals NaN here
    assert pickle.loads(pickle.dumps(loaded)) == loaded
    assert "0.500" in repr(loaded)
