import pickle

import pytest

import slcal
from slcal import reports


def test_every_error_is_a_value_error_with_its_numbers():
    for kind in (slcal.CalibrationError, slcal.DetectionError, slcal.DecodeError, slcal.FormatError):
        assert issubclass(kind, slcal.Error)
        assert issubclass(kind, ValueError)
    error = slcal.CalibrationError("the message", what="focal length", measure=0.3, limit=0.25)
    assert str(error) == "the message"
    assert (error.what, error.measure, error.limit, error.seen) == ("focal length", 0.3, 0.25, None)
    with pytest.raises(TypeError):
        slcal.Error("x", nonsense=1)


def test_errors_travel_between_processes():
    error = slcal.DecodeError("no stripes", what="stripes", seen="nothing", advice="project them")
    error.photo = "a.png"
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is slcal.DecodeError
    assert str(again) == "no stripes"
    assert again.__dict__ == error.__dict__


def test_files_that_are_not_pictures(tmp_path):
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n nonsense")
    (tmp_path / "b.txt").write_text("hello")
    for name in ("a.png", "b.txt"):
        with pytest.raises(slcal.FormatError, match=name):
            slcal.read_image(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        slcal.read_image(tmp_path / "c.png")


def test_records_are_read_from_what_the_extension_says():
    said = {
        "verdict": "good",
        "focal_sigma_percent": {"camera": 1.5, "projector": None},
        "depth_sigma_percent": None,
        "expected_point_sigma_mm": None,
        "cause": "seen flat",
        "advice": "tilt it",
        "warnings": [{"code": "a", "message": "b", "advice": "c"}],
        "assumptions": [],
        "beyond": 1,
    }
    quality = reports.Quality._of(said)
    assert quality.warnings == (reports.Warning("a", "b", "c"),)
    assert quality.focal_sigma_percent.projector is None
    del said["beyond"]
    assert quality.to_dict() == said
    assert pickle.loads(pickle.dumps(quality)) == quality
    with pytest.raises(AttributeError):
        quality.verdict = "weak"
