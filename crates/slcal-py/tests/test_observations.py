import io
import json
import pickle

import numpy as np
import pytest
from common import DEMO, REPOSITORY

import slcal

SIZE = (594, 420)
CORNERS = np.array([[100.25, 90], [1100, 110], [1050, 800], [-20, 780]])
PAIRS = np.array([[400, 300, 271.5, 233.5], [600, 310, 511.5, 233.5], [590, 500, 511.5, 473.5], [390, 510, 271.5, 473.5]])
EDGES = {
    "top": [[0, 0], [5, 0.1], [10, 0]],
    "right": [[10, 0], [10, 10]],
    "bottom": [[10, 10], [0, 10]],
    "left": [[0, 10], [0, 0]],
}


def by_corners(**more):
    return slcal.ViewObservation(SIZE, sheet_corners=CORNERS, **more)


@pytest.fixture(scope="module")
def checker():
    return slcal.CheckerPattern(projector=(1024, 768))


@pytest.fixture(scope="module")
def photo():
    return slcal.read_image(DEMO / "sheet.jpg")


def test_a_view_holds_what_it_was_given():
    view = by_corners(pairs=PAIRS.tolist(), sheet_sigma_px=0.2, pair_sigma_px=[0.1, 0.2, 0.3, 0.4], photo="a.jpg")
    assert view.size_mm == SIZE
    assert (view.sheet_corners == CORNERS).all()
    assert view.sheet_edges is None
    assert (view.pairs == PAIRS).all()
    assert view.sheet_sigma_px == 0.2
    assert view.pair_sigma_px.tolist() == [0.1, 0.2, 0.3, 0.4]
    assert view.photo == "a.jpg"
    assert repr(view) == "ViewObservation(size_mm=(594, 420), sheet by its corners, 4 pairs, photo=\"a.jpg\")"
    bare = by_corners()
    assert bare.pairs.shape == (0, 4)
    assert bare.sheet_sigma_px is None
    assert bare.photo is None


def test_sides_and_their_noise():
    view = slcal.ViewObservation(SIZE, sheet_edges=EDGES)
    assert view.sheet_corners is None
    assert list(view.sheet_edges) == ["top", "right", "bottom", "left"]
    assert {k: v.tolist() for k, v in view.sheet_edges.items()} == EDGES
    assert view.sheet_sigma_px is None
    own = {k: np.column_stack([v, np.full(len(v), 0.1 * (i + 1))]) for i, (k, v) in enumerate(EDGES.items())}
    in_rows = slcal.ViewObservation(SIZE, sheet_edges=own)
    beside = {k: v[:, 2] for k, v in own.items()}
    assert in_rows == slcal.ViewObservation(SIZE, sheet_edges=EDGES, sheet_sigma_px=beside)
    assert in_rows != view
    assert in_rows.sheet_sigma_px["right"].tolist() == [0.2, 0.2]
    one = slcal.ViewObservation(SIZE, sheet_edges=EDGES, sheet_sigma_px=0.3)
    assert one.sheet_sigma_px["top"].tolist() == [0.3] * 3
    five = slcal.ViewObservation(SIZE, sheet_edges=EDGES, pairs=np.column_stack([PAIRS, [0.1, 0.2, 0.3, 0.4]]))
    assert five.pair_sigma_px.tolist() == [0.1, 0.2, 0.3, 0.4]
    assert (five.pairs == PAIRS).all()


def test_array_likes_of_all_kinds_are_points():
    expected = by_corners(pairs=PAIRS)
    assert by_corners(pairs=PAIRS.astype(np.float32).astype(object)) == expected
    assert by_corners(pairs=tuple(map(tuple, PAIRS))) == expected
    # OpenCV gives points as (N, 1, 2).
    assert slcal.ViewObservation(np.array(SIZE), sheet_corners=CORNERS[:, None]) == by_corners()
    assert by_corners(pairs=np.asfortranarray(PAIRS)) == expected


def bad_pairs(row, column, value):
    pairs = PAIRS.copy()
    pairs[row, column] = value
    return pairs


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "either sheet_corners or sheet_edges.*neither"),
        ({"sheet_corners": CORNERS, "sheet_edges": EDGES}, "both"),
        ({"sheet_corners": CORNERS[:3]}, "sheet_corners.*3 corners"),
        ({"sheet_corners": np.zeros((4, 3))}, r"sheet_corners.*\(4, 3\)"),
        ({"sheet_corners": CORNERS * np.inf}, "sheet_corners.*finite"),
        ({"sheet_corners": CORNERS, "pairs": bad_pairs(2, 1, np.nan)}, "pairs.*row 2"),
        ({"sheet_corners": CORNERS, "pairs": bad_pairs(3, 0, 1e12)}, "pairs.*row 3"),
        ({"sheet_corners": CORNERS, "pairs": PAIRS[:, :3]}, r"pairs.*\(4, 3\)"),
        ({"sheet_corners": CORNERS, "sheet_sigma_px": 0}, "sheet_sigma_px.*above zero"),
        ({"sheet_corners": CORNERS, "sheet_sigma_px": [0.1, 0.2]}, "sheet_sigma_px"),
        ({"sheet_corners": CORNERS, "sheet_sigma_px": {"top": 1}}, "sheet_sigma_px.*mapping"),
        ({"sheet_corners": CORNERS, "pairs": PAIRS, "pair_sigma_px": [1, 1, -1, 1]}, "pair_sigma_px.*row 2"),
        ({"sheet_corners": CORNERS, "pairs": PAIRS, "pair_sigma_px": [1, 1]}, r"pair_sigma_px.*\(4,\)"),
        ({"sheet_corners": CORNERS, "pairs": PAIRS, "pair_sigma_px": np.nan}, "pair_sigma_px.*finite"),
        ({"sheet_edges": {k: v for k, v in EDGES.items() if k != "left"}}, "no \"left\""),
        ({"sheet_edges": {**EDGES, "Top": EDGES["top"]}}, "'Top'"),
        ({"sheet_edges": {**EDGES, "top": [[1, 2], [3, np.nan]]}}, "sheet_edges.*top.*row 1"),
        ({"sheet_edges": {**EDGES, "top": [[1, 2, 0.1], [3, 4, 0.1]]}}, "third column.*\"top\""),
        ({"sheet_edges": {k: np.column_stack([v, np.zeros(len(v))]) for k, v in EDGES.items()}}, "above zero.*row 0"),
        ({"sheet_edges": EDGES, "sheet_sigma_px": dict.fromkeys(EDGES, [0.1, 0.1])}, r"sheet_sigma_px.*top.*\(3,\)"),
    ],
)
def test_what_is_wrong_is_named(arguments, words):
    with pytest.raises(slcal.Error, match=words) as caught:
        slcal.ViewObservation(SIZE, **arguments)
    assert caught.value.what
    assert caught.value.found


def test_wrong_types():
    for arguments, words in [
        ({"sheet_edges": [1, 2]}, "sheet_edges.*mapping.*list"),
        ({"sheet_corners": "none"}, "sheet_corners"),
        ({"sheet_corners": CORNERS * 1j}, "sheet_corners.*complex"),
        ({"sheet_corners": CORNERS, "pairs": object()}, "pairs"),
    ]:
        with pytest.raises(TypeError, match=words):
            slcal.ViewObservation(SIZE, **arguments)
    for size in [(0.594, 0.42), (594, -1), "A9", "594x420"]:
        with pytest.raises(slcal.Error, match="size_mm"):
            slcal.ViewObservation(size, sheet_corners=CORNERS)


def test_observations_hold_views_and_detections(photo, checker):
    found = slcal.detect(photo, SIZE, checker)
    seen = slcal.Observations((1280, 960), (1024, 768), iter([found, by_corners(pairs=PAIRS)]))
    assert len(seen) == len(seen.views) == 2
    assert seen.views[0] == found.view
    assert seen.views[0].sheet_sigma_px["top"].tolist() == found.sheet.edge_sigma_px["top"].tolist()
    assert seen.camera == (1280, 960)
    assert seen.projector == (1024, 768)
    assert repr(seen) == "Observations(camera=(1280, 960), projector=(1024, 768), views=2, pairs=74)"
    assert slcal.Observations((1280, 960), None, [found]).projector is None
    # What a detection says can be said by its parts.
    view = slcal.ViewObservation(
        SIZE,
        sheet_edges=found.sheet.edges,
        sheet_sigma_px=found.sheet.edge_sigma_px,
        pairs=np.column_stack([found.corners.camera_px, found.corners.projector_px]),
        pair_sigma_px=found.corners.sigma_px,
        panel_points=found.view.panel_points,
    )
    assert view == found.view
    assert view.panel_points.shape[1] == 5
    for wrong in [[np.nan, 1, 2, 3, 1], [1, 1, np.nan, np.nan, 1], [1, 1, 2, 3, -1]]:
        with pytest.raises(slcal.Error, match="panel_points"):
            slcal.ViewObservation(SIZE, sheet_corners=CORNERS, panel_points=[wrong])
    with pytest.raises(TypeError, match=r"views.*ViewObservation"):
        slcal.Observations((1280, 960), None, found)
    with pytest.raises(TypeError, match=r"views\[1\].*dict"):
        slcal.Observations((1280, 960), None, [found, {}])
    with pytest.raises(slcal.Error, match="camera"):
        slcal.Observations((1280, 0), None, [])


def everything():
    return slcal.Observations(
        (1280, 960),
        (1024, 768),
        [
            by_corners(),
            by_corners(pairs=PAIRS / 3, sheet_sigma_px=0.1 + 0.2, pair_sigma_px=1 / 3, photo='a "b".jpg'),
            slcal.ViewObservation((297, 210), sheet_edges=EDGES, pairs=PAIRS),
            slcal.ViewObservation((1, 100_000), sheet_edges=EDGES, sheet_sigma_px=1e-9, pairs=PAIRS, pair_sigma_px=1e6),
            slcal.ViewObservation(SIZE, sheet_edges=dict.fromkeys(EDGES, [])),
            by_corners(pairs=[[1e9, -1e9, 0, 0]]),
        ],
    )


def test_files_and_pickles_give_the_same_bits(tmp_path):
    seen = everything()
    path = tmp_path / "seen.json"
    seen.save(path)
    assert slcal.Observations.load(path) == seen
    with path.open("rb") as file:
        assert slcal.Observations.load(file) == seen
    text = io.StringIO()
    seen.save(text)
    assert text.getvalue() == path.read_text() == seen.to_json()
    assert slcal.Observations.from_json(seen.to_json()) == seen
    assert pickle.loads(pickle.dumps(seen)) == seen
    for view in seen.views:
        assert pickle.loads(pickle.dumps(view)) == view
    said = json.loads(seen.to_json())
    assert said["schema"] == "slcal-observations/1"
    assert said["views"][1]["photo"] == 'a "b".jpg'
    assert seen != slcal.Observations(seen.camera, seen.projector, seen.views[1:])
    assert seen != slcal.Observations(seen.camera, None, seen.views)
    assert seen != seen.to_json()


def test_invalid_files(tmp_path):
    with pytest.raises(FileNotFoundError):
        slcal.Observations.load(tmp_path / "none.json")
    wrong = tmp_path / "wrong.json"
    said = json.loads(everything().to_json())
    said["views"][2]["pairs"][1][3] = None
    wrong.write_text(json.dumps(said))
    with pytest.raises(slcal.FormatError, match=r"wrong.json.*views\[2\].pairs\[1\]\[3\]"):
        slcal.Observations.load(wrong)
    with pytest.raises(slcal.FormatError, match="JSON"):
        slcal.Observations.from_json("nonsense")


def test_photographs_are_observed_in_their_order(photo, checker):
    seen = slcal.observe([photo, photo], SIZE, checker, names=["a.jpg", "b.jpg"])
    found = slcal.detect(photo, SIZE, checker)
    assert [v.photo for v in seen.views] == ["a.jpg", "b.jpg"]
    assert (seen.views[0].pairs == found.view.pairs).all()
    assert seen.camera == (1280, 960)
    assert seen.projector == (1024, 768)
    single = slcal.observe(photo, SIZE, checker)
    assert single.views == [found.view]
    assert slcal.observe(photo[None], SIZE, checker) == single
    screens = slcal.observe([photo], SIZE, checker, screen=[photo])
    assert screens.views == [slcal.detect(photo, SIZE, checker, screen=photo).view]


def test_corners_by_hand_are_for_one_photograph_or_for_each(photo, checker):
    near = slcal.Rig.load(DEMO / "truth_rig.json").views[0].corners_px + 2
    by_hand = slcal.detect(photo, SIZE, checker, corners=near).view
    found = slcal.detect(photo, SIZE, checker).view
    assert slcal.observe(photo, SIZE, checker, corners=near).views == [by_hand]
    assert slcal.observe([photo], SIZE, checker, corners=[near.tolist()]).views == [by_hand]
    assert slcal.observe([photo, photo], SIZE, checker, corners=[None, near]).views == [found, by_hand]
    assert slcal.observe([photo, photo], SIZE, checker, corners=np.stack([near, near])).views == [by_hand, by_hand]
    with pytest.raises(slcal.Error, match="each of the 2 photographs"):
        slcal.observe([photo, photo], SIZE, checker, corners=near)
    with pytest.raises(slcal.Error, match=r"corners\[1\].*row 0"):
        slcal.observe([photo, photo], SIZE, checker, corners=[near, near * np.nan])


def test_what_is_wrong_with_which_photograph(photo, checker):
    dark = np.zeros_like(photo)
    with pytest.raises(slcal.DetectionError, match=r"^photos\[1\]: checkerboard not found") as caught:
        slcal.observe([photo, dark], SIZE, checker)
    assert caught.value.what == "checkerboard"
    with pytest.raises(slcal.DetectionError, match=r"^photos\[1\] \(b.jpg\): "):
        slcal.observe([photo, dark], SIZE, checker, names=("a.jpg", "b.jpg"))
    with pytest.raises(slcal.Error, match=r"photos\[1\].*1280x960.*1280x900"):
        slcal.observe([photo, photo[:900]], SIZE, checker)
    with pytest.raises(slcal.Error, match=r"plain photograph.*1280x960.*1280x900"):
        slcal.observe([photo], SIZE, checker, screen=[photo[:900]])
    with pytest.raises(TypeError, match=r"photos\[1\].*None"):
        slcal.observe([photo, None], SIZE, checker)
    with pytest.raises(TypeError, match="photos"):
        slcal.observe(None, SIZE, checker)
    with pytest.raises(slcal.Error, match="photos.*at least one"):
        slcal.observe([], SIZE, checker)
    with pytest.raises(slcal.Error, match="screen.*2"):
        slcal.observe([photo], SIZE, checker, screen=[photo, photo])
    with pytest.raises(slcal.Error, match="names.*2"):
        slcal.observe([photo], SIZE, checker, names=["a", "b"])
    with pytest.raises(TypeError, match="names"):
        slcal.observe([photo], SIZE, checker, names="a")


def test_half_the_size_shows_the_same(checker):
    photo = slcal.read_image(REPOSITORY / "fixtures/tilted_half.jpg")
    seen = slcal.observe(photo, SIZE, checker)
    assert seen.camera == (640, 480)
    assert len(seen.views[0].pairs) == 70


def test_observing_and_calibrating_is_calibrating(photo, checker):
    rig = slcal.calibrate([photo], SIZE, checker)
    seen = slcal.Observations((1280, 960), checker.projector, [slcal.detect(photo, SIZE, checker)])
    assert slcal.calibrate_observations(seen) == rig
    assert slcal.calibrate_observations(pickle.loads(pickle.dumps(seen))) == rig
    named = slcal.observe([photo], SIZE, checker, names=["a.jpg"])
    assert slcal.calibrate_observations(named).views[0].photo == "a.jpg"
    # A σ that is not stated is worked out, to something like what the detector says of itself.
    view = seen.views[0]
    unstated = slcal.ViewObservation(SIZE, sheet_edges=view.sheet_edges, pairs=view.pairs)
    again = slcal.calibrate_observations(slcal.Observations((1280, 960), checker.projector, [unstated]))
    assert again != rig
    assert again.camera.K[0, 0] == pytest.approx(rig.camera.K[0, 0], rel=0.01)


def as_mapping(view):
    """What the file says of a view, its leaves arrays."""
    sigma = view.sheet_sigma_px
    edges = {side: np.column_stack([points, sigma[side]]) for side, points in view.sheet_edges.items()}
    return {
        "size_mm": np.array(view.size_mm, np.float32),
        "sheet_edges_px": edges,
        "pairs": np.column_stack([view.pairs, view.pair_sigma_px]),
    }


def test_mappings_with_arrays_in_them(photo, checker):
    seen = slcal.observe([photo], SIZE, checker)
    rig = slcal.calibrate_observations(seen)
    mapping = {
        "camera": {"width": np.int64(1280), "height": np.uint16(960)},
        "projector": {"width": 1024, "height": 768},
        "views": (as_mapping(seen.views[0]),),
    }
    assert slcal.calibrate_observations(mapping) == rig
    assert slcal.calibrate_observations(json.loads(seen.to_json())) == rig

    def refused(kind, words, **change):
        view = {**as_mapping(seen.views[0]), **change}
        with pytest.raises(kind, match=words):
            slcal.calibrate_observations({**mapping, "views": [view]})

    pairs = as_mapping(seen.views[0])["pairs"]
    broken = pairs.copy()
    broken[5, 1] = np.nan
    refused(slcal.Error, r"views\[0\].pairs\[5\]\[1\].*finite", pairs=broken)
    broken[5, 1] = -np.inf
    refused(slcal.Error, r"views\[0\].pairs\[5\]\[1\].*-inf", pairs=broken)
    refused(slcal.FormatError, r"views\[0\].pairs\[0\]", pairs=pairs[:, :3])
    refused(slcal.FormatError, r"views\[0\].size_mm", size_mm=594)
    refused(TypeError, r"views\[0\].pairs.*set", pairs={1, 2})
    refused(TypeError, r"views\[0\].pairs\[0\]\[0\].*complex", pairs=pairs * 1j)
    refused(TypeError, r"views\[0\].sheet_edges_px.*keys", sheet_edges_px={1: [[0, 1]]})
    with pytest.raises(slcal.FormatError, match="camera"):
        slcal.calibrate_observations({"views": []})
    with pytest.raises(slcal.FormatError, match="slcal-observations/1"):
        slcal.calibrate_observations({**mapping, "schema": "slcal-observations/2"})
    endless = dict(mapping)
    endless["views"] = [endless]
    with pytest.raises(slcal.Error, match="hold itself"):
        slcal.calibrate_observations(endless)
    for wrong in [None, [seen], seen.to_json(), seen.views[0]]:
        with pytest.raises(TypeError, match="observations.*mapping"):
            slcal.calibrate_observations(wrong)
