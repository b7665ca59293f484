"""Clouds and meshes are read by the programs that people read them with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slcal

N = (7, 5)


def surface(triangles: bool = True) -> slcal.PointCloud:
    """A grid of points on a curved surface, each with figures of its own."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(N[0]), np.arange(N[1]), indexing="ij"))
    n = len(i)
    corner = (i * N[1] + j)[(i < N[0] - 1) & (j < N[1] - 1)]
    faces = np.r_[
        np.c_[corner, corner + 1, corner + N[1]], np.c_[corner + 1, corner + N[1] + 1, corner + N[1]]
    ]
    return slcal.PointCloud(
        np.c_[40.0 * i - 100, 30.0 * j - 80, 900 + 5.0 * (i - 3) ** 2 + 0.123 * j],
        colors=np.c_[40 * i, 50 * j, 255 - i - j].astype(np.uint8),
        sigma=0.1 + 0.01 * np.arange(n),
        noise=0.05 + 0.005 * np.arange(n),
        slits=np.arange(n) + 1,
        confidence=np.linspace(0.5, 1, n),
        triangles=faces if triangles else None,
    )


@pytest.fixture(scope="module")
def trimesh() -> Any:
    return pytest.importorskip("trimesh", reason="trimesh is not installed: pip install trimesh")


@pytest.mark.parametrize("format", ["ply", "obj", "glb"])
def test_meshes_are_read_by_trimesh(format: str, trimesh: Any, tmp_path: Path) -> None:
    cloud = surface()
    path = tmp_path / f"mesh.{format}"
    cloud.save(path)
    mesh = trimesh.load(path, process=False)
    if format == "glb":  # A scene, of which this is all.
        (mesh,) = mesh.geometry.values()
    assert (mesh.faces == cloud.triangles).all() and len(mesh.faces) == 2 * (N[0] - 1) * (N[1] - 1)
    points = mesh.vertices
    if format == "glb":  # glTF has metres and y upwards.
        points = points * [1000, -1000, -1000]
    # Written in single precision: 1000 mm to a hundredth of a micrometre, and so much again.
    assert np.abs(points - cloud.points).max() < 1e-4
    if format == "glb":  # In linear light; trimesh has them there since the mesh has a material as well.
        colors = encoded(mesh.visual.vertex_attributes["color"])
    else:
        colors = mesh.visual.vertex_colors[:, :3]
    assert (colors == cloud.colors).all()


def encoded(linear: Any) -> Any:
    """sRGB from linear light."""
    x = np.asarray(linear, float)
    return np.round(
        255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    )


@pytest.mark.parametrize("format", ["ply", "glb"])
def test_clouds_are_read_by_trimesh(format: str, trimesh: Any, tmp_path: Path) -> None:
    cloud = surface(triangles=False)
    path = tmp_path / f"cloud.{format}"
    cloud.save(path)
    scene = trimesh.load(path)
    (read,) = scene.geometry.values() if hasattr(scene, "geometry") else (scene,)
    points = read.vertices * ([1000, -1000, -1000] if format == "glb" else 1)
    assert np.abs(points - cloud.points).max() < 1e-4
    if format == "ply":
        assert (read.colors[:, :3] == cloud.colors).all()


def test_every_figure_is_read_by_plyfile(tmp_path: Path) -> None:
    plyfile: Any = pytest.importorskip("plyfile", reason="plyfile is not installed: pip install plyfile")
    cloud = surface()
    cloud.save(tmp_path / "cloud.ply")
    read = plyfile.PlyData.read(tmp_path / "cloud.ply")
    vertex = read["vertex"]
    assert "units mm" in read.comments and "frame camera" in read.comments
    for i, name in enumerate("xyz"):
        assert (vertex[name] == cloud.points[:, i].astype(np.float32)).all()
    for i, name in enumerate(("red", "green", "blue")):
        assert (vertex[name] == cloud.colors[:, i]).all()
    for name, values in (("sigma", cloud.sigma), ("noise", cloud.noise), ("confidence", cloud.confidence)):
        assert (vertex[name] == values.astype(np.float32)).all()
    assert (vertex["slit"] == cloud.slits).all()
    assert (np.stack(read["face"]["vertex_indices"]) == cloud.triangles).all()


def test_clouds_are_read_by_open3d(tmp_path: Path) -> None:
    """Where it is installed; it is too large for every run of the tests."""
    o3d: Any = pytest.importorskip("open3d", reason="Open3D is not installed: pip install open3d")
    cloud = surface()
    for name in ("cloud.ply", "cloud.pcd"):
        cloud.save(tmp_path / name)
        read = o3d.io.read_point_cloud(str(tmp_path / name))
        assert np.abs(np.asarray(read.points) - cloud.points).max() < 1e-4
        assert np.abs(np.asarray(read.colors) * 255 - cloud.colors).max() < 1e-3
