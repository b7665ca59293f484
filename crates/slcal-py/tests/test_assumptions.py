"""What a calibration takes for given: records, options, and what another value gives."""

import json

import pytest
from common import DEMO

import slcal
from slcal import reports

SIZE = (594, 420)
CHECKER = slcal.CheckerPattern(projector=(1024, 768))


@pytest.fixture(scope="module")
def seen():
    return slcal.observe([slcal.read_image(DEMO / "sheet.jpg")], SIZE, CHECKER)


@pytest.fixture(scope="module")
def rig(seen):
    return slcal.calibrate_observations(seen)


def test_assumptions_are_what_the_file_says(rig):
    said = json.loads(rig.to_json())["quality"]["assumptions"]
    assumptions = rig.quality.assumptions
    assert [a.to_dict() for a in assumptions] == said
    assert len({a.code for a in assumptions}) == len(assumptions) == 9
    assert all(isinstance(a, reports.Assumption) and isinstance(a.moves_percent, reports.Moves) for a in assumptions)
    assert slcal.Rig.from_json(rig.to_json()).quality == rig.quality


def test_a_cost_is_what_the_other_value_gives(seen, rig):
    cost = next(a for a in rig.quality.assumptions if a.code == "square-pixels-projector")
    assert (cost.status, cost.value, cost.if_off_by) == ("assumed", 1.0, 0.01)

    def moved(ratio):
        other = slcal.calibrate_observations(seen, projector_pixel_aspect=ratio)
        assert other.projector.K[1, 1] / other.projector.K[0, 0] == pytest.approx(ratio, rel=1e-12)
        return abs(other.baseline_mm / rig.baseline_mm - 1) * 100

    assert max(moved(1.01), moved(0.99)) == pytest.approx(abs(cost.moves_percent.baseline), rel=0.1)


def test_square_pixels_are_held(seen):
    square = slcal.calibrate_observations(seen, projector_pixel_aspect="square")
    assert square.projector.K[0, 0] == square.projector.K[1, 1]
    assert square.projector.sigma.aspect == 0


@pytest.mark.parametrize("aspect", ["wide", -1.0, 0, float("nan"), True, (1, 2)])
def test_what_is_no_pixel_aspect(seen, aspect):
    with pytest.raises(slcal.Error, match="pixel.aspect"):
        slcal.calibrate_observations(seen, projector_pixel_aspect=aspect)
