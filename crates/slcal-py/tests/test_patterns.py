import json
import pickle
import subprocess
import sys

import numpy as np
import pytest

import slcal


def test_version_is_that_of_the_command():
    script = "from slcal._command import main; main()"
    said = subprocess.run([sys.executable, "-c", script, "--version"], capture_output=True, text=True, timeout=300)
    assert said.returncode == 0
    assert said.stdout == f"slcal {slcal.__version__}\n"


def test_the_exit_code_of_the_command_is_passed_on():
    script = "from slcal._command import main; main()"
    said = subprocess.run([sys.executable, "-c", script, "evaluate", "plane", "absent.ply"], capture_output=True, text=True, timeout=300)
    assert said.returncode == 3
    assert "absent.ply" in said.stderr


def test_checkerboard_lies_where_it_says():
    checker = slcal.CheckerPattern(projector=(1024, 768))
    picture = checker.image()
    assert picture.shape == (768, 1024, 3)
    assert picture.dtype == np.uint8
    assert checker.squares == (11, 8)
    x, y = (round(c + 0.5) for c in checker.origin_px)
    side = int(checker.square_px)
    board = picture[y : y + 8 * side, x : x + 11 * side, 0].reshape(8, side, 11, side)
    columns, rows = np.meshgrid(np.arange(11), np.arange(8))
    white = (columns + rows) % 2 == 1
    assert (board == np.where(white, 255, 0)[:, None, :, None]).all()
    outside = picture.astype(int).sum() - board.astype(int).sum() * 3
    assert outside == 255 * 3 * (768 * 1024 - board.size)


def test_stripes_are_drawn_at_their_centres():
    stripes = slcal.StripePattern(projector=(1024, 768))
    picture = stripes.image()
    assert picture.shape == (768, 1024, 3)
    assert len(stripes.sequence) == len(stripes.centres_px) == 64
    columns = np.round(stripes.centres_px).astype(int)
    assert (picture[100, columns] == stripes.palette[stripes.sequence]).all()
    windows = [tuple(stripes.sequence[i : i + 3]) for i in range(62)]
    assert len(set(windows)) == 62


def test_json_names_its_schema():
    for pattern, kind in [
        (slcal.CheckerPattern((800, 600), squares=(8, 5)), "checker"),
        (slcal.StripePattern((800, 600), hues=3, order=3), "stripes"),
    ]:
        written = json.loads(pattern.to_json())
        assert written["schema"] == "slcal-pattern/1"
        assert written["kind"] == kind
        assert written["projector"] == [800, 600]


def test_invalid_patterns_are_value_errors():
    with pytest.raises(ValueError, match="odd"):
        slcal.CheckerPattern((1024, 768), squares=(10, 8))
    with pytest.raises(ValueError):
        slcal.CheckerPattern((0, 768))
    with pytest.raises(ValueError):
        slcal.StripePattern((1024, 768), slits=1000)
    with pytest.raises((ValueError, OverflowError)):
        slcal.StripePattern((1024, 768), hues=-1)


def test_patterns_are_values():
    assert slcal.CheckerPattern((800, 600)) == slcal.CheckerPattern((800, 600))
    assert slcal.CheckerPattern((800, 600)) != slcal.CheckerPattern((1024, 768))
    assert "800, 600" in repr(slcal.StripePattern((800, 600)))


def test_marks_stand_at_the_corners_and_in_the_middles_of_the_sides(tmp_path):
    plain, marked = slcal.CheckerPattern((1024, 768)), slcal.CheckerPattern((1024, 768), marks=True)
    assert plain.marks is None
    assert marked.marks.shape == (11, 2)
    assert "marks=True" in repr(marked) and plain != marked
    picture = marked.image()
    for x, y in [(0, 0), (1023, 0), (1023, 767), (0, 767), (511, 0), (511, 767), (0, 383), (1023, 383)]:
        assert (picture[y, x] == 0).all()
    # White in the middle of each, and beside the marks the same board.
    assert all((picture[round(y), round(x)] == 255).all() for x, y in marked.marks)
    assert (picture[100:668, 100:924] == plain.image()[100:668, 100:924]).all()
    marked.save(tmp_path / "marked.json")
    assert slcal.CheckerPattern.load(tmp_path / "marked.json") == marked
    with pytest.raises(slcal.Error, match="marks"):
        slcal.CheckerPattern((1024, 768), squares=(101, 74), square_px=10, marks=True)


def test_the_border_of_the_light_is_an_observation_that_is_kept():
    checker = slcal.CheckerPattern((1024, 768))
    scene = slcal.simulate.scene(surface="sheet", projector_focal=2300, pattern=checker)
    seen = slcal.observe([scene.photo], (594, 420), checker)
    points = seen.views[0].panel_points
    assert len(points) > 40 and np.isnan(points[:, 2:4]).any(axis=1).all()
    assert set(points[:, 2:4][~np.isnan(points[:, 2:4])]) <= {-0.5, 767.5, 1023.5}
    assert pickle.loads(pickle.dumps(seen)).views[0].panel_points.shape == points.shape
    codes = [w.code for w in slcal.calibrate_observations(seen).quality.warnings]
    assert "shown-1:1" not in codes


def test_a_sequence_is_gray_code_and_shifted_sinusoids():
    sequence = slcal.SequencePattern((640, 480), "phase", period=20, steps=5)
    assert len(sequence) == len(sequence.frames) == 2 + 2 * 7 + 5
    assert sequence.projector == (640, 480)
    # The word of a cell is the Gray code of its number: the most significant bit first, each followed by its inverse.
    word = np.zeros(640, int)
    for i, frame in enumerate(sequence.frames):
        picture = sequence.image(i)
        assert picture.shape == (480, 640)
        assert picture.dtype == np.uint8
        assert (picture == picture[0]).all()
        if frame["is"] == "bit":
            assert frame["axis"] == "columns"
            assert frame["bit"] == 6 - (i - 2) // 2
            assert frame["inverted"] == bool(i % 2)
            word |= ((picture[0] > 127) ^ frame["inverted"]).astype(int) << frame["bit"]
        elif frame["is"] == "sinusoid":
            phase = 2 * np.pi * (np.arange(640) / 20 - frame["step"] / frame["of"])
            assert np.abs(picture[0] - 127.5 * (1 + np.cos(phase))).max() <= 0.5
        else:
            assert (picture == {"white": 255, "black": 0}[frame["is"]]).all()
    cell = np.arange(640) // 8
    assert (word == cell ^ (cell >> 1)).all()
    rows = slcal.SequencePattern((640, 480), axis="rows", bits=1)
    assert (rows.image(2) == np.where(np.arange(480) < 256, 0, 255)[:, None]).all()


def test_sequences_of_other_programs_and_of_ones_own():
    opencv = slcal.SequencePattern((1024, 768), preset="opencv-gray")
    assert [f["is"] for f in opencv.frames[-2:]] == ["white", "black"]
    assert len(opencv) == 42
    assert len(slcal.SequencePattern((1824, 1140), preset="slstudio-gray", bits=10)) == 12
    text = json.dumps(
        {
            "schema": "slcal-pattern/1",
            "kind": "sequence",
            "projector": [4, 3],
            "frames": [{"is": "bit", "bit": b, "inverted": i} for b in (0, 1) for i in (True, False)],
        }
    )
    own = slcal.SequencePattern.from_json(text)
    assert own.image(0)[0].tolist() == [255, 0, 0, 255]
    assert "file" not in own.frames[0]


def test_sequences_are_values_and_files(tmp_path):
    sequence = slcal.SequencePattern((800, 600), "phase", "both")
    assert sequence == slcal.SequencePattern((800, 600), kind="phase", axis="both", period=16, steps=8)
    assert hash(sequence) == hash(pickle.loads(pickle.dumps(sequence)))
    assert sequence != slcal.SequencePattern((800, 600), "phase")
    assert repr(sequence) == f"SequencePattern(projector=(800, 600), frames={len(sequence)})"
    sequence.save(tmp_path / "sequence.json")
    assert slcal.SequencePattern.load(tmp_path / "sequence.json") == sequence
    assert slcal.load_pattern(tmp_path / "sequence.json") == sequence
    with pytest.raises(slcal.Error, match="SequencePattern.load"):
        slcal.StripePattern.load(tmp_path / "sequence.json")
    with pytest.raises(slcal.Error, match="CheckerPattern.load"):
        slcal.SequencePattern.from_json(slcal.CheckerPattern((800, 600)).to_json())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"kind": "dots"}, "gray, phase"),
        ({"axis": "diagonal"}, "columns"),
        ({"period": 20}, "phase"),
        ({"steps": 5}, "phase"),
        ({"kind": "phase", "preset": "opencv-gray"}, "gray"),
        ({"axis": "rows", "preset": "opencv-gray"}, "preset"),
        ({"preset": "other"}, "opencv-gray"),
        ({"bits": 0}, "bits"),
        ({"bits": -1}, "bits"),
        ({"bits": 11}, "1 to 10"),
        ({"kind": "phase", "period": 2}, "period"),
        ({"kind": "phase", "period": float("nan")}, "period"),
        ({"kind": "phase", "steps": 2}, "3 to 64"),
    ],
)
def test_what_is_no_sequence(options, words):
    with pytest.raises(slcal.Error, match=words):
        slcal.SequencePattern((640, 480), **options)


def test_pictures_that_a_sequence_does_not_have():
    sequence = slcal.SequencePattern((640, 480), bits=1)
    for frame in (4, -1):
        with pytest.raises(slcal.Error, match="frame"):
            sequence.image(frame)
