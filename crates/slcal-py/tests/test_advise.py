import json
import pickle

import pytest
from common import DEMO

import slcal
from slcal import reports

SIZE = (594, 420)


@pytest.fixture(scope="module")
def camera():
    return slcal.Camera.from_fov((1280, 960), 50)


@pytest.fixture(scope="module")
def first(camera):
    return slcal.advise(camera, SIZE)


def at(advice, horizontal, vertical):
    (found,) = (
        t
        for t in advice.table
        if t.tilt_about_horizontal_deg == pytest.approx(horizontal)
        and t.tilt_about_vertical_deg == pytest.approx(vertical)
    )
    return found


def test_advice_before_the_first_photograph(first):
    assert isinstance(first, reports.Advice)
    assert first.size_mm == SIZE
    assert first.sigma_now is None
    assert len(first.table) == 81
    assert first.noise_px == reports.Noise(0.05, 0.05)
    assert first.worth_it
    assert first.next is not None
    assert first.next.then_reversed
    assert first.next.in_words.startswith("hold the sheet with")
    # A sheet seen face-on says next to nothing of the focal length, a tilted one much; two say more than one.
    assert at(first, 0, 0).one.camera_focal_percent > 10 * at(first, 20, 20).one.camera_focal_percent
    for tilt in first.table:
        if tilt.pair is not None and tilt.one.camera_focal_percent < 100:
            assert tilt.pair.camera_focal_percent < tilt.one.camera_focal_percent
    # Nobody can tell a camera's left from its right here.
    for a, b in [(20, 20), (30, 10), (0, 40)]:
        assert at(first, a, b).one.camera_focal_percent == pytest.approx(at(first, a, -b).one.camera_focal_percent, rel=1e-6)
    # The sheet fills 60 % of the frame unless a distance is given.
    focal = 640 / 0.46630765815
    assert first.distance_mm == pytest.approx(max(focal * 594 / (0.6 * 1280), focal * 420 / (0.6 * 960)))
    assert first.next.sigma_after.projector_focal_percent is None


def test_noise_and_what_is_known_count(camera, first):
    tilt = at(first, 20, 20)
    exact = at(slcal.advise(camera, SIZE, camera_pp="centre"), 20, 20)
    assert exact.one.camera_focal_percent < tilt.one.camera_focal_percent
    # With an ideal lens and a flat sheet nothing but noise is left, and σ is proportional to it.
    ideal = {"camera_pp": "centre", "distortion": "none", "flatness": "flat"}
    once, twice = (at(slcal.advise(camera, SIZE, noise_px=n, **ideal), 20, 20) for n in (0.05, 0.1))
    assert twice.one.camera_focal_percent == pytest.approx(2 * once.one.camera_focal_percent, rel=1e-3)
    none, lens = (at(slcal.advise(camera, SIZE, distortion=model), 20, 20) for model in ("none", "k1k2"))
    assert lens.one.camera_focal_percent >= none.one.camera_focal_percent
    far = slcal.advise(camera, SIZE, distance_mm=3000)
    assert far.distance_mm == 3000
    assert at(far, 20, 20).one.camera_focal_percent > tilt.one.camera_focal_percent


def test_with_a_projector(camera):
    projector = slcal.Camera.from_throw((1024, 768), 1.5)
    advice = slcal.advise(camera, SIZE, projector=projector)
    after = advice.next.sigma_after
    assert after.projector_focal_percent > 0
    assert after.projector_cy_px > 0
    assert after.point_mm > 0
    free = slcal.advise(camera, SIZE, projector=projector, projector_pp="centre")
    assert free.next.sigma_after.projector_focal_percent <= after.projector_focal_percent


def test_advice_on_the_next_photograph():
    checker = slcal.CheckerPattern((1024, 768))
    rig = slcal.calibrate([slcal.read_image(DEMO / "sheet.jpg")], SIZE, checker)
    advice = rig.advise()
    assert advice.sigma_now is not None
    assert advice.sigma_now.camera_focal_percent == pytest.approx(rig.quality.focal_sigma_percent.camera, rel=0.02)
    assert advice.next is not None
    assert not advice.next.then_reversed
    assert advice.worth_it
    assert advice.next.sigma_after.camera_focal_percent < advice.sigma_now.camera_focal_percent
    assert rig.advise(checker) == rig.advise(pattern=checker)
    assert slcal.Rig.from_json(rig.to_json()).advise() == advice
    with pytest.raises(slcal.Error, match="1024x768.*800x600"):
        rig.advise(slcal.CheckerPattern((800, 600)))
    with pytest.raises(slcal.Error, match="views"):
        slcal.Rig(rig.camera).advise()
    truth = slcal.Rig.load(DEMO / "truth_rig.json")
    with pytest.raises(slcal.Error, match="covariance") as caught:
        truth.advise()
    assert "--" not in str(caught.value)


def test_records_are_values(first, camera):
    assert pickle.loads(pickle.dumps(first)) == first == slcal.advise(camera, list(SIZE))
    assert json.loads(json.dumps(first.to_dict())) == first.to_dict()


def test_what_cannot_be_planned(camera):
    for wrong in [{"distance_mm": 0}, {"distance_mm": float("nan")}, {"noise_px": -1}, {"noise_px": float("inf")}]:
        with pytest.raises(slcal.Error, match="positive"):
            slcal.advise(camera, SIZE, **wrong)
    with pytest.raises(slcal.Error, match="camera_pp.*prior"):
        slcal.advise(camera, SIZE, camera_pp="middle")
    with pytest.raises(slcal.Error, match="distortion.*auto"):
        slcal.advise(camera, SIZE, distortion="k3")
    with pytest.raises(slcal.Error, match="size_mm"):
        slcal.advise(camera, (594, 0))
    with pytest.raises(TypeError, match="Camera"):
        slcal.advise("camera.yaml", SIZE)
