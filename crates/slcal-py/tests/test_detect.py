import pickle
import threading

import numpy as np
import pytest
from common import DEMO, REPOSITORY

import slcal
from slcal import simulate

SIZE = (594, 420)


@pytest.fixture(scope="module")
def checker():
    return slcal.CheckerPattern(projector=(1024, 768))


@pytest.fixture(scope="module")
def photo():
    return slcal.read_image(DEMO / "sheet.jpg")


@pytest.fixture(scope="module")
def truth():
    return slcal.Rig.load(DEMO / "truth_rig.json")


@pytest.fixture(scope="module")
def found(photo, checker):
    return slcal.detect(photo, SIZE, checker)


def seen_at(rig, projector_px):
    """Where the camera of a rig sees projector pixels on its first view's sheet, by homographies."""

    def onto(device, pose):
        return device.K @ np.column_stack([pose.R[:, :2], pose.t])

    view = rig.views[0]
    camera_from_panel = onto(rig.camera, view.camera_from_sheet) @ np.linalg.inv(
        onto(rig.projector, view.projector_from_sheet)
    )
    pixels = np.column_stack([projector_px, np.ones(len(projector_px))]) @ camera_from_panel.T
    return pixels[:, :2] / pixels[:, 2:]


def bare_sheet(dtype=np.uint8, dark=30, bright=220):
    photo = np.full((480, 640), dark, dtype)
    photo[100:380, 120:520] = bright
    return photo


def test_sheet_and_corners_are_where_they_were_rendered(found, truth, checker):
    corners = found.corners
    assert len(corners) == corners.expected == 70
    assert corners.camera_px.shape == corners.projector_px.shape == (70, 2)
    assert corners.sigma_px.shape == (70,)
    assert (corners.projector_px == checker.corners()).all()
    off = corners.camera_px - seen_at(truth, corners.projector_px)
    assert np.sqrt((off**2).sum(axis=1).mean()) < 0.05
    # σ is what the corners scatter by, within the factor that 140 numbers tell it to.
    assert 0.3 < np.sqrt((off**2).mean() / (corners.sigma_px**2).mean()) < 3
    assert found.sheet.corners.shape == (4, 2)
    assert np.abs(found.sheet.corners - truth.views[0].corners_px).max() < 0.1
    ends = {"top": (0, 1), "right": (1, 2), "bottom": (2, 3), "left": (3, 0)}
    assert list(found.sheet.edges) == list(found.sheet.edge_sigma_px) == list(ends)
    for side, (i, j) in ends.items():
        points, sigma = found.sheet.edges[side], found.sheet.edge_sigma_px[side]
        assert points.shape == (len(sigma), 2)
        assert len(sigma) > 20
        a, b = truth.views[0].corners_px[[i, j]]
        along = (b - a) / np.linalg.norm(b - a)
        distance = (points - a) @ [-along[1], along[0]]
        assert np.abs(distance).mean() < 0.15
    assert found.sheet.corner_sigma_px is None


def test_each_by_itself(found, photo, checker):
    alone = slcal.detect_corners(photo, checker)
    assert alone == found.corners
    assert alone != found.sheet
    bare = bare_sheet()
    sheet = slcal.detect_sheet(bare)
    assert sheet == slcal.detect(bare, SIZE).sheet
    assert sheet.corners == pytest.approx(
        np.array([[119.5, 99.5], [519.5, 99.5], [519.5, 379.5], [119.5, 379.5]]), abs=0.05
    )
    assert len(slcal.detect(bare, SIZE).corners) == 0


def test_layout_and_depth_of_a_picture_do_not_matter(photo, checker, found):
    bgr = np.ascontiguousarray(photo[..., ::-1])
    assert slcal.detect(bgr[..., ::-1], SIZE, checker) == found
    wide = np.zeros((photo.shape[0], photo.shape[1] + 40, 3), np.uint8)
    wide[:, 20:-20] = photo
    assert slcal.detect(wide[:, 20:-20], SIZE, checker) == found
    deep = slcal.detect(photo.astype(np.uint16) * 257, SIZE, checker)
    assert np.abs(deep.corners.camera_px - found.corners.camera_px).max() < 0.01
    locked = photo.copy()
    locked.flags.writeable = False
    assert slcal.detect(locked, list(SIZE), checker) == found


def test_other_sheets_and_the_dark(checker):
    photo = slcal.read_image(REPOSITORY / "fixtures/dark_clutter.jpg")
    found = slcal.detect(photo, SIZE, checker)
    assert len(found.corners) > 60
    corners = found.sheet.corners
    assert ((corners > 0) & (corners < [1920, 1080])).all()


def test_corners_by_hand(photo, checker, found, truth):
    near = truth.views[0].corners_px + [[3, -2], [-2, 1], [1, 2], [-1, -3]]
    by_hand = slcal.detect(photo, SIZE, checker, corners=near.tolist())
    assert by_hand.sheet.corners == pytest.approx(found.sheet.corners, abs=0.02)
    # Where there is nothing to measure they are taken as they are, and that is said.
    nothing = np.full((480, 640), 30, np.uint8)
    given = np.array([[50, 50], [600.5, 40], [610, 400], [-30, 420]])
    sheet = slcal.detect_sheet(nothing, corners=given)
    assert sheet.corners.tolist() == given.tolist()
    assert sheet.corner_sigma_px == pytest.approx(0.002 * 800)
    assert {len(points) for points in sheet.edges.values()} == {0}
    assert "given corners" in sheet.notes[0]


def test_plain_photographs_give_the_sides(photo, checker, found):
    plain = slcal.detect(photo, SIZE, checker, screen=photo)
    assert plain.corners == found.corners
    with pytest.raises(slcal.Error, match="1280x960.*1280x900"):
        slcal.detect(photo, SIZE, checker, screen=photo[:900])
    with pytest.raises(TypeError, match="screen"):
        slcal.detect(photo, SIZE, checker, screen="screen.png")


def test_what_is_not_there_is_not_found(photo, checker):
    dark = np.zeros((480, 640, 3), np.uint8)
    for call in [
        lambda: slcal.detect(dark, SIZE),
        lambda: slcal.detect_sheet(dark),
        lambda: slcal.detect(bare_sheet(), SIZE, checker),
        lambda: slcal.detect_corners(bare_sheet(), checker),
    ]:
        with pytest.raises(slcal.DetectionError) as caught:
            call()
        assert caught.value.what in ("sheet", "checkerboard")
        assert caught.value.seen
        assert caught.value.advice
        assert "--" not in str(caught.value)


@pytest.mark.parametrize(
    ("photo", "words"),
    [
        (None, "cv2.imread"),
        ("photo.jpg", "slcal.read_image"),
        ([[0, 1], [2, 3]], "np.asarray"),
        (np.zeros((480, 640), np.float64), "uint8"),
        (np.zeros((480, 640), np.int32), "int32"),
        (np.zeros((480, 640), bool), "bool"),
    ],
)
def test_photographs_of_a_wrong_type(photo, words, checker):
    for call in [
        lambda: slcal.detect(photo, SIZE, checker),
        lambda: slcal.detect_sheet(photo),
        lambda: slcal.detect_corners(photo, checker),
        lambda: slcal.observe([photo], SIZE, checker),
    ]:
        with pytest.raises(TypeError, match=words):
            call()


@pytest.mark.parametrize("shape", [(480, 640, 4), (480, 640, 1), (3, 480, 640), (1, 480, 640, 3), (480,), (0, 0), (0, 5, 3)])
def test_photographs_of_a_wrong_shape(shape, checker):
    photo = np.zeros(shape, np.uint8)
    with pytest.raises(slcal.Error):
        slcal.detect(photo, SIZE, checker)
    with pytest.raises(slcal.Error):
        slcal.detect_corners(photo, checker)


def test_invalid_arguments(photo, checker):
    with pytest.raises(TypeError, match="CheckerPattern"):
        slcal.detect(photo, SIZE, slcal.StripePattern((1024, 768)))
    for size in [594, (594,), (594, 420, 1), (0, 420), (-1, 2), (float("nan"), 420), (0.594, 0.42), None]:
        with pytest.raises(slcal.Error, match="size_mm.*millimetres"):
            slcal.detect(photo, size, checker)
    square = np.array([[0, 0], [100, 0], [100, 100], [0, 100.0]])
    for corners, words in [
        (square[:3], "3 corners"),
        (square[::-1], "TL, TR, BR, BL"),
        (np.where(square == 100, np.nan, square), "row 1"),
        (np.zeros((4, 3)), r"\(4, 3\)"),
        (square * 1e12, "row 1"),
    ]:
        with pytest.raises(slcal.Error, match=words):
            slcal.detect(photo, SIZE, checker, corners=corners)
    with pytest.raises(TypeError, match="corners"):
        slcal.detect_sheet(photo, corners="0,0 1,0 1,1 0,1")
    for gamma in ["rec709", 0, float("nan"), -2.2]:
        with pytest.raises(slcal.Error, match="gamma|encoding"):
            slcal.detect(photo, SIZE, checker, gamma=gamma)


def test_gamma_is_that_of_the_photograph():
    # An edge pixel that is half covered is half as bright in linear light only.
    photo = bare_sheet(np.uint16, 0, 60000)
    photo[99, 120:520] = 30000
    found = slcal.detect_sheet(photo, gamma="linear")
    assert found.edges["top"][:, 1].mean() == pytest.approx(99.0, abs=0.02)
    otherwise = slcal.detect_sheet(photo, gamma="srgb")
    assert otherwise.edges["top"][:, 1].mean() - 99.0 > 0.05


def test_results_are_values(found, photo, checker):
    again = slcal.detect(photo, SIZE, checker)
    for one, other in [(found, again), (found.sheet, again.sheet), (found.corners, again.corners)]:
        assert one == other
        assert pickle.loads(pickle.dumps(one)) == one
        assert one != "another thing"
    assert repr(found) == "Detection(sheet found, 70 of 70 corners)"
    assert repr(found.corners) == "CornerDetection(70 of 70 corners)"
    assert repr(found.sheet).startswith("SheetDetection((")
    by_hand = slcal.detect_sheet(np.full((480, 640), 30, np.uint8), corners=[[0, 0], [9, 0], [9, 9], [0, 9]])
    assert pickle.loads(pickle.dumps(by_hand)) == by_hand
    with pytest.raises(AttributeError):
        found.sheet = None
    # Arrays are the caller's own.
    found.corners.camera_px[:] = 0
    assert found == again


def test_the_interpreter_goes_on_meanwhile(photo, checker):
    ticks = 0
    done = threading.Event()

    def work():
        slcal.detect(photo, SIZE, checker)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.001):
        ticks += 1
    thread.join()
    assert ticks > 5


def truly_seen(rig, projector_px):
    """Where the camera sees projector pixels on the first view's sheet, through both lenses."""
    rays = rig.projector.rays(projector_px)
    pose = rig.views[0].projector_from_sheet
    # R·X + t = s·ray with X on the plane z = 0.
    normal = pose.R[:, 2]
    depth = (normal @ pose.t) / (rays @ normal)
    return rig.camera.project(rig.projector_from_camera.inverse().transform(rays * depth[:, None]))


@pytest.mark.parametrize(
    "options",
    [
        {"camera": (900, 700), "focal": 1000, "distance": 700, "tilt": (20, 25), "distortion": [0.06, -0.02]},
        {"camera": (1500, 1100), "focal": 1700, "lens_shift": 0.4, "tilt": (-15, 30, 5), "bits": 16, "gamma": "linear"},
        {"camera": (700, 900), "focal": 900, "size_mm": (297, 420), "distance": 800, "tilt": (5, -30), "noise": 2.0},
    ],
)
def test_simulated_scenes_of_other_rigs(options):
    checker = slcal.CheckerPattern((1280, 800), squares=(8, 7), square_px=60)
    size = options.get("size_mm", (420, 297))
    options = {"size_mm": size, "projector": (1280, 800), "projector_focal": 2400, "distance": 900, **options}
    scene = simulate.scene("sheet", checker, **options)
    gamma = options.get("gamma", "srgb")
    found = slcal.detect(scene.photo, size, checker, gamma=gamma)
    assert len(found.corners) == 42
    off = found.corners.camera_px - truly_seen(scene.rig, found.corners.projector_px)
    assert np.sqrt((off**2).mean()) < 0.04
    assert np.abs(off / found.corners.sigma_px[:, None]).max() < 6
    corners = scene.rig.views[0].corners_px
    bend = 1.5 if "distortion" in options else 0.1
    assert np.abs(found.sheet.corners - corners).max() < bend
    for side, (i, j) in {"top": (0, 1), "left": (3, 0)}.items():
        straight = scene.rig.camera.undistort(found.sheet.edges[side])
        a, b = scene.rig.camera.undistort(corners[[i, j]])
        across = (straight - a) @ np.array([-(b - a)[1], (b - a)[0]]) / np.linalg.norm(b - a)
        assert np.abs(across).mean() * options["focal"] < 0.1
    # Under plain light the sheet is found without the pattern, and its sides serve as those of the screen.
    plain = slcal.detect_sheet(scene.white, gamma=gamma)
    assert np.abs(plain.corners - corners).max() < bend
    both = slcal.detect(scene.photo, size, checker, screen=scene.white, gamma=gamma)
    assert both.corners == found.corners
    assert np.abs(both.sheet.corners - corners).max() < bend
