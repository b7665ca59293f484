"""How flat a sheet is: what is given, and what is found."""

import json
import pickle

import numpy as np
import pytest
from common import DEMO

import slcal
from slcal import reports

SIZE = (594, 420)


@pytest.fixture(scope="module")
def seen():
    checker = slcal.CheckerPattern(projector=(1024, 768))
    return slcal.observe([slcal.read_image(DEMO / "sheet.jpg")], SIZE, checker)


@pytest.fixture(scope="module")
def rig(seen):
    return slcal.calibrate_observations(seen)


def test_a_bend_is_what_the_file_says(rig):
    said = json.loads(rig.to_json())
    bend = rig.views[0].bend
    assert isinstance(bend, reports.ViewBend)
    assert bend.to_dict() == said["views"][0]["bend"]
    assert len(bend.coefficients_mm) == len(bend.sigma_mm) == len(bend.expected_sigma_mm) == 12
    # The photograph tells more than was expected of it.
    assert all(0 < found < expected for found, expected in zip(bend.sigma_mm, bend.expected_sigma_mm, strict=True))
    assert rig.camera.sigma.aspect == said["camera"]["sigma"]["aspect"]
    assert 0 < rig.projector.sigma.aspect <= 0.002
    assert rig.quality.depth_sigma_percent == said["quality"]["depth_sigma_percent"]
    assert slcal.Rig.from_json(rig.to_json()).views[0].bend == bend
    assert pickle.loads(pickle.dumps(rig.camera)).sigma == rig.camera.sigma


def test_the_sag_follows_from_the_coefficients(rig):
    bend = rig.views[0].bend
    v, u = np.meshgrid(np.linspace(-1, 1, 33), np.linspace(-1, 1, 33), indexing="ij")
    orders = [(2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0), (0, 4), (3, 1), (1, 3), (2, 2)]
    z = np.zeros_like(u)
    for (i, j), coefficient in zip(orders, bend.coefficients_mm, strict=True):
        z += coefficient * np.polynomial.legendre.legval(u, [0] * i + [1]) * np.polynomial.legendre.legval(v, [0] * j + [1])
    assert np.ptp(z) == pytest.approx(bend.sag_mm, rel=1e-9)


def test_flatness_is_a_name_or_a_length(seen, rig):
    flat = slcal.calibrate_observations(seen, flatness="flat")
    assert flat.views[0].bend is None
    assert flat == slcal.calibrate_observations(seen, flatness=0)
    assert slcal.calibrate_observations(seen, flatness="paper") == rig
    half = slcal.calibrate_observations(seen, flatness="0.5mm")
    assert half == slcal.calibrate_observations(seen, flatness=0.5)
    assert half.views[0].bend.expected_sigma_mm[0] == pytest.approx(0.5)
    # The flatter the sheet, the better its sides tell how the lens bends lines.
    board = slcal.calibrate_observations(seen, flatness="board")
    sigmas = [r.camera.sigma.distortion[2] for r in (flat, board, rig)]
    assert sigmas == sorted(sigmas) and sigmas[0] < 0.5 * sigmas[2]


def test_flatness_of_photographs():
    photo = slcal.read_image(DEMO / "sheet.jpg")
    checker = slcal.CheckerPattern(projector=(1024, 768))
    assert slcal.calibrate([photo], SIZE, checker, flatness="flat").views[0].bend is None


@pytest.mark.parametrize("flatness", ["bent", -1.0, float("nan"), True, (1, 2), "1px"])
def test_what_is_no_flatness(seen, flatness):
    with pytest.raises(slcal.Error, match="flatness"):
        slcal.calibrate_observations(seen, flatness=flatness)


def test_plans_know_how_flat_the_sheet_will_be():
    camera = slcal.Camera.from_fov((1280, 960), 50)
    sigmas = []
    for flatness in ["paper", "board", "flat"]:
        advice = slcal.advise(camera, SIZE, flatness=flatness)
        assert advice.next is not None
        sigmas.append(advice.next.sigma_after.camera_focal_percent)
    assert sigmas == sorted(sigmas, reverse=True)
    assert sigmas[0] > sigmas[-1]
