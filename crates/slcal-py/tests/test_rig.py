import copy
import io
import json
import pickle

import numpy as np
import pytest
from common import DEMO

import slcal


@pytest.fixture
def rig():
    return slcal.Rig.load(DEMO / "truth_rig.json")


def test_a_rig_holds_what_its_file_says(rig):
    said = json.loads((DEMO / "truth_rig.json").read_text())
    assert rig.camera.K.tolist() == said["camera"]["K"]
    assert rig.camera.distortion.tolist() == said["camera"]["distortion"]
    assert rig.projector.K.tolist() == said["projector"]["K"]
    assert rig.projector.size == (1024, 768)
    pose = rig.projector_from_camera
    assert pose.R == pytest.approx(np.array(said["projector_from_camera"]["R"]), abs=1e-15)
    assert pose.t.tolist() == said["projector_from_camera"]["t"]
    assert rig.baseline_mm == pytest.approx(np.linalg.norm(pose.t))
    assert rig.method == said["method"]
    (view,) = rig.views
    assert view.corners_px.tolist() == said["views"][0]["corners_px"]
    assert view.size_mm == (594, 420)
    # The sheet's corners are seen where its pose puts them.
    width, height = view.size_mm
    sheet = [[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]]
    assert rig.camera.project(view.camera_from_sheet.transform(sheet)) == pytest.approx(view.corners_px, abs=1e-6)
    chained = rig.projector_from_camera @ view.camera_from_sheet
    assert chained.matrix == pytest.approx(view.projector_from_sheet.matrix, abs=1e-9)
    # A vanishing point is where a direction of the sheet meets infinity.
    direction = view.camera_from_sheet.R[:, 0]
    seen = rig.camera.K @ direction
    assert np.cross(seen / np.linalg.norm(seen), view.camera_vanishing_points[0]) == pytest.approx(0, abs=1e-9)


def test_files_of_every_kind(rig, tmp_path):
    path = tmp_path / "rig.json"
    rig.save(path)
    assert slcal.Rig.load(path) == rig
    assert slcal.Rig.load(str(path)) == rig
    with path.open("rb") as binary, path.open() as text:
        assert slcal.Rig.load(binary) == rig == slcal.Rig.load(text)
    binary, text = io.BytesIO(), io.StringIO()
    rig.save(binary)
    rig.save(text)
    assert binary.getvalue().decode() == text.getvalue() == rig.to_json() == path.read_text()
    rig.save(path)  # An existing file is replaced.
    assert [p.name for p in tmp_path.iterdir()] == ["rig.json"]


def test_invalid_files(rig, tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        slcal.Rig.load(tmp_path / "none.json")
    assert caught.value.filename == str(tmp_path / "none.json")
    with pytest.raises(FileNotFoundError):
        rig.save(tmp_path / "none" / "rig.json")
    with pytest.raises(IsADirectoryError):
        slcal.Rig.load(tmp_path)
    with pytest.raises(OSError):
        rig.save(tmp_path)
    closed = (tmp_path / "closed.json").open("w")
    closed.close()
    with pytest.raises(ValueError, match="closed"):
        rig.save(closed)
    with pytest.raises(ValueError, match="closed"):
        slcal.Rig.load(closed)
    for wrong in (None, 3, b"rig", np.zeros(3)):
        with pytest.raises(TypeError, match="file"):
            slcal.Rig.load(wrong)
        with pytest.raises(TypeError, match="file"):
            rig.save(wrong)
    with (tmp_path / "r").open("w") as only_written, pytest.raises(OSError):
        slcal.Rig.load(only_written)
    (tmp_path / "half.json").write_text(rig.to_json()[:500])
    with pytest.raises(slcal.FormatError, match=r"half\.json"):
        slcal.Rig.load(tmp_path / "half.json")
    with pytest.raises(slcal.FormatError, match="schema") as malformed:
        slcal.Rig.from_json("{}")
    assert malformed.value.detail
    said = json.loads(rig.to_json())
    said["camera"]["K"][0][0] = -1
    with pytest.raises(slcal.FormatError):
        slcal.Rig.from_json(json.dumps(said))


def test_rigs_are_values(rig):
    for again in (pickle.loads(pickle.dumps(rig)), copy.copy(rig), slcal.Rig.from_json(rig.to_json())):
        assert again == rig
        assert again.views == rig.views
    assert rig != slcal.Rig(rig.camera)
    assert rig != "rig"
    with pytest.raises(AttributeError):
        rig.method = "mine"


def test_rigs_show_themselves(rig):
    assert repr(rig).startswith("Rig(good: camera 1280x960")
    shown = rig._repr_html_()
    assert shown.startswith("<table>") and shown.endswith("</table>")
    assert "good" in shown and "1280x960" in shown
    assert "<script>" not in slcal.Rig(rig.camera, method="<script>")._repr_html_()


def test_rigs_by_hand():
    camera = slcal.Camera.from_fov((1280, 960), 45)
    alone = slcal.Rig(camera)
    assert alone.projector is None and alone.projector_from_camera is None and alone.baseline_mm is None
    assert alone.quality is None and alone.covariance is None and alone.report is None and alone.views == []
    assert slcal.Rig.from_json(alone.to_json()) == alone
    for incomplete in ({"projector": camera}, {"projector_from_camera": slcal.Pose(np.eye(3), [1, 0, 0])}):
        with pytest.raises(slcal.Error, match="both"):
            slcal.Rig(camera, **incomplete)
    with pytest.raises(TypeError):
        slcal.Rig("camera")


def test_to_and_from_opencv(rig):
    parameters = rig.to_opencv()
    assert parameters["t"].shape == (3, 1)
    for again in (slcal.Rig.from_opencv(parameters), slcal.Rig.from_opencv(**parameters)):
        assert again.camera.K.tolist() == rig.camera.K.tolist()
        assert again.projector.distortion.tolist() == rig.projector.distortion.tolist()
        assert again.projector_from_camera.matrix == pytest.approx(rig.projector_from_camera.matrix, abs=1e-14)
        assert again.projector.size == (1024, 768)
    alone = slcal.Rig.from_opencv(camera_K=np.eye(3) * [2, 2, 1], camera_size=(10, 10))
    assert alone.projector is None
    with pytest.raises(slcal.Error, match="camera_size"):
        slcal.Rig.from_opencv(camera_K=np.eye(3))
    with pytest.raises(slcal.Error, match="projector_K"):
        slcal.Rig.from_opencv({k: v for k, v in parameters.items() if k != "projector_K"})
    with pytest.raises(slcal.Error, match="cameraMatrix"):
        slcal.Rig.from_opencv(cameraMatrix=np.eye(3))
    with pytest.raises(TypeError):
        slcal.Rig.from_opencv(3)
