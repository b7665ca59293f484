"""Exports as the programs that they are for read them: the same projection of random points."""

from __future__ import annotations

import json
import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slcal
from common import command

#: What double precision and all digits leave, px.
EXACT_PX = 1e-6
#: What single precision leaves, px.
SINGLE_PX = 1e-3

PHOTO = "it's a \"photo\"\n<né> & 日本 \\ '''.jpg"
LENSES = {
    "k3": ([-0.21, 0.12, 2e-3, -1.5e-3, -0.02], [0.08, -0.05, -1e-3, 8e-4, 0.01]),
    "radtan": ([-0.21, 0.12, 2e-3, -1.5e-3, 0.0], [0.08, -0.05, -1e-3, 8e-4, 0.0]),
    "pinhole": ([0.0] * 5, [0.0] * 5),
}
SIZES = {"vga": 0.5, "hd": 1.0, "4k": 3.0}


def rig_of(lens: str, size: str = "hd", skew: float = 0.0) -> slcal.Rig:
    """Unequal focal lengths, and a lens shift that puts the projector's axis far below its panel."""
    s = SIZES[size]
    camera = slcal.Camera(
        [[1510.123456789 * s, skew, 655.3 * s], [0, 1497.7 * s, 441.8 * s], [0, 0, 1]],
        (round(1280 * s), round(960 * s)),
        LENSES[lens][0],
    )
    projector = slcal.Camera(
        [[1612.25 * s, 0, 498.25 * s], [0, 1650.5 * s, 1151.75 * s], [0, 0, 1]],
        (round(1024 * s), round(768 * s)),
        LENSES[lens][1],
    )
    rig = slcal.Rig(camera, projector, slcal.Pose([0.06, -0.23, 0.05], [-310.1, -560.2, 45.3]))
    data = json.loads(rig.to_json())
    pose = {"R": slcal.Pose([0.4, 0.5, 0.05], [0, 0, 0]).R.tolist(), "t": [-200.0, -150.0, 1000.0 / 3]}
    data["views"] = [{"photo": PHOTO, "size_mm": [594, 420], "camera_from_sheet": pose}]
    return slcal.Rig.from_json(json.dumps(data))


def points() -> Any:
    """(1000, 3) mm, in the camera's frame: what both devices of all these rigs see."""
    rng = np.random.default_rng(7)
    xyz = rng.uniform([-600, -500, 900], [600, 500, 2500], (50_000, 3))
    rig = rig_of("pinhole")
    assert rig.projector is not None and rig.projector_from_camera is not None
    lit = rig.projector.project(rig.projector_from_camera.transform(xyz))
    seen = rig.camera.project(xyz)
    limits = [(seen, rig.camera.size), (lit, rig.projector.size)]
    kept = np.all([((px > 0) & (px < np.array(size) - 1)).all(1) for px, size in limits], axis=0)
    assert kept.sum() >= 1000
    return xyz[kept][:1000]


def expected(rig: slcal.Rig) -> tuple[Any, Any]:
    """Their pixels in camera and projector, (1000, 2) each."""
    assert rig.projector is not None and rig.projector_from_camera is not None
    xyz = points()
    return rig.camera.project(xyz), rig.projector.project(rig.projector_from_camera.transform(xyz))


def farthest(found: Any, truth: Any) -> float:
    return float(np.abs(np.asarray(found) - truth).max())


def brown(x: Any, d: Any) -> Any:
    """Distorted normalized points, (N, 2), by the formulas of Brown and Conrady; (k1, k2, p1, p2[, k3])."""
    k1, k2, p1, p2, k3 = [*d, 0.0][:5]
    r2 = (x**2).sum(1)
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    xy = x[:, 0] * x[:, 1]
    shift = np.c_[2 * p1 * xy + p2 * (r2 + 2 * x[:, 0] ** 2), p1 * (r2 + 2 * x[:, 1] ** 2) + 2 * p2 * xy]
    return x * radial[:, None] + shift


@pytest.mark.parametrize("ending", ["yml", "xml", "json"])
@pytest.mark.parametrize("lens", LENSES)
def test_opencv(tmp_path: Path, ending: str, lens: str) -> None:
    cv2: Any = pytest.importorskip("cv2", reason="OpenCV is not installed: pip install opencv-python-headless")
    rig = rig_of(lens)
    file = tmp_path / f"né rig.{ending}"
    assert rig.export(file, "opencv") == []
    storage = cv2.FileStorage(str(file), cv2.FILE_STORAGE_READ)
    read = {n: storage.getNode(n).mat() for n in ("cam_K", "cam_kc", "proj_K", "proj_kc", "R", "T", "camera_matrix")}
    assert storage.getNode("image_width").real() == rig.camera.size[0]
    view = storage.getNode("slcal").getNode("views").at(0)
    assert view.getNode("photo").string() == PHOTO
    assert np.array_equal(view.getNode("camera_from_sheet").getNode("R").mat(), rig.views[0].camera_from_sheet.R)
    truth = expected(rig)
    zero = np.zeros(3)
    for k in ("cam_K", "camera_matrix"):
        seen = cv2.projectPoints(points(), zero, zero, read[k], read["cam_kc"])[0][:, 0]
        assert farthest(seen, truth[0]) < EXACT_PX
    lit = cv2.projectPoints(points(), read["R"], read["T"], read["proj_K"], read["proj_kc"])[0][:, 0]
    assert farthest(lit, truth[1]) < EXACT_PX
    assert slcal.Rig.import_from(file) == rig
    camera = slcal.Camera.load(file)
    assert np.array_equal(camera.K, rig.camera.K) and camera.size == rig.camera.size


def test_opencv_writes_what_is_imported(tmp_path: Path) -> None:
    cv2: Any = pytest.importorskip("cv2", reason="OpenCV is not installed: pip install opencv-python-headless")
    rig = rig_of("k3")
    assert rig.projector is not None and rig.projector_from_camera is not None
    for ending in ("yml", "xml", "json"):
        file = tmp_path / f"calibration.{ending}"
        storage = cv2.FileStorage(str(file), cv2.FILE_STORAGE_WRITE)
        pose = rig.projector_from_camera
        for name, value in {
            "cam_K": rig.camera.K,
            "cam_kc": rig.camera.distortion[None],
            "proj_K": rig.projector.K,
            "proj_kc": rig.projector.distortion[None],
            "R": pose.R,
            "T": np.reshape(pose.t, (3, 1)),
        }.items():
            storage.write(name, np.array(value))
        storage.write("stereo_error", 0.25)
        storage.release()
        with pytest.raises(slcal.Error, match="size of the camera's image"):
            slcal.Rig.import_from(file)
        read = slcal.Rig.import_from(file, camera_size=rig.camera.size, projector_size=rig.projector.size)
        for found, truth in zip(expected(read), expected(rig)):
            assert farthest(found, truth) < EXACT_PX


#: What sensor_msgs/CameraInfo asks for, as its calibration files spell it.
CAMERA_INFO: dict[str, Any] = {
    "type": "object",
    "required": [
        "image_width",
        "image_height",
        "camera_name",
        "camera_matrix",
        "distortion_model",
        "distortion_coefficients",
        "rectification_matrix",
        "projection_matrix",
    ],
    "properties": {
        "image_width": {"type": "integer", "minimum": 1},
        "image_height": {"type": "integer", "minimum": 1},
        "camera_name": {"type": "string", "pattern": "^[A-Za-z0-9_]+$"},
        "distortion_model": {"enum": ["plumb_bob", "rational_polynomial", "equidistant"]},
        **{
            name: {
                "type": "object",
                "required": ["rows", "cols", "data"],
                "properties": {
                    "rows": {"const": rows},
                    "cols": {"const": cols},
                    "data": {
                        "type": "array",
                        "items": {"type": "number"},
                        "minItems": rows * cols,
                        "maxItems": rows * cols,
                    },
                },
            }
            for name, rows, cols in (
                ("camera_matrix", 3, 3),
                ("distortion_coefficients", 1, 5),
                ("rectification_matrix", 3, 3),
                ("projection_matrix", 3, 4),
            )
        },
    },
}


@pytest.mark.parametrize("lens", LENSES)
def test_ros(tmp_path: Path, lens: str) -> None:
    yaml: Any = pytest.importorskip("yaml", reason="PyYAML is not installed")
    jsonschema: Any = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    rig = rig_of(lens)
    left_out = rig.export(tmp_path / "left.yaml", "ros")
    assert len(left_out) == 1 and "poses of the sheet" in left_out[0]
    infos = [yaml.safe_load((tmp_path / n).read_text()) for n in ("left.yaml", "left_projector.yaml")]
    placed = infos[1]["projector_from_camera"]
    R = np.reshape(placed["rotation_matrix"]["data"], (3, 3))
    for info, truth, R_, t in zip(infos, expected(rig), (np.eye(3), R), (np.zeros(3), placed["translation_mm"])):
        jsonschema.validate(info, CAMERA_INFO)
        xyz = points() @ R_.T + t
        K = np.reshape(info["camera_matrix"]["data"], (3, 3))
        raw = brown(xyz[:, :2] / xyz[:, 2:], info["distortion_coefficients"]["data"])
        assert farthest(raw * [K[0, 0], K[1, 1]] + K[:2, 2], truth) < EXACT_PX
        # The rectified image is one without distortion.
        P = np.reshape(info["projection_matrix"]["data"], (3, 4))
        ideal = np.c_[xyz, np.ones(len(xyz))] @ P.T
        undistorted = np.c_[xyz[:, :2] / xyz[:, 2:], np.ones(len(xyz))] @ K.T
        assert farthest(ideal[:, :2] / ideal[:, 2:], undistorted[:, :2]) < EXACT_PX
    read = slcal.Rig.import_from([tmp_path / "left_projector.yaml", tmp_path / "left.yaml"])
    for found, truth in zip(expected(read), expected(rig)):
        assert farthest(found, truth) < EXACT_PX
    # What tf is told is the projector's pose in the camera's frame, in metres.
    call = next(line for line in (tmp_path / "left_projector.yaml").read_text().splitlines() if "--qw" in line)
    words = call.split()
    x, y, z, qw = (float(words[words.index(f"--{n}") + 1]) for n in ("x", "y", "z", "qw"))
    assert rig.projector_from_camera is not None
    centre = -rig.projector_from_camera.R.T @ np.ravel(rig.projector_from_camera.t)
    assert np.allclose(np.array([x, y, z]) * 1000, centre, atol=1e-9)
    assert np.isclose(abs(qw), np.cos(np.linalg.norm(rig.projector_from_camera.rvec) / 2))


@pytest.mark.parametrize("lens", LENSES)
def test_colmap(tmp_path: Path, lens: str) -> None:
    pycolmap: Any = pytest.importorskip("pycolmap", reason="pycolmap is not installed")
    rig = rig_of(lens)
    rig.export(tmp_path / "model", "colmap")
    model = pycolmap.Reconstruction(tmp_path / "model")
    kinds = {"k3": "FULL_OPENCV", "radtan": "OPENCV", "pinhole": "PINHOLE"}
    assert {c.model.name for c in model.cameras.values()} == {kinds[lens]}
    images = {image.name: image for image in model.images.values()}
    for name, truth in zip(("camera.png", "projector.png"), expected(rig)):
        image = images[name]
        xyz = image.cam_from_world() * points()
        found = np.array([image.camera.img_from_cam(p) for p in xyz])
        # COLMAP puts the centre of the first pixel at (0.5, 0.5).
        assert farthest(found - 0.5, truth) < EXACT_PX
    # The sheet's corners are where the camera saw them.
    camera = images["camera.png"]
    assert model.num_points3D() == 4 and camera.num_points3D == 4
    for point in camera.points2D:
        xyz = model.points3D[point.point3D_id].xyz
        assert farthest(camera.project_point(xyz), point.xy) < EXACT_PX
    # A model that COLMAP has written anew.
    again = tmp_path / "again"
    again.mkdir()
    model.write_text(again)
    for folder in (tmp_path / "model", again):
        read = slcal.Rig.import_from(folder)
        for found, truth in zip(expected(read), expected(rig)):
            assert farthest(found, truth) < EXACT_PX


@pytest.mark.parametrize("lens", ["radtan", "pinhole"])
def test_kalibr(tmp_path: Path, lens: str) -> None:
    yaml: Any = pytest.importorskip("yaml", reason="PyYAML is not installed")
    rig = rig_of(lens)
    rig.export(tmp_path / "camchain.yaml", "kalibr")
    chain = yaml.safe_load((tmp_path / "camchain.yaml").read_text())
    T = np.eye(4)
    for cam, device, truth in zip(("cam0", "cam1"), (rig.camera, rig.projector), expected(rig)):
        values = chain[cam]
        assert (values["camera_model"], values["distortion_model"]) == ("pinhole", "radtan")
        assert device is not None and tuple(values["resolution"]) == device.size
        T = np.array(values.get("T_cn_cnm1", np.eye(4))) @ T
        metres = points() / 1000 @ T[:3, :3].T + T[:3, 3]
        fu, fv, pu, pv = values["intrinsics"]
        found = brown(metres[:, :2] / metres[:, 2:], values["distortion_coeffs"]) * [fu, fv] + [pu, pv]
        assert farthest(found, truth) < EXACT_PX
    for found, truth in zip(expected(slcal.Rig.import_from(tmp_path / "camchain.yaml")), expected(rig)):
        assert farthest(found, truth) < EXACT_PX


@pytest.mark.parametrize("skew", [0.0, 0.75])
def test_npz(tmp_path: Path, skew: float) -> None:
    rig = rig_of("k3", skew=skew)
    file = tmp_path / "rig.npz"
    assert rig.export(str(file), "npz") == []
    with np.load(file, allow_pickle=False) as arrays:
        read = dict(arrays)
    truth = expected(rig)
    for name, xyz, pixels in (
        ("camera", points(), truth[0]),
        ("projector", points() @ read["R"].T + read["t"].T, truth[1]),
    ):
        x = brown(xyz[:, :2] / xyz[:, 2:], read[f"{name}_dist"])
        assert farthest((np.c_[x, np.ones(len(x))] @ read[f"{name}_K"].T)[:, :2], pixels) < EXACT_PX
    assert read["view_photo"].tolist() == [PHOTO] and read["camera_size"].tolist() == [1280, 960]
    assert np.array_equal(read["corners_px"][0], rig.views[0].corners_px)
    assert slcal.Rig.import_from(file) == rig
    # The same from NumPy itself, compressed, by columns and in single precision where nothing is lost.
    read["camera_K"] = np.asfortranarray(read["camera_K"])
    read["view_size_mm"] = read["view_size_mm"].astype(np.float32)
    np.savez_compressed(tmp_path / "again.npz", **read)
    assert slcal.Rig.import_from(tmp_path / "again.npz") == rig
    with pytest.raises(slcal.FormatError, match="type"):
        np.savez(tmp_path / "pickled.npz", camera_K=np.array([{}], dtype=object))
        slcal.Rig.import_from(tmp_path / "pickled.npz")


@pytest.mark.parametrize("size", SIZES)
def test_blender(tmp_path: Path, size: str, monkeypatch: pytest.MonkeyPatch) -> None:
    bpy: Any = pytest.importorskip("bpy", reason="Blender is not installed as a module: pip install bpy")
    from bpy_extras.object_utils import world_to_camera_view  # type: ignore[import-not-found]
    from mathutils import Vector  # type: ignore[import-not-found]

    rig = rig_of("pinhole", size)
    file = tmp_path / "né 'rig'.py"
    rig.export(file, "blender")
    bpy.ops.wm.read_factory_settings()
    monkeypatch.setattr(sys, "argv", ["blender", "--python", str(file)])
    runpy.run_path(str(file), run_name="__main__")
    scenes = (bpy.context.scene, bpy.data.scenes["seen by the projector"])
    for scene, device, truth in zip(scenes, (rig.camera, rig.projector), expected(rig)):
        render = scene.render
        assert device is not None and (render.resolution_x, render.resolution_y) == device.size
        found = [world_to_camera_view(scene, scene.camera, Vector((x, z, -y)) / 1000) for x, y, z in points()]
        shares = np.array(found)[:, :2]
        pixels = np.c_[shares[:, 0], 1 - shares[:, 1]] * device.size - 0.5
        assert farthest(pixels, truth) < SINGLE_PX
    names = {o.name for o in bpy.context.scene.objects}
    assert {"camera", "projector", "projector light"} < names and "Cube" not in names
    assert slcal.Rig.import_from(file) == rig


def test_what_a_format_cannot_hold(tmp_path: Path) -> None:
    rig = rig_of("k3")
    for to, name in (("kalibr", "a.yaml"), ("blender", "a.py")):
        with pytest.raises(slcal.Error, match=r"camera's lens.*k3 = -0\.02.* px"):
            rig.export(tmp_path / name, to)  # type: ignore[arg-type]
        assert not (tmp_path / name).exists()
        notes = rig.export(tmp_path / name, to, lossy=True)  # type: ignore[arg-type]
        assert any("k3 = -0.02" in n for n in notes)


def test_wrong_arguments(tmp_path: Path) -> None:
    rig = rig_of("pinhole")
    for to in ("collada", None, 3):
        with pytest.raises(slcal.Error, match="opencv"):
            rig.export(tmp_path / "a.yml", to)  # type: ignore[arg-type]
    with pytest.raises(slcal.Error, match=r"\.yml"):
        rig.export(tmp_path / "a.txt", "opencv")
    with pytest.raises(TypeError):
        rig.export(3, "opencv")  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        rig.export(tmp_path / "none/a.yml", "opencv")
    with pytest.raises(FileNotFoundError):
        slcal.Rig.import_from(tmp_path / "none.yml")
    with pytest.raises(slcal.FormatError, match=r"cameras\.txt"):
        slcal.Rig.import_from(tmp_path)
    (tmp_path / "a.yml").write_text("words")
    with pytest.raises(slcal.FormatError, match=r"a\.yml.*none of the formats"):
        slcal.Rig.import_from(tmp_path / "a.yml")
    with pytest.raises(TypeError):
        slcal.Rig.import_from(3)  # type: ignore[arg-type]


def test_the_command_writes_the_same(tmp_path: Path) -> None:
    rig = rig_of("pinhole")
    rig.save(tmp_path / "rig.json")
    for to, name in (("opencv", "a.yml"), ("kalibr", "a.yaml"), ("blender", "a.py"), ("npz", "a.npz")):
        rig.export(tmp_path / name, to)  # type: ignore[arg-type]
        command("export", "--rig", tmp_path / "rig.json", "--to", to, "-o", tmp_path / f"b{name}")
        assert (tmp_path / name).read_bytes() == (tmp_path / f"b{name}").read_bytes()
        command("import", tmp_path / name, "-o", tmp_path / f"{name}.json")
        assert slcal.Rig.load(tmp_path / f"{name}.json") == slcal.Rig.import_from(tmp_path / name)
