import numpy as np
import pytest
import slcal
import viz_scene as scene
from common import DEMO

matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import slcal.viz  # noqa: E402
from matplotlib.colors import to_rgb  # noqa: E402


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def line(ax, gid):
    (found,) = [a for a in ax.lines if a.get_gid() == gid]
    return np.column_stack(found.get_data())


def part(ax, gid):
    (found,) = [a for a in ax.collections if a.get_gid() == gid]
    return found


GRID_MM = np.array([[x, y, 0.0] for y in (100, 200, 300) for x in (150, 250, 350, 450)])
SIDES = {"top": (0, 1), "right": (1, 2), "bottom": (2, 3), "left": (3, 0)}


def on_side(side, count):
    first, last = (scene.CORNERS_MM[i] for i in SIDES[side])
    return first + np.linspace(0.1, 0.9, count)[:, None] * (last - first)


def observation(pair_offset=0.0, edge_offset=0.0):
    """Pattern corners and edge points as the rig sees them, and so far off, px."""
    edges = {}
    for side in SIDES:
        points = scene.camera_px(on_side(side, 30))
        along = np.gradient(points, axis=0)
        normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
        edges[side] = points + edge_offset * normal
    pairs = np.column_stack([scene.camera_px(GRID_MM) + pair_offset, scene.projector_px(GRID_MM)])
    return slcal.ViewObservation(scene.SIZE_MM, sheet_edges=edges, pairs=pairs)


def test_a_view_is_drawn_where_it_was_seen():
    seen = observation()
    ax = slcal.viz.overlay(scene.photo(), seen)
    assert (line(ax, "pattern-corners") == seen.pairs[:, :2]).all()
    assert (line(ax, "pattern-first") == seen.pairs[:1, :2]).all()
    assert (line(ax, "edge-points") == np.concatenate(list(seen.sheet_edges.values()))).all()
    rows = line(ax, "pattern-rows")
    # Rows of the board are joined, and not one with the next.
    pieces = np.split(rows, np.flatnonzero(np.isnan(rows[:, 0])))
    assert [int(np.isfinite(p[:, 0]).sum()) for p in pieces if len(p)] != [len(GRID_MM)]
    assert [t.get_text() for t in ax.get_legend().get_texts()][:2] == [
        "120 edge points",
        "12 corners of the pattern",
    ]


def test_corners_of_the_sheet_are_named():
    corners = scene.camera_px(scene.CORNERS_MM)
    ax = slcal.viz.overlay(scene.photo(), slcal.ViewObservation(scene.SIZE_MM, sheet_corners=corners))
    assert {t.get_text(): t.xy for t in ax.texts} == {
        name: tuple(xy) for name, xy in zip(["TL", "TR", "BR", "BL"], corners.tolist(), strict=True)
    }
    ring = line(ax, "sheet")
    assert (ring[:4] == corners).all() and (ring[4] == corners[0]).all()


def test_corners_beyond_the_frame_are_in_view():
    corners = scene.camera_px(scene.CORNERS_MM) - np.array([400.0, 0.0])
    assert corners[:, 0].min() < -100
    ax = slcal.viz.overlay(scene.photo(), slcal.ViewObservation(scene.SIZE_MM, sheet_corners=corners))
    assert ax.get_xlim()[0] < corners[:, 0].min() and ax.get_xlim()[1] == scene.WIDTH - 0.5
    assert ax.get_ylim() == (scene.HEIGHT - 0.5, -0.5)


def test_detections_are_drawn():
    checker = slcal.CheckerPattern((640, 480))
    found = slcal.detect_corners(checker.image(), checker)
    ax = slcal.viz.overlay(checker.image(), found)
    # The pattern itself, seen as it was drawn.
    drawn = line(ax, "pattern-corners")
    assert np.abs(drawn - found.projector_px).max() < 0.1
    assert ax.get_legend().get_texts()[0].get_text() == f"{len(found)} of 70 corners of the pattern"


def test_residuals_are_observed_minus_predicted():
    offset = np.array([0.3, -0.2])
    seen = observation(pair_offset=offset, edge_offset=0.25)
    ax = slcal.viz.overlay(scene.photo(), seen, rig=scene.rig(), magnify=100.0)
    pattern = part(ax, "residuals-pattern")
    assert np.abs(np.asarray(pattern.get_offsets()) - scene.camera_px(GRID_MM)).max() < 1e-6
    assert np.abs(np.column_stack([pattern.U, pattern.V]) - offset).max() < 1e-6
    # A pixel of residual is drawn as 100 pixels of the photograph.
    assert pattern.scale == pytest.approx(0.01) and pattern.scale_units == "xy" and pattern.angles == "xy"
    # The outline is that of the rig, with its distortion.
    outline = line(ax, "sheet")
    for side in SIDES:
        first, last = (scene.CORNERS_MM[i] for i in SIDES[side])
        bent = scene.camera_px(first + np.arange(9)[:, None] / 8 * (last - first))
        assert np.hypot(*(outline[:, None] - bent).T).min(axis=1).max() < 1e-6
        edge = part(ax, f"residuals-{side}")
        assert np.abs(np.hypot(edge.U, edge.V) - 0.25).max() < 1e-4


def test_residuals_are_those_of_the_calibration():
    photo, checker = slcal.read_image(DEMO / "sheet.jpg"), slcal.CheckerPattern((1024, 768))
    # The overlay draws straight sides.
    rig = slcal.calibrate([photo], scene.SIZE_MM, checker, distortion="none", projector_distortion="none", flatness="flat")
    ax = slcal.viz.overlay(photo, slcal.detect(photo, scene.SIZE_MM, checker), rig=rig)
    pattern = part(ax, "residuals-pattern")
    rms = np.sqrt((np.asarray(pattern.U) ** 2 + np.asarray(pattern.V) ** 2).mean())
    assert rms == pytest.approx(rig.views[0].rms_px.corners, rel=1e-6)
    edges = [part(ax, f"residuals-{side}") for side in SIDES]
    length = np.concatenate([np.hypot(e.U, e.V) for e in edges])
    # Only some of the edge points have arrows.
    assert np.sqrt((length**2).mean()) == pytest.approx(rig.views[0].rms_px.edges, rel=0.2)
    assert len(ax.texts) == 4 and "70 of 70" in ax.get_legend().get_texts()[2].get_text()


def test_arrows_point_the_way_they_say():
    """In the drawn picture: a residual to the right and down ends to the right of and below its start."""
    seen = observation(pair_offset=np.array([0.5, 0.5]))
    ax = slcal.viz.overlay(scene.photo(), seen, rig=scene.rig(), magnify=100.0)
    ax.figure.canvas.draw()
    pattern = part(ax, "residuals-pattern")
    tips = np.stack([path.vertices.mean(axis=0) for path in pattern.get_paths()])
    assert (tips[:, 0] > 0).all() and (tips[:, 1] < 0).all()  # Display units: up counts up.


def test_magnification_is_round_and_labelled():
    pairs = observation(pair_offset=np.array([0.03, 0.04])).pairs
    corners = scene.camera_px(scene.CORNERS_MM)
    seen = slcal.ViewObservation(scene.SIZE_MM, sheet_corners=corners, pairs=pairs)
    ax = slcal.viz.overlay(scene.photo(), seen, rig=scene.rig())
    pattern = part(ax, "residuals-pattern")
    # 0.05 px to a fortieth of the diagonal of 1600 px: 800, and the round number below it.
    assert 1.0 / pattern.scale == pytest.approx(500.0)
    (key,) = [a for a in ax.get_children() if type(a).__name__ == "QuiverKey"]
    assert key.U == pytest.approx(0.1)
    assert key.text.get_text() == "0.1 px  (seen \u2212 expected, drawn 500 times as long)"


def test_sheet_corners_alone_have_residuals_too():
    corners = scene.camera_px(scene.CORNERS_MM) + 0.2
    found = slcal.ViewObservation(scene.SIZE_MM, sheet_corners=corners)
    ax = slcal.viz.overlay(scene.photo(), found, rig=scene.rig(projector=False))
    sheet = part(ax, "residuals-sheet")
    assert np.abs(np.column_stack([sheet.U, sheet.V]) - 0.2).max() < 1e-6


def stripes(turned=False):
    """Two leaning stripes with a small gap and a large one, and a point alone."""
    lines = np.array([n for n in range(60) if n != 8 and not 20 <= n < 30])
    curve = [np.column_stack([x + 0.25 * lines, lines]) for x in (100.2, 120.2)]
    pixels = np.concatenate([*curve, [[300.3, 5.0]]])
    slits = np.repeat([3, 4, 9], [len(lines), len(lines), 1])
    shuffled = np.random.default_rng(1).permutation(len(pixels))
    if turned:
        pixels = pixels[:, ::-1]
    return slcal.Matches(pixels[shuffled], columns=16.0 * slits[shuffled] + 7.5, slits=slits[shuffled])


@pytest.mark.parametrize("turned", [False, True])
def test_points_of_one_slit_become_a_curve(turned):
    ax = slcal.viz.overlay(scene.photo(), stripes(turned))
    for slit, start in [(3, 100.2), (4, 120.2)]:
        drawn = line(ax, f"slit-{slit}")
        drawn = drawn[:, ::-1] if turned else drawn
        seen = drawn[np.isfinite(drawn[:, 0])]
        assert np.abs(seen[:, 0] - (start + 0.25 * seen[:, 1])).max() < 1e-9
        # Neighbours are joined, across the gap of one line as well, and not across that of ten.
        pieces = np.split(drawn[:, 1], np.flatnonzero(np.isnan(drawn[:, 1])))
        lines = [[n for n in piece.tolist() if n == n] for piece in pieces]
        assert sorted(n for n in lines if n) == [[n for n in range(20) if n != 8], list(range(30, 60))]
    assert line(ax, "slit-9-dots").shape == (1, 2)
    assert len(line(ax, "slit-3-dots")) == 0
    assert {t.get_text() for t in ax.texts} == {"3", "4", "9"}


def test_slits_have_colours_of_their_own():
    """Neighbouring slits differ most: a curve that changes its slit is seen at once."""
    pixels = [[10.5 * s + 5.25, r] for s in range(64) for r in range(3)]
    slits = np.repeat(np.arange(64), 3)
    ax = slcal.viz.overlay(scene.photo(), slcal.Matches(pixels, columns=slits * 16.0, slits=slits))
    colors = np.array([to_rgb(a.get_color()) for a in ax.lines if (a.get_gid() or "").endswith("-dots")])
    assert len(colors) == 64
    assert np.abs(np.diff(colors, axis=0)).sum(axis=1).min() > 0.6
    # And all of them show on a dark photograph.
    assert (colors @ [0.2126, 0.7152, 0.0722]).min() > 0.5


def test_matches_without_slits_are_dots():
    ax = slcal.viz.overlay(scene.photo(), slcal.Matches([[10.0, 20.5], [30.0, 40.5]], columns=[5.0, 6.0]))
    assert (line(ax, "no-slit") == [[10.0, 20.5], [30.0, 40.5]]).all()


def test_photographs_look_as_they_are():
    nothing = slcal.ViewObservation(scene.SIZE_MM, sheet_corners=scene.camera_px(scene.CORNERS_MM))

    def shown(photo, **kw):
        return np.asarray(slcal.viz.overlay(photo, nothing, **kw).images[0].get_array())

    assert (shown(scene.photo()) == scene.photo()).all()
    assert (shown(scene.photo()[..., 0]) == scene.photo()[..., 0]).all()
    deep = scene.photo(np.uint16)
    assert np.abs(shown(deep).astype(float) - deep / 257.0).max() <= 1.0
    # Linear light of 0.2140 is the middle grey of sRGB, and half of the light is 188, which a power of 2.2
    # writes as 186.
    light = np.full((960, 1280), round(0.2140 * 65535), np.uint16)
    assert abs(int(shown(light, gamma="linear")[0, 0]) - 128) <= 1
    assert abs(int(shown(np.full((960, 1280), 186, np.uint8), gamma=2.2)[0, 0]) - 188) <= 1
    image = slcal.viz.overlay(scene.photo(), nothing).images[0]
    assert tuple(image.get_extent()) == (-0.5, 1279.5, 959.5, -0.5)  # Pixels' centres are at integers.


def test_axes_given_are_used_and_nothing_else_changes():
    figure, ax = plt.subplots()
    before = dict(matplotlib.rcParams)
    assert slcal.viz.overlay(scene.photo(), observation(), ax, rig=scene.rig()) is ax
    assert plt.get_fignums() == [figure.number]
    assert dict(matplotlib.rcParams) == before
    assert matplotlib.get_backend().lower() == "agg"
    figure.canvas.draw()


@pytest.mark.parametrize(
    ("picture", "kind", "said"),
    [
        (scene.photo().tolist(), TypeError, "slcal.read_image"),
        (scene.photo() / 255.0, TypeError, "float64"),
        (np.zeros((960, 1280, 4), np.uint8), slcal.Error, r"\(960, 1280, 4\)"),
        (np.zeros((0, 1280, 3), np.uint8), slcal.Error, r"\(0, 1280, 3\)"),
        (scene.photo()[:480, :640], slcal.Error, "640 x 480"),
    ],
)
def test_other_images_are_refused(picture, kind, said):
    with pytest.raises(kind, match=said):
        slcal.viz.overlay(picture, observation(), rig=scene.rig())


def test_what_was_found_elsewhere_is_refused():
    with pytest.raises(slcal.Error, match="outside"):
        slcal.viz.overlay(scene.photo()[:480, :640], observation())
    with pytest.raises(slcal.Error, match="matches.*outside"):
        slcal.viz.overlay(scene.photo(), slcal.Matches([[1280.0, 3.0]], columns=[5.0]))


def test_invalid_arguments_are_refused():
    picture, seen, rig = scene.photo(), observation(), scene.rig()
    with pytest.raises(TypeError, match="found: expected"):
        slcal.viz.overlay(picture, seen.pairs)
    with pytest.raises(slcal.Error, match="1 views"):
        slcal.viz.overlay(picture, seen, rig=rig, view=1)
    with pytest.raises(slcal.Error, match="magnify"):
        slcal.viz.overlay(picture, seen, rig=rig, magnify=0.0)
    with pytest.raises(slcal.Error, match="gamma"):
        slcal.viz.overlay(picture, seen, gamma=-1.0)
    with pytest.raises(slcal.Error, match="with a projector"):
        slcal.viz.overlay(picture, seen, rig=scene.rig(projector=False))
    with pytest.raises(slcal.Error, match="leave rig out"):
        slcal.viz.overlay(picture, stripes(), rig=rig)
    with pytest.raises(slcal.Error, match="3-D"):
        slcal.viz.overlay(picture, seen, plt.figure().add_subplot(projection="3d"))
    assert plt.get_fignums() == [1]  # The last one: nothing is left of what was refused.
