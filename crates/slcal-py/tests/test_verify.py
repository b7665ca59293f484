import pickle

import numpy as np
import pytest
from common import DEMO

import slcal
from slcal import simulate

SIZE = (594, 420)
PANEL = (1024, 768)
IDEAL = {"distortion": "none", "projector_distortion": "none", "flatness": "flat"}


@pytest.fixture(scope="module")
def checker():
    return slcal.CheckerPattern(projector=PANEL)


@pytest.fixture(scope="module")
def truth():
    return slcal.Rig.load(DEMO / "truth_rig.json")


@pytest.fixture(scope="module")
def rig(checker):
    # The photographs of this file are made by homographies: lenses are straight and the sheet is flat.
    return slcal.calibrate([slcal.read_image(DEMO / "sheet.jpg")], SIZE, checker, **IDEAL)


def onto(device, pose):
    """Pixels of a device from places on a sheet, mm."""
    return device.K @ np.column_stack([pose.R[:, :2], pose.t])


def mapped(h, points):
    p = np.column_stack([points, np.ones(len(points))]) @ h.T
    return p[:, :2] / p[:, 2:]


def turned(pose, degrees):
    """The same with its projector turned about its vertical axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return slcal.Pose([[c, 0, s], [0, 1, 0], [-s, 0, c]], [0, 0, 0]) @ pose


def photographed(rig, panel, projector_from_camera):
    """A photograph of the first view's sheet under a panel's light: nine samples a pixel of linear light, then sRGB."""
    width, height = rig.camera.size
    view = rig.views[0]
    sheet_from_camera = np.linalg.inv(onto(rig.camera, view.camera_from_sheet))
    panel_from_sheet = onto(rig.projector, projector_from_camera @ view.camera_from_sheet)
    shown = np.pad((panel[..., 0] > 127).astype(float), 1)  # Nothing beside the panel.
    (left, top), (right, bottom) = view.corners_px.min(axis=0) - 3, view.corners_px.max(axis=0) + 3
    columns, rows = np.arange(int(left), int(right)), np.arange(int(top), int(bottom))
    light = np.full((height, width), 0.02)
    sheet = np.zeros((len(rows), len(columns)))
    for dy in (-1 / 3, 0, 1 / 3):
        for dx in (-1 / 3, 0, 1 / 3):
            x, y = np.meshgrid(columns + dx, rows + dy)
            at = mapped(sheet_from_camera, np.column_stack([x.ravel(), y.ravel()]))
            on_sheet = ((at > 0) & (at < SIZE)).all(axis=1)
            i, j = np.clip(np.round(mapped(panel_from_sheet, at)).astype(int) + 1, 0, np.array(PANEL) + 1).T
            sheet += np.where(on_sheet, 0.2 + 0.5 * shown[j, i], 0.02).reshape(sheet.shape) / 9
    light[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] = sheet
    encoded = np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    noise = np.random.default_rng(7).normal(0, 0.7, light.shape)
    return np.clip(255 * encoded + noise, 0, 255).round().astype(np.uint8)


def scaled(device, factor):
    """The same with its focal length changed."""
    return slcal.Camera(device.K * np.array([[factor, 1, 1], [1, factor, 1], [1, 1, 1]]), device.size)


def angles_on_sheet(corners):
    """Of the sides top, right, bottom, left against the sheet's own, degrees; clockwise, as the sheet is seen, counts up."""
    ends = [(0, 1), (1, 2), (3, 2), (0, 3)]
    d = np.array([corners[j] - corners[i] for i, j in ends])
    against = [np.arctan2(v[1], v[0]) if k % 2 == 0 else np.arctan2(-v[0], v[1]) for k, v in enumerate(d)]
    return np.degrees(against)


def test_the_picture_lies_on_the_sheet_where_it_says(rig, checker):
    picture = np.zeros((300, 400, 3), np.uint8)
    place = rig.rectification(picture)
    source = np.array([[-0.5, -0.5], [399.5, -0.5], [399.5, 299.5], [-0.5, 299.5]])
    sheet_from_panel = np.linalg.inv(onto(rig.projector, rig.views[0].projector_from_sheet))
    on_sheet = mapped(sheet_from_panel, place.map(source))
    (x, y), (w, h) = place.origin_mm, place.size_mm
    assert on_sheet == pytest.approx(np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]]), abs=1e-6)
    assert w / h == pytest.approx(4 / 3)
    assert ((on_sheet > -1e-6) & (on_sheet < np.array(SIZE) + 1e-6)).all()
    assert place.corners_px == pytest.approx(place.map(source))
    assert mapped(place.panel_from_source, source) == pytest.approx(place.map(source))
    assert pickle.loads(pickle.dumps(place)) == place == rig.rectification(picture[..., 0])
    assert place != rig.rectification(checker)
    assert repr(place).startswith(f"Rectification({w:.1f} x {h:.1f} mm")


def test_through_the_lens_of_a_projector(rig):
    bent = slcal.Camera(rig.projector.K, rig.projector.size, [0.05])
    place = slcal.Rig.from_json(rig.to_json().replace(*distorted(rig, bent))).rectification(np.zeros((300, 400), np.uint8))
    source = [[10, 20], [390, 280]]
    ideal = mapped(place.panel_from_source, np.array(source))
    assert bent.undistort(place.map(source)) == pytest.approx(
        np.column_stack([ideal, [1, 1]]) @ np.linalg.inv(bent.K).T[:, :2], abs=1e-9
    )
    assert np.abs(place.map(source) - ideal).max() > 0.5
    assert pickle.loads(pickle.dumps(place)) == place


def distorted(rig, projector):
    """The projector's distortion in a rig's file, before and after."""
    text = rig.to_json()
    at = text.index('"distortion"', text.index('"projector"'))
    end = text.index("]", at) + 1
    before = text[text.index('"projector"') : end]
    return before, before[: before.index("[", before.index('"distortion"'))] + str(projector.distortion.tolist())


def test_what_is_drawn_is_where_it_is_said_to_be(rig, checker):
    drawn = rig.rectify(checker)
    assert drawn.shape == (768, 1024, 3)
    assert drawn.dtype == np.uint8
    found = slcal.detect_corners(drawn, checker)
    assert len(found) == 70
    expected = rig.rectification(checker).map(found.projector_px)
    assert np.abs(found.camera_px - expected).max() < 0.03

    picture = np.zeros((60, 80, 3), np.uint8)
    picture[:, :40] = [255, 0, 0]
    picture[:, 40:] = [0, 0, 255]
    shown, place = rig.rectify(picture), rig.rectification(picture)
    (left, right) = np.round(place.map([[20, 30], [60, 30]])).astype(int)
    assert shown[left[1], left[0]].tolist() == [255, 0, 0]
    assert shown[right[1], right[0]].tolist() == [0, 0, 255]
    assert (rig.rectify(picture.astype(np.uint16) * 257) == shown).all()
    grey = rig.rectify(picture[..., 0])
    assert (grey == shown[..., :1]).all()
    assert (rig.rectify(picture[:, ::-1][:, ::-1], view=0) == shown).all()


def test_invalid_pictures_and_views(rig, checker):
    for view in (1, -1):
        with pytest.raises(slcal.Error, match=f"view.*{view} of 1"):
            rig.rectify(checker, view=view)
    other = slcal.CheckerPattern((800, 600))
    for call in (rig.rectify, rig.rectification):
        with pytest.raises(slcal.Error, match="1024x768.*800x600"):
            call(other)
        with pytest.raises(TypeError, match="source.*CheckerPattern"):
            call("picture.png")
        with pytest.raises(TypeError, match="source.*float64"):
            call(np.zeros((4, 4)))
        with pytest.raises(slcal.Error, match="source"):
            call(np.zeros((4, 4, 4), np.uint8))
        with pytest.raises(slcal.Error):
            call(np.zeros((0, 4, 3), np.uint8))
    alone = slcal.Rig(rig.camera)
    with pytest.raises(slcal.Error, match="view.*without views"):
        alone.rectify(checker)


def test_an_unmoved_rig_has_no_keystone(rig, checker):
    photo = photographed(rig, rig.rectify(checker), rig.projector_from_camera)
    said = rig.verify(photo, checker)
    assert isinstance(said, slcal.reports.Verification)
    assert said.pattern == "rectified"
    assert said.with_covariance
    assert not said.rig.moved
    assert said.sheet is not None
    assert not said.sheet.moved
    assert said.corners == said.pattern_corners == 70
    assert abs(said.keystone.worst_deg.value) < 0.1
    place = rig.rectification(checker)
    corners = np.array(said.keystone.corners_mm)
    # The pattern's own outline, half a square inside what is placed.
    outline = checker.origin_px + np.array([[0, 0], [11, 0], [11, 8], [0, 8]]) * checker.square_px
    panel = place.map(outline)
    expected = mapped(np.linalg.inv(onto(rig.projector, rig.views[0].projector_from_sheet)), panel)
    assert np.abs(corners - expected).max() < 0.3
    assert rig.verify(photo, checker, size_mm=SIZE) == said
    assert pickle.loads(pickle.dumps(said)) == said


def test_a_rotated_projector_is_detected(rig, checker):
    now = turned(rig.projector_from_camera, 1.0)
    photo = photographed(rig, rig.rectify(checker), now)
    said = rig.verify(photo, checker)
    assert said.rig.moved
    assert said.rig.p_value < 1e-6
    assert said.sheet is not None
    assert not said.sheet.moved
    outline = checker.origin_px + np.array([[0, 0], [11, 0], [11, 8], [0, 8]]) * checker.square_px
    panel = rig.rectification(checker).map(outline)
    on_sheet = mapped(np.linalg.inv(onto(rig.projector, now @ rig.views[0].camera_from_sheet)), panel)
    expected = angles_on_sheet(on_sheet)
    k = said.keystone
    sides = [k.top_deg, k.right_deg, k.bottom_deg, k.left_deg]
    for side, angle in zip(sides, expected, strict=True):
        assert side.value == pytest.approx(angle, abs=max(4 * side.sigma, 0.02))


def test_a_pattern_as_it_was_drawn(rig, checker, truth):
    photo = slcal.read_image(DEMO / "sheet.jpg")
    said = rig.verify(photo, checker, as_drawn=True)
    assert said.pattern == "as-drawn"
    assert not said.rig.moved
    outline = checker.origin_px + np.array([[0, 0], [11, 0], [11, 8], [0, 8]]) * checker.square_px
    expected = mapped(np.linalg.inv(onto(truth.projector, truth.views[0].projector_from_sheet)), outline)
    assert np.abs(np.array(said.keystone.corners_mm) - expected).max() < 0.5
    # The true rig says how far it is from itself without a covariance.
    exact = slcal.Rig(truth.camera, truth.projector, truth.projector_from_camera)
    bare = exact.verify(photo, checker, as_drawn=True, size_mm=SIZE)
    assert not bare.with_covariance
    assert bare.sheet is None
    assert bare.rig.pattern_off_mm < 0.2
    moved = slcal.Rig(truth.camera, truth.projector, turned(truth.projector_from_camera, 0.5))
    said = moved.verify(photo, checker, as_drawn=True, size_mm=SIZE)
    assert said.rig.moved
    assert said.rig.change is not None
    # Half a degree at some 1.5 m.
    assert said.rig.pattern_off_mm > 3


def test_mismatched_rig_and_photograph_are_refused(rig, checker, truth):
    photo = slcal.read_image(DEMO / "sheet.jpg")
    with pytest.raises(slcal.Error, match="1280x960.*1280x900"):
        rig.verify(photo[:900], checker, as_drawn=True)
    with pytest.raises(slcal.Error, match="1024x768.*800x600"):
        rig.verify(photo, slcal.CheckerPattern((800, 600)), as_drawn=True)
    with pytest.raises(slcal.Error, match="projector"):
        slcal.Rig(rig.camera).verify(photo, checker)
    exact = slcal.Rig(truth.camera, truth.projector, truth.projector_from_camera)
    with pytest.raises(slcal.Error, match="size"):
        exact.verify(photo, checker, as_drawn=True)
    with pytest.raises(slcal.Error, match="significance"):
        rig.verify(photo, checker, as_drawn=True, significance=1.5)
    with pytest.raises(slcal.Error, match="size_mm"):
        rig.verify(photo, checker, size_mm=(0.594, 0.42))
    with pytest.raises(slcal.DetectionError, match="checkerboard"):
        rig.verify(np.zeros_like(photo), checker)
    with pytest.raises(TypeError, match="photo.*uint8"):
        rig.verify(photo.astype(float), checker)
    with pytest.raises(TypeError, match="CheckerPattern"):
        rig.verify(photo, slcal.StripePattern(PANEL))


def test_the_kind_of_change_is_reported(checker):
    scene = {"pattern": checker, "camera": (1000, 750), "focal": 1200, "lens_shift": 0.5}
    tilts = [(25, 28), (-25, -28), (20, -25)]
    made = [simulate.scene("sheet", tilt=tilt, **scene) for tilt in tilts]
    rig = slcal.calibrate([m.photo for m in made], SIZE, checker, **IDEAL)
    truth = made[0].rig
    said = rig.verify(made[1].photo, checker, as_drawn=True)
    assert not said.rig.moved
    assert said.sheet is not None
    assert said.sheet.moved

    changed = {
        "projector-moved": {"projector_from_camera": turned(truth.projector_from_camera, 1.0)},
        "projector-focal": {"projector": scaled(truth.projector, 1.03)},
    }
    for what, change in changed.items():
        parts = {"projector": truth.projector, "projector_from_camera": truth.projector_from_camera, **change}
        now = simulate.scene("sheet", checker, rig=slcal.Rig(truth.camera, **parts), tilt=tilts[0])
        said = rig.verify(now.photo, checker, as_drawn=True)
        assert said.rig.moved
        assert said.rig.change is not None
        assert said.rig.change.what == what
        if what == "projector-moved":
            turn = said.rig.change.turn_deg
            assert turn.value == pytest.approx(1.0, abs=max(4 * turn.sigma, 0.05))
        else:
            percent = said.rig.change.focal_percent
            assert percent.value == pytest.approx(3.0, abs=max(4 * percent.sigma, 0.1))


def test_a_mirrored_board_is_calibrated_and_verified_as_one() -> None:
    checker = slcal.CheckerPattern(projector=(1024, 768), marks=True)
    made = simulate.scene("sheet", pattern=checker, mirror=True, projector_focal=2300)
    rig = slcal.calibrate([made.photo], (594, 420), checker, mirror=True)
    assert rig.mirrored and slcal.Rig.from_json(rig.to_json()).mirrored
    assert not any(w.code == "shown-1:1" for w in rig.quality.warnings)
    seen = slcal.observe([made.photo], (594, 420), checker, mirror=True)
    assert seen.mirrored and slcal.Observations.from_json(seen.to_json()) == seen
    assert slcal.calibrate_observations(seen).mirrored
    again = slcal.Observations(seen.camera, seen.projector, seen.views, mirrored=True)
    assert again == seen
    assert not rig.verify(made.photo, checker, as_drawn=True).rig.moved
