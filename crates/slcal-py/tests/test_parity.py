"""Everything that the command does gives the same numbers through Python, bit for bit."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from common import DEMO, RENDERED, command, command_json, scenes

import slcal
from slcal import reports

SIZE = (594, 420)


def plain(record: Any, *without: str) -> Any:
    """What the command prints of one thing, less what only a command knows."""
    return {k: v for k, v in record.items() if k not in {"schema", *without}}


@pytest.fixture(params=[DEMO, *scenes()], ids=lambda p: p.name)
def scene(request: pytest.FixtureRequest) -> Path:
    path: Path = request.param
    return path


def test_the_rendered_scenes_are_at_hand() -> None:
    if not scenes():
        pytest.skip(f"{RENDERED} is not there: parity is tested on the photographs of the repository alone")


def sheet(scene: Path) -> tuple[Path, Path | None]:
    """The photograph of the sheet, and the one without pattern."""
    if scene == DEMO:
        return DEMO / "sheet.jpg", None
    return scene / "checker.png", scene / "screen.png"


def stripes(scene: Path) -> list[Path]:
    if scene == DEMO:
        return [DEMO / "head.jpg", DEMO / "board.jpg"]
    photos = scene.glob("stripes_*.png")
    return sorted(p for p in photos if not p.stem.endswith(("_black", "_white")))


def pattern(scene: Path, kind: str, folder: Path) -> Path:
    """The pattern's file: that of the scene, or the usual one."""
    if scene != DEMO:
        return scene / "patterns" / f"{kind}.json"
    command("pattern", kind, "--projector", "1024x768", "-o", folder / f"{kind}.png")
    return folder / f"{kind}.json"


def read(photo: Path) -> Any:
    return slcal.read_image(photo)


def test_drawing(tmp_path: Path) -> None:
    for kind, drawn in [
        ("checker", slcal.CheckerPattern((1280, 800))),
        ("stripes", slcal.StripePattern((1280, 800))),
    ]:
        command("pattern", kind, "--projector", "1280x800", "-o", tmp_path / f"{kind}.png")
        assert slcal.load_pattern(tmp_path / f"{kind}.json") == drawn
        assert (tmp_path / f"{kind}.json").read_text() == drawn.to_json()
        assert (slcal.read_image(tmp_path / f"{kind}.png") == drawn.image()).all()


@pytest.mark.parametrize("with_screen", [False, True])
def test_calibration(scene: Path, with_screen: bool, tmp_path: Path) -> None:
    photo, screen = sheet(scene)
    if with_screen and screen is None:
        pytest.skip("no photograph of the sheet without pattern")
    checker = pattern(scene, "checker", tmp_path)
    more = ["--screen", screen] if with_screen and screen else []
    said = command_json(
        "calibrate", photo, "--size", "594x420mm", "--pattern", checker, "--allow-degenerate", *more
    )
    rig = slcal.calibrate(
        [read(photo)],
        size_mm=SIZE,
        pattern=slcal.CheckerPattern.load(checker),
        screen=[read(screen)] if with_screen and screen else None,
        allow_degenerate=True,
        names=[str(photo)],
    )
    assert json.loads(rig.to_json()) == said
    assert rig.quality is not None
    assert rig.quality.to_dict() == said["quality"]
    again = pickle.loads(pickle.dumps(rig))
    assert again == rig
    assert again.report == rig.report is not None
    assert rig.covariance is not None
    assert rig.covariance.matrix.tolist() == said["covariance"]["matrix"]


def test_calibration_from_observations_and_of_the_camera_alone(scene: Path, tmp_path: Path) -> None:
    photo, _ = sheet(scene)
    checker = pattern(scene, "checker", tmp_path)
    options: list[str | Path] = ["--size", "594x420mm", "--allow-degenerate"]
    seen_file = tmp_path / "seen.json"
    command("calibrate", photo, *options, "--pattern", checker, "--save-observations", seen_file, "-o", tmp_path / "rig.json")
    seen = slcal.observe([read(photo)], SIZE, slcal.CheckerPattern.load(checker), names=[str(photo)])
    assert seen == slcal.Observations.load(seen_file)
    again = slcal.calibrate_observations(seen, allow_degenerate=True, camera_pp="centre")
    said = command_json("calibrate", "--observations", seen_file, "--camera-pp", "centre", "--allow-degenerate")
    assert json.loads(again.to_json()) == said
    known = slcal.Camera.load(tmp_path / "rig.json")
    said = command_json(
        "calibrate", "--observations", seen_file, "--camera", tmp_path / "rig.json", "--allow-degenerate"
    )
    again = slcal.calibrate_observations(seen, camera=known, allow_degenerate=True)
    assert json.loads(again.to_json()) == said


def test_reconstruction(scene: Path, tmp_path: Path) -> None:
    file = pattern(scene, "stripes", tmp_path)
    drawn = slcal.StripePattern.load(file)
    rig = slcal.Rig.load(scene / "truth_rig.json")
    for photo in stripes(scene):
        to = tmp_path / f"{photo.stem}.ply"
        said = command_json(
            "reconstruct", "--rig", scene / "truth_rig.json", "--pattern", file, photo, "--mesh", "-o", to
        )
        cloud = rig.reconstruct(read(photo), drawn, mesh=True)
        assert cloud.to_bytes("ply") == to.read_bytes()
        assert cloud.report is not None
        assert cloud.report.to_dict() == {**plain(said["clouds"][0], "image", "output"), "sequence": None}
        shape = "sphere" if "sphere" in photo.stem else "plane"
        if not {"head", "blob"} & set(photo.stem.split("_")):
            fit = slcal.evaluate(slcal.PointCloud.load(to), shape).to_dict()
            said = plain(command_json("evaluate", shape, to))
            assert fit.pop("report") == {k: said.pop(k) for k in fit_fields()}
            assert fit == said[shape]


def fit_fields() -> list[str]:
    return [f for f in reports.FitReport.__dataclass_fields__]


def test_reconstruction_with_black_and_white(scene: Path, tmp_path: Path) -> None:
    file = pattern(scene, "stripes", tmp_path)
    rig = slcal.Rig.load(scene / "truth_rig.json")
    for photo in stripes(scene):
        black, white = (photo.with_stem(f"{photo.stem}_{which}") for which in ("black", "white"))
        if not black.exists():
            continue
        to = tmp_path / f"{photo.stem}.xyz"
        command(
            "reconstruct", "--rig", scene / "truth_rig.json", "--pattern", file, photo, "--black", black,
            "--white", white, "--cull", "off", "-o", to,
        )  # fmt: skip
        cloud = rig.reconstruct(
            read(photo), slcal.StripePattern.load(file), black=read(black), white=read(white), cull="off"
        )
        assert cloud.to_bytes("xyz") == to.read_bytes()


def test_decoding_and_triangulation(scene: Path, tmp_path: Path) -> None:
    file = pattern(scene, "stripes", tmp_path)
    rig = slcal.Rig.load(scene / "truth_rig.json")
    for photo in stripes(scene)[:2]:
        table, to = tmp_path / f"{photo.stem}.csv", tmp_path / f"{photo.stem}.ply"
        said = command_json("decode", "--pattern", file, photo, "-o", table)
        matches = slcal.decode(read(photo), slcal.StripePattern.load(file))
        assert matches.report is not None
        assert matches.report.to_dict() == plain(said)
        matches.save(tmp_path / "again.csv")
        assert (tmp_path / "again.csv").read_bytes() == table.read_bytes()
        for cull in ("off", "auto", "2.5"):
            command("triangulate", "--rig", scene / "truth_rig.json", table, "--cull", cull, "--force", "-o", to)
            cloud = rig.triangulate(slcal.Matches.load(table), cull=float(cull) if cull[0] == "2" else cull)
            assert cloud.to_bytes("ply") == to.read_bytes()
        # Without rounding on the way.
        direct = rig.triangulate(matches, cull="auto")
        assert np.allclose(direct.points, rig.reconstruct(read(photo), slcal.StripePattern.load(file)).points)


def test_rectification_verification_and_advice(scene: Path, tmp_path: Path) -> None:
    photo, _ = sheet(scene)
    file = pattern(scene, "checker", tmp_path)
    drawn = slcal.CheckerPattern.load(file)
    command(
        "calibrate", photo, "--size", "594x420mm", "--pattern", file, "--allow-degenerate", "-o", tmp_path / "rig.json"
    )
    rig = slcal.Rig.load(tmp_path / "rig.json")
    said = command_json("verify", "--rig", tmp_path / "rig.json", "--pattern", file, photo, "--as-drawn")
    assert rig.verify(read(photo), drawn, as_drawn=True).to_dict() == with_nothing(plain(said, "photo"))
    command("rectify", "--rig", tmp_path / "rig.json", "--pattern", file, "-o", tmp_path / "upright.png")
    assert (rig.rectify(drawn) == slcal.read_image(tmp_path / "upright.png")).all()
    said = command_json("advise", "--rig", tmp_path / "rig.json", "--pattern", file)
    assert rig.advise(drawn).to_dict() == plain(said)


def with_nothing(said: Any) -> Any:
    """The figures of a change that do not belong to it are None in the record and absent in the command's object."""
    change = said["rig"]["change"]
    if change is not None:
        said["rig"]["change"] = {"turn_deg": None, "shift_mm": None, "focal_percent": None, **change}
    return said


def test_advice_before_the_first_photograph() -> None:
    said = command_json(
        "advise", "--image", "1280x960", "--fov", "50", "--size", "594x420mm", "--projector", "1024x768", "--throw", "1.5"
    )
    camera = slcal.Camera.from_fov((1280, 960), 50)
    projector = slcal.Camera.from_throw((1024, 768), 1.5)
    assert slcal.advise(camera, SIZE, projector=projector).to_dict() == plain(said)


def test_simulation(tmp_path: Path) -> None:
    from slcal import simulate

    said = command_json("simulate", "scene", "--surface", "sphere", "--camera", "640x480", "--out", tmp_path / "s")
    made = simulate.scene("sphere", camera=(640, 480))
    assert made.report.to_dict() == plain(said, "files")
    assert (made.photo == slcal.read_image(tmp_path / "s/photo.png")).all()
    assert made.rig == slcal.Rig.load(tmp_path / "s/rig.json")
    said = command_json("simulate", "noise", "--draws", "3", "--levels", "0.2,0.5")
    assert simulate.noise([0.2, 0.5], draws=3).to_dict() == plain(said)
    command("simulate", "views", "--poses", "3", "-o", tmp_path / "views.json", "--truth", tmp_path / "truth.json")
    views, truth = simulate.views(poses=3)
    assert views == slcal.Observations.load(tmp_path / "views.json")
    assert truth == slcal.Rig.load(tmp_path / "truth.json")
