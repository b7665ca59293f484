"""What is said where an argument is something else: its name, what was given, and the call that makes what is wanted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slcal
from slcal import simulate

PHOTO = np.full((480, 640, 3), 30, np.uint8)
CHECKER = slcal.CheckerPattern((1024, 768))
STRIPES = slcal.StripePattern((1024, 768))
CAMERA = slcal.Camera.from_fov((640, 480), 45)
PROJECTOR = slcal.Camera.from_throw((1024, 768), 1.6)
POSE = slcal.Pose(np.eye(3), [-200, 0, 0])
RIG = slcal.Rig(CAMERA, PROJECTOR, POSE)
SIZE = (594, 420)
OBSERVATIONS: dict[str, Any] = {"camera": [640, 480], "projector": None, "views": []}

#: A call with one argument left open, the argument's name, and the class that is wanted.
CALLS: dict[str, tuple[Callable[[Any], Any], str, str]] = {
    "calibrate, pattern": (lambda x: slcal.calibrate(PHOTO, SIZE, x), "pattern", "CheckerPattern"),
    "calibrate, camera": (lambda x: slcal.calibrate(PHOTO, SIZE, camera=x), "camera", "Camera"),
    "calibrate_observations": (slcal.calibrate_observations, "observations", "Observations"),
    "calibrate_observations, camera": (
        lambda x: slcal.calibrate_observations(simulate.views(poses=1)[0], camera=x),
        "camera",
        "Camera",
    ),
    "observe": (lambda x: slcal.observe(PHOTO, SIZE, x), "pattern", "CheckerPattern"),
    "detect": (lambda x: slcal.detect(PHOTO, SIZE, x), "pattern", "CheckerPattern"),
    "detect_corners": (lambda x: slcal.detect_corners(PHOTO, x), "pattern", "CheckerPattern"),
    "decode": (lambda x: slcal.decode(PHOTO, x), "pattern", "StripePattern"),
    "Rig, camera": (slcal.Rig, "camera", "Camera"),
    "Rig, projector": (lambda x: slcal.Rig(CAMERA, x, POSE), "projector", "Camera"),
    "Rig, pose": (lambda x: slcal.Rig(CAMERA, PROJECTOR, x), "projector_from_camera", "Pose"),
    "Rig.reconstruct": (lambda x: RIG.reconstruct(PHOTO, x), "pattern", "StripePattern"),
    "Rig.triangulate": (RIG.triangulate, "pixels", "Matches"),
    "Rig.verify": (lambda x: RIG.verify(PHOTO, x), "pattern", "CheckerPattern"),
    "Rig.advise": (RIG.advise, "pattern", "CheckerPattern"),
    "Rig.rectify": (RIG.rectify, "source", "CheckerPattern"),
    "Rig.rectification": (RIG.rectification, "source", "CheckerPattern"),
    "Rig.save_report": (lambda x: RIG.save_report("never.html", cloud=x), "cloud", "PointCloud"),
    "Rig.save_report, observations": (
        lambda x: RIG.save_report("never.html", observations=x),
        "observations",
        "Observations",
    ),
    "advise": (lambda x: slcal.advise(x, SIZE), "camera", "Camera"),
    "advise, projector": (lambda x: slcal.advise(CAMERA, SIZE, projector=x), "projector", "Camera"),
    "Reconstructor, rig": (lambda x: slcal.Reconstructor(x, STRIPES), "rig", "Rig"),
    "Reconstructor, pattern": (lambda x: slcal.Reconstructor(RIG, x), "pattern", "StripePattern"),
    "evaluate": (lambda x: slcal.evaluate(x, "plane"), "cloud", "PointCloud"),
    "Observations": (lambda x: slcal.Observations((640, 480), None, x), "views", "ViewObservation"),
    "Observations, item": (
        lambda x: slcal.Observations((640, 480), None, [x]),
        r"views\[0\]",
        "ViewObservation",
    ),
    "simulate.scene": (lambda x: simulate.scene("plane", rig=x), "rig", "Rig"),
}
#: Where arrays do as well.
ARRAYS_DO = {"Rig.triangulate", "evaluate", "Rig.rectify", "Rig.rectification"}
#: What makes one of a path.
OF_PATH = {
    "ViewObservation": r'slcal\.detect\(slcal\.read_image\("x\.json"\)',
    "Pose": r'slcal\.Rig\.load\("x\.json"\)\.projector_from_camera',
}


@pytest.mark.parametrize("path", ["x.json", Path("x.json")], ids=["str", "Path"])
@pytest.mark.parametrize("name", CALLS)
def test_a_path_where_an_object_is_wanted(name: str, path: str | Path) -> None:
    call, argument, wanted = CALLS[name]
    load = OF_PATH.get(wanted, rf'slcal\.{wanted}\.load\("x\.json"\)')
    with pytest.raises(TypeError, match=rf"^{argument}: expected .*{wanted}.*, found a path: {load}"):
        call(path)


@pytest.mark.parametrize("name", [n for n in CALLS if n not in ARRAYS_DO])
def test_an_array_where_an_object_is_wanted(name: str) -> None:
    call, argument, wanted = CALLS[name]
    makes = {
        "Observations": r"slcal\.observe\(",
        "ViewObservation": r"slcal\.detect\(",
        "Rig": r"slcal\.Rig\.from_opencv\(",
    }.get(wanted, rf"slcal\.{wanted}\(")
    # A list of arrays is a list, whose items are arrays.
    what = r"views\[0\]" if name == "Observations" else argument
    with pytest.raises(TypeError, match=rf"^{what}: expected .*{wanted}.*, found an array: {makes}"):
        call(np.eye(3))


@pytest.mark.parametrize("name", [n for n in CALLS if n not in {"Rig.triangulate", "evaluate"}])
def test_an_object_of_another_class(name: str) -> None:
    call, argument, wanted = CALLS[name]
    with pytest.raises(TypeError, match=rf"^{argument}: expected .*{wanted}.*, found a slice: slcal\."):
        call(slice(1))


def test_the_picture_of_a_pattern_leads_to_its_file() -> None:
    with pytest.raises(TypeError, match=r'JSON file beside it: slcal\.CheckerPattern\.load\("a/checker\.json"\)'):
        slcal.calibrate(PHOTO, SIZE, "a/checker.png")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r'slcal\.StripePattern\.load\("stripes\.json"\)'):
        slcal.decode(PHOTO, "stripes.PNG")  # type: ignore[arg-type]


def test_the_wrong_pattern_and_the_class_itself() -> None:
    with pytest.raises(TypeError, match=r"pattern: expected a CheckerPattern, found a StripePattern"):
        slcal.calibrate(PHOTO, SIZE, STRIPES)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"found the class CheckerPattern itself: slcal\.CheckerPattern\("):
        slcal.calibrate(PHOTO, SIZE, slcal.CheckerPattern)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="pattern: expected a StripePattern or a SequencePattern, found None"):
        slcal.decode(PHOTO, None)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda x: slcal.calibrate(x, SIZE), "photos"),
        (lambda x: slcal.calibrate([x], SIZE), r"photos\[0\]"),
        (lambda x: slcal.observe(PHOTO, SIZE, plain=[x]), r"plain\[0\]"),
        (lambda x: slcal.detect(x, SIZE), "photo"),
        (lambda x: slcal.detect_sheet(x), "photo"),
        (lambda x: slcal.decode(x, STRIPES), "image"),
        (lambda x: slcal.decode(PHOTO, STRIPES, black=x), "black"),
        (lambda x: RIG.reconstruct(x, STRIPES), "image"),
        (lambda x: RIG.verify(x, CHECKER), "photo"),
        (lambda x: slcal.Reconstructor(RIG, STRIPES).reconstruct(x), "image"),
    ],
)
def test_a_path_where_a_photograph_is_wanted(call: Callable[[Any], Any], argument: str) -> None:
    with pytest.raises(TypeError, match=rf"{argument}: .*slcal\.read_image"):
        call("sheet.jpg")


def test_a_scene_is_no_photograph() -> None:
    scene = simulate.scene("plane", camera=(64, 64), focal=75)
    with pytest.raises(TypeError, match=r"scene\.photo"):
        slcal.detect_sheet(scene)  # type: ignore[arg-type]


def test_plain_and_its_older_name() -> None:
    scene = simulate.scene("sheet", CHECKER)
    by_plain = slcal.calibrate(scene.photo, SIZE, CHECKER, plain=[scene.white])
    assert slcal.calibrate([scene.photo], SIZE, CHECKER, screen=[scene.white]) == by_plain
    assert slcal.calibrate(scene.photo, SIZE, CHECKER) != by_plain
    seen = slcal.observe(scene.photo, SIZE, CHECKER, plain=[scene.white])
    assert seen == slcal.observe(scene.photo, SIZE, CHECKER, screen=[scene.white])
    found = slcal.detect(scene.photo, SIZE, CHECKER, plain=scene.white)
    assert found == slcal.detect(scene.photo, SIZE, CHECKER, screen=scene.white)
    with pytest.raises(slcal.Error, match="screen: expected plain alone"):
        slcal.detect(scene.photo, SIZE, CHECKER, plain=scene.white, screen=scene.white)


@pytest.mark.parametrize("size", ["A2-landscape", "594x420mm", "59.4x42cm", " a2-LANDSCAPE ", (594, 420), np.array([594.0, 420])])
def test_a_sheet_has_its_size_as_numbers_or_as_text(size: Any) -> None:
    corners = [[100, 90], [1100, 110], [1050, 800], [80, 780]]
    assert slcal.ViewObservation(size, sheet_corners=corners).size_mm == (594, 420)
    assert slcal.advise(CAMERA, size).size_mm == (594, 420)
    assert simulate.views(poses=1, size_mm=size)[0].views[0].size_mm == (594, 420)


def test_a_paper_by_its_name_is_tried_both_ways_round() -> None:
    scene = simulate.scene("sheet", pattern=CHECKER, tilt=(25, 28))
    stated = slcal.calibrate(scene.photo, "A2-landscape", CHECKER)
    named = slcal.calibrate(scene.photo, size_mm="A2", pattern=CHECKER)
    assert named.views[0].size_mm == (594, 420)
    assert (named.camera.K == stated.camera.K).all()
    assert [w.code for w in named.quality.warnings if w not in stated.quality.warnings] == ["sides-swapped"]
    assert slcal.observe(scene.photo, "A2", CHECKER) == slcal.observe(scene.photo, "A2-landscape", CHECKER)
    assert slcal.detect(scene.photo, "A2", CHECKER) == slcal.detect(scene.photo, "A2-landscape", CHECKER)
    moved = [stated.verify(scene.photo, CHECKER, size_mm=size, as_drawn=True).rig.moved for size in ("A2", "A2-landscape")]
    assert moved == [False, False]
    assert slcal.ViewObservation("A4", sheet_corners=[[1, 1], [9, 1], [9, 9], [1, 9]]).size_mm == (210, 297)


def test_what_is_no_size() -> None:
    for size, said in (
        ("594x420", "594x420mm"),
        ("8.5x11", "8.5x11in"),
        ((0.594, 0.42), "594x420mm if those are metres"),
        ("A9", "A0 to A6"),
        ((594, 420, 1), "in millimetres"),
        (None, "found None"),
    ):
        with pytest.raises(slcal.Error, match=rf"size_mm: expected .*{said}"):
            slcal.advise(CAMERA, size)  # type: ignore[arg-type]
