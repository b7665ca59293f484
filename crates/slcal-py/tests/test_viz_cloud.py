import numpy as np
import pytest
import slcal
import viz_scene as scene

matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import slcal.viz  # noqa: E402
from matplotlib.collections import PathCollection  # noqa: E402


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def board(count=500, **kw):
    """A leaning board with everything that a cloud may know."""
    rng = np.random.default_rng(5)
    points = rng.uniform([-200, -150, 0], [200, 150, 0], (count, 3))
    points[:, 2] = 900.0 + 0.3 * points[:, 0]
    known = {
        "colors": rng.integers(0, 255, (count, 3)).astype(np.uint8),
        "sigma": rng.uniform(0.1, 0.5, count),
        "pixels": scene.project(scene.CAMERA_K, np.zeros(5), points),
        "slits": rng.integers(0, 64, count),
    }
    return slcal.PointCloud(points, **(known | kw))


def dots_of(ax):
    (dots,) = [a for a in ax.collections if a.get_gid() == "cloud"]
    return dots


def in_space(ax):
    return np.column_stack(dots_of(ax)._offsets3d)  # matplotlib has no other way to ask for them.


def face_colors(ax):
    return PathCollection.get_facecolor(dots_of(ax))[:, :3]  # In the order given, not that of drawing.


def bars(ax):
    return [a for a in ax.figure.axes if a is not ax]


def test_points_lie_where_they_are_in_the_photographs_colours():
    cloud = board()
    ax = slcal.viz.cloud(cloud)
    assert (in_space(ax) == cloud.points).all()
    assert np.abs(face_colors(ax) - cloud.colors / 255.0).max() < 1e-9
    assert not bars(ax)
    limits = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    assert (cloud.points > limits[:, 0]).all() and (cloud.points < limits[:, 1]).all()


@pytest.mark.parametrize("view", ["3d", "image"])
@pytest.mark.parametrize(
    ("color", "label"), [("depth", "depth, mm"), ("sigma", "1σ along the camera's ray, mm")]
)
def test_colours_stand_for_millimetres(color, label, view):
    cloud = board()
    ax = slcal.viz.cloud(cloud, color, view=view)
    dots = dots_of(ax)
    values = cloud.points[:, 2] if color == "depth" else cloud.sigma
    assert (np.asarray(dots.get_array()) == values).all()
    (bar,) = bars(ax)
    assert bar.get_ylabel() == label
    ax.figure.canvas.draw()
    # From dark to bright, without a step back: what is more is brighter.
    brightness = dots.to_rgba(np.sort(values))[:, :3] @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(brightness) >= -0.02).all() and brightness[-1] > brightness[0] + 0.3


def test_outliers_do_not_take_all_colours():
    sigma = np.random.default_rng(6).uniform(0.1, 0.5, 500)
    sigma[:5] = 1e4
    ax = slcal.viz.cloud(board(sigma=sigma), "sigma")
    low, high = dots_of(ax).get_clim()
    known = np.sort(sigma)
    assert known[5] < low < known[15] and known[-18] < high < 0.5
    asked = slcal.viz.cloud(board(sigma=sigma), "sigma", limits=(0.0, 2.0), cmap="viridis")
    assert dots_of(asked).get_clim() == (0.0, 2.0)
    assert dots_of(asked).get_cmap().name == "viridis"


def test_values_that_are_all_the_same_have_a_scale():
    ax = slcal.viz.cloud(board(sigma=np.full(500, 0.25)), "sigma")
    low, high = dots_of(ax).get_clim()
    assert low < 0.25 < high
    ax.figure.canvas.draw()


def test_slits_have_their_colours():
    slits = np.arange(500) % 64
    colors = face_colors(slcal.viz.cloud(board(slits=slits), "slit"))
    assert np.abs(colors[:64] - colors[64:128]).max() == 0.0
    assert np.abs(np.diff(colors[:64], axis=0)).sum(axis=1).min() > 0.6


def test_the_image_shows_points_where_they_were_seen():
    cloud = board()
    ax = slcal.viz.cloud(cloud, "depth", view="image")
    assert (np.asarray(dots_of(ax).get_offsets()) == cloud.pixels).all()
    top, bottom = ax.get_ylim()
    assert top > bottom  # y down
    ax = slcal.viz.cloud(cloud, view="image", image=scene.photo())
    assert (np.asarray(dots_of(ax).get_offsets()) == cloud.pixels).all()
    assert ax.get_xlim() == (-0.5, scene.WIDTH - 0.5) and ax.get_ylim() == (scene.HEIGHT - 0.5, -0.5)
    # The photograph is dimmed, so that the dots show.
    drawn = np.asarray(ax.images[0].get_array()).astype(float)
    assert np.abs(drawn - 0.7 * scene.photo()).max() < 1.5


def test_depth_before_a_sheet_is_called_so():
    ax = slcal.viz.cloud(board(frame="plane"), "depth")
    assert bars(ax)[0].get_ylabel() == "behind the sheet, mm"
    assert "behind the sheet" in ax.get_zlabel()


def test_large_clouds_are_sampled_reproducibly():
    cloud = board(3000)
    np.random.seed(1)
    before = np.random.get_state()[1].tolist()
    first = in_space(slcal.viz.cloud(cloud, max_points=100))
    again = in_space(slcal.viz.cloud(cloud, max_points=100))
    assert len(first) == 100 and (first == again).all()
    assert len(np.unique(first, axis=0)) == 100
    assert np.random.get_state()[1].tolist() == before  # Nobody else's random numbers are touched.
    colors = face_colors(slcal.viz.cloud(cloud, max_points=100))
    index = [int(np.flatnonzero((cloud.points == p).all(axis=1))[0]) for p in first]
    assert np.abs(colors - cloud.colors[index] / 255.0).max() < 1e-9
    assert len(np.asarray(dots_of(slcal.viz.cloud(cloud, view="image", max_points=70)).get_offsets())) == 70


def test_outliers_do_not_shrink_the_others():
    points = board().points
    points[7] = [0, 0, 1e7]
    ax = slcal.viz.cloud(slcal.PointCloud(points))
    assert len(in_space(ax)) == 499
    assert ax.get_zlim()[1] < 2000
    assert [t.get_text() for t in ax.texts] == ["1 of 500 points lie far outside"]


def test_one_point_is_a_cloud():
    for view in ("3d", "image"):
        slcal.viz.cloud(board(1), "depth", view=view).figure.canvas.draw()


def test_axes_given_are_used_and_nothing_else_changes():
    figure = plt.figure()
    space, flat = figure.add_subplot(1, 2, 1, projection="3d"), figure.add_subplot(1, 2, 2)
    before = dict(matplotlib.rcParams)
    assert slcal.viz.cloud(board(), "sigma", space) is space
    assert slcal.viz.cloud(board(), "depth", flat, view="image") is flat
    assert plt.get_fignums() == [figure.number]
    assert dict(matplotlib.rcParams) == before
    figure.canvas.draw()


def test_invalid_arguments_are_refused():
    cloud = board()
    bare = slcal.PointCloud(cloud.points)
    for call, kind, said in [
        (lambda: slcal.viz.cloud(cloud.points), TypeError, "slcal.PointCloud"),
        (lambda: slcal.viz.cloud(slcal.PointCloud(np.empty((0, 3)))), slcal.Error, "at least one point"),
        (lambda: slcal.viz.cloud(cloud, "hue"), slcal.Error, "hue"),
        (lambda: slcal.viz.cloud(cloud, view="side"), slcal.Error, "side"),
        (lambda: slcal.viz.cloud(cloud, "sigma", limits=(1.0, 0.0)), slcal.Error, "limits"),
        (lambda: slcal.viz.cloud(cloud, "sigma", cmap="pale"), slcal.Error, "pale"),
        (lambda: slcal.viz.cloud(cloud, max_points=0), slcal.Error, "max_points"),
        (lambda: slcal.viz.cloud(bare, "sigma"), slcal.Error, "σ"),
        (lambda: slcal.viz.cloud(bare, "depth", view="image"), slcal.Error, "pixels"),
        (lambda: slcal.viz.cloud(cloud, image=scene.photo()), slcal.Error, "view"),
        (lambda: slcal.viz.cloud(cloud, view="image", image=scene.photo()[:400]), slcal.Error, "outside"),
        (lambda: slcal.viz.cloud(cloud, view="image", image=scene.photo() / 2), TypeError, "float64"),
    ]:
        with pytest.raises(kind, match=said):
            call()
    assert plt.get_fignums() == []  # Nothing is left of what was refused.
    with pytest.raises(slcal.Error, match="3-D"):
        slcal.viz.cloud(cloud, ax=plt.subplots()[1])
    with pytest.raises(slcal.Error, match="flat"):
        slcal.viz.cloud(cloud, ax=plt.figure().add_subplot(projection="3d"), view="image")
