"""The examples run, say what they should, and find what is known to be true."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from common import REPOSITORY, check_types
from PIL import Image

import slcal
from slcal import simulate

EXAMPLES = REPOSITORY / "examples"
#: What they import beside slcal and NumPy.
NEEDS = {"webcam.py": "cv2", "tour.py": "matplotlib", "ray_folder.py": "ray"}
SIZE_MM = (594.0, 420.0)

pytestmark = pytest.mark.skipif(not EXAMPLES.is_dir(), reason="outside the repository, without examples")


def runnable() -> list[str]:
    return sorted(p.name for p in EXAMPLES.glob("*.py") if missing(p.name) is None)


def missing(name: str) -> str | None:
    module = NEEDS.get(name)
    return module if module and importlib.util.find_spec(module) is None else None


def run(name: str, *args: str | Path, cwd: Path, code: int = 0) -> str:
    """Both streams of an example."""
    if missing(name):
        pytest.skip(f"{name} needs {missing(name)}, which is not installed")
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [sys.executable, "-W", "error", EXAMPLES / name, *map(str, args)],
        cwd=cwd,
        capture_output=True,
        text=True,
        env=environment,
        timeout=300,
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, slcal.Rig, slcal.PointCloud]:
    """What somebody photographs, mistakes included; the true rig, and the true points that the camera
    sees."""
    photos = tmp_path_factory.mktemp("photographs")
    lens_and_light = {"camera": (960, 720), "focal": 1065, "projector_focal": 1450, "lens_shift": 0.4}
    first = simulate.scene("sheet", size_mm=SIZE_MM, tilt=(24, 27), noise=1.5, seed=4, **lens_and_light)
    rig = first.rig
    second = simulate.scene("sheet", rig=rig, size_mm=SIZE_MM, tilt=(-24, -26), noise=1.5, seed=5)
    ball = simulate.scene("sphere", rig=rig, noise=1.5, seed=7)
    shown = {
        "sheet0_of_the_ball": ball.white,  # No sheet.
        "sheet1": first.photo,
        "sheet2": second.photo,
        "sheet3_not_needed": first.white,
        "scan1": ball.photo,
        "scan2_without_stripes": ball.white,
    }
    for name, picture in shown.items():
        Image.fromarray(picture).save(photos / f"{name}.png")
    (photos / "sheet9_broken.png").write_bytes(b"no picture")
    return photos, rig, ball.cloud


def test_webcam(folder: Any, tmp_path: Path) -> None:
    photos, truth, true_points = folder
    said = run("webcam.py", "--size", "594x420", "--images", photos, "--out", tmp_path / "out", cwd=tmp_path)

    lines = {
        line.split(":")[0]: line for line in said.splitlines() if ":" in line and not line.startswith(" ")
    }
    assert "not found" in lines["sheet0_of_the_ball"]
    assert "Rig(" in lines["sheet1"] and "next: hold the sheet" in said
    assert "Rig(" in lines["sheet2"] and "calibrated." in said and "sheet3_not_needed" not in lines
    assert "points" in lines["scan1"] and "points," not in lines["scan2_without_stripes"]
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["rig.json", "scan1.ply"]

    rig = slcal.Rig.load(tmp_path / "out/rig.json")
    for found, true in ((rig.camera, truth.camera), (rig.projector, truth.projector)):
        assert abs(found.K[0, 0] - true.K[0, 0]) < 4 * found.sigma.focal_px < 4 * 1.1e-3 * true.K[0, 0]
    cloud = slcal.PointCloud.load(tmp_path / "out/scan1.ply")
    assert len(cloud) > 3000
    # The truth has a point wherever the camera sees the middle of a slit.
    fit, true_fit = slcal.evaluate(cloud, "sphere"), slcal.evaluate(true_points, "sphere")
    assert fit.radius_mm == pytest.approx(true_fit.radius_mm, rel=0.01)
    assert np.linalg.norm(np.subtract(fit.centre_mm, true_fit.centre_mm)) < 5 * np.median(cloud.sigma)
    assert fit.report.rms_mm < 1


def test_webcam_with_a_camera(
    folder: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    """By a camera that sees what the projector shows, and somebody who presses keys."""
    cv2: Any = pytest.importorskip(
        "cv2", reason="OpenCV is not installed: pip install opencv-python-headless"
    )
    photos = folder[0]
    checker, stripes = slcal.CheckerPattern((1024, 768)), slcal.StripePattern((1024, 768))
    drawn = checker.image(), stripes.image()
    keys = iter([-1, ord(" "), -1, ord(" "), -1, ord(" "), ord("q")])
    frames = {p.stem: cv2.imread(str(p)) for p in photos.glob("*[123].png")}
    shown: dict[str, Any] = {}
    pressed = []

    class Camera:
        def __init__(self, index: int) -> None:
            assert index == 3

        def isOpened(self) -> bool:
            return True

        def set(self, what: int, value: float) -> bool:
            return True

        def read(self) -> tuple[bool, Any]:
            if (shown["projector"][..., ::-1] == drawn[0]).all():
                name = "sheet1" if pressed.count(ord(" ")) < 2 else "sheet2"
            else:
                assert (shown["projector"][..., ::-1] == drawn[1]).all()
                name = "scan1"
            return True, frames[name]

    def wait(delay: int) -> int:
        pressed.append(next(keys))
        return pressed[-1]

    for name, stand_in in {
        "VideoCapture": Camera,
        "imshow": lambda window, picture: shown.update({window: picture}),
        "waitKey": wait,
        "namedWindow": lambda *_: None,
        "moveWindow": lambda *_: None,
        "setWindowProperty": lambda *_: None,
    }.items():
        monkeypatch.setattr(cv2, name, stand_in)
    out = tmp_path / "out"
    monkeypatch.setattr(sys, "argv", f"webcam.py --size 594x420mm --camera 3 --out {out}".split())
    spec = importlib.util.spec_from_file_location("webcam", EXAMPLES / "webcam.py")
    assert spec is not None and spec.loader is not None
    webcam = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(webcam)
    assert webcam.main() == 0
    assert "calibrated." in capsys.readouterr().out
    # The mean of equal frames is that frame: the same numbers as from the folder's files.
    views = [slcal.detect(slcal.read_image(photos / f"sheet{i}.png"), SIZE_MM, checker) for i in (1, 2)]
    rig = slcal.calibrate_observations(slcal.Observations((960, 720), (1024, 768), views))
    assert slcal.Rig.load(out / "rig.json") == slcal.Rig.from_json(rig.to_json())
    assert [p.name for p in out.glob("*.ply")] == ["scan1.ply"]


def test_webcam_reports_what_is_wrong(tmp_path: Path) -> None:
    nothing = run("webcam.py", "--size", "594x420", "--images", tmp_path, cwd=tmp_path, code=1)
    assert "No photograph calibrated the rig" in nothing
    assert "is no folder" in run(
        "webcam.py", "--size", "594x420", "--images", tmp_path / "x", cwd=tmp_path, code=1
    )

    facing = simulate.scene("sheet", size_mm=SIZE_MM, tilt=(1, 1), projector_focal=1450)
    Image.fromarray(facing.photo).save(tmp_path / "sheet1.png")
    refused = run("webcam.py", "--size", "594x420", "--images", tmp_path, cwd=tmp_path, code=1)
    assert "sheet1: " in refused and "face-on" in refused and "Tilt the sheet" in refused

    Image.fromarray(np.full((480, 640, 3), 12, np.uint8)).save(tmp_path / "sheet1.png")
    dark = run("webcam.py", "--size", "594x420", "--images", tmp_path, cwd=tmp_path, code=1)
    assert "sheet1: " in dark and "dark" in dark
    assert "does not open" in run("webcam.py", "--size", "594x420", "--camera", 97, cwd=tmp_path, code=1)


def test_tour(tmp_path: Path) -> None:
    said = run("tour.py", cwd=tmp_path)
    compared = [line for line in said.splitlines() if "truth" in line and "±" in line]
    assert len(compared) == 4
    for line in compared:
        found, sigma, true = (float(x) for x in line.replace("±", " ").replace("truth", " ").split()[-3:])
        assert abs(found - true) < 3 * sigma, line
    assert "verdict: good" in said
    (radius,) = (float(line.split()[1]) for line in said.splitlines() if line.startswith("radius"))
    assert radius == pytest.approx(120, abs=1)
    made = {p.name for p in tmp_path.iterdir()}
    assert {
        "tour_sheet.png",
        "tour_stripes.png",
        "tour_sigma.png",
        "tour_rig.png",
        "tour_ball.ply",
        "tour_rig.json",
    } <= made


def test_types() -> None:
    check_types(*(EXAMPLES / name for name in runnable()))
