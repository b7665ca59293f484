import numpy as np
import pytest
import slcal
import viz_scene as scene

matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import slcal.viz  # noqa: E402
from matplotlib.collections import PathCollection  # noqa: E402
from mpl_toolkits.mplot3d import proj3d  # noqa: E402


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def lines(ax, gid):
    return [np.column_stack(a.get_data_3d()) for a in ax.lines if a.get_gid() == gid]


def outer_corners(width, height):
    return np.array([[-0.5, -0.5], [width - 0.5, -0.5], [width - 0.5, height - 0.5], [-0.5, height - 0.5]])


def test_the_cameras_pyramid_ends_in_the_corners_of_its_image():
    ax = slcal.viz.rig(scene.rig())
    edges = lines(ax, "camera-edge")
    assert len(edges) == 4 and all((e[0] == 0).all() for e in edges)
    ends = np.stack([e[1] for e in edges])
    seen = scene.project(scene.CAMERA_K, scene.CAMERA_DISTORTION, ends)
    assert np.abs(seen - outer_corners(scene.WIDTH, scene.HEIGHT)).max() < 1e-6
    # Its base is the image's border: sides that the lens bends among them.
    (border,) = lines(ax, "camera-border")
    seen = scene.project(scene.CAMERA_K, scene.CAMERA_DISTORTION, border)
    on_side = np.minimum(
        np.abs(seen - [-0.5, -0.5]).min(axis=1),
        np.abs(seen - [scene.WIDTH - 0.5, scene.HEIGHT - 0.5]).min(axis=1),
    )
    assert on_side.max() < 1e-6
    (top,) = lines(ax, "camera-top")
    assert np.abs(scene.project(scene.CAMERA_K, scene.CAMERA_DISTORTION, top)[:, 1] + 0.5).max() < 1e-6


def test_the_projectors_pyramid_ends_in_the_corners_of_its_panel():
    edges = lines(slcal.viz.rig(scene.rig()), "projector-edge")
    centre = -scene.PROJECTOR_R.T @ scene.PROJECTOR_T
    assert all(np.abs(e[0] - centre).max() < 1e-9 for e in edges)
    ends = np.stack([e[1] for e in edges]) @ scene.PROJECTOR_R.T + scene.PROJECTOR_T
    lit = scene.project(scene.PROJECTOR_K, np.zeros(5), ends)
    assert np.abs(lit - outer_corners(1024, 768)).max() < 1e-6


def test_the_baseline_joins_the_centres():
    ax = slcal.viz.rig(scene.rig())
    (ends,) = lines(ax, "baseline")
    assert (ends[0] == 0).all()
    assert np.abs(ends[1] + scene.PROJECTOR_R.T @ scene.PROJECTOR_T).max() < 1e-9
    assert ax.get_title() == f"baseline {np.linalg.norm(scene.PROJECTOR_T):.1f} mm"


def test_sheets_are_seen_where_the_camera_sees_them():
    ax = slcal.viz.rig(scene.rig(views=2))
    for name in ("sheet 1", "sheet 2"):
        (ring,) = lines(ax, f"{name}-outline")
        seen = scene.project(scene.CAMERA_K, scene.CAMERA_DISTORTION, ring[:4])
        assert np.abs(seen - scene.camera_px(scene.CORNERS_MM)).max() < 1e-6
    assert {"TL of sheet 1", "TL of sheet 2"} < {t.get_text() for t in ax.texts}


def test_depth_is_as_asked():
    edges = lines(slcal.viz.rig(scene.rig(), depth_mm=123.0), "camera-edge")
    assert all(e[1, 2] == pytest.approx(123.0) for e in edges)


def test_the_picture_is_turned_and_not_mirrored():
    """On paper x runs right, y down, and z away from the viewer, up the page as all is seen from above."""
    ax = slcal.viz.rig(scene.rig())
    ax.figure.canvas.draw()

    def drawn(points):
        return np.column_stack(proj3d.proj_transform(*np.array(points, dtype=float).T, ax.get_proj())[:2])

    at, right, down, away = drawn([[0, 0, 500], [100, 0, 500], [0, 100, 500], [0, 0, 600]])
    assert right[0] > at[0] and abs((right - at)[1]) < (right - at)[0]
    assert down[1] < at[1] and abs((down - at)[0]) < abs((down - at)[1])
    assert away[1] > at[1]
    # What is further away is drawn smaller.
    far, far_right = drawn([[0, 0, 1000], [100, 0, 1000]])
    assert np.hypot(*(far_right - far)) < np.hypot(*(right - at))


def test_a_millimetre_is_as_long_along_every_axis():
    ax = slcal.viz.rig(scene.rig())
    ax.set_proj_type("ortho")
    ax.figure.canvas.draw()
    at, right, down, away = np.column_stack(
        proj3d.proj_transform(
            *np.array([[0, 0, 500], [100, 0, 500], [0, 100, 500], [0, 0, 600.0]]).T, ax.get_proj()
        )
    )[:, :2]
    # Three equal perpendicular lengths, seen from any side: the squares of what is seen add up to twice their
    # square, and the two rows of the drawing are perpendicular and equally long.
    rows = np.column_stack([right - at, down - at, away - at])
    product = rows @ rows.T
    assert product[0, 0] == pytest.approx(product[1, 1], rel=1e-6)
    assert abs(product[0, 1]) < 1e-6 * product[0, 0]


def cloud(frame="camera", count=200):
    points = np.random.default_rng(3).uniform([0, 0, -20], [500, 400, 20], (count, 3))
    colors = np.random.default_rng(4).integers(0, 255, (count, 3)).astype(np.uint8)
    if frame == "camera":
        points = points @ scene.SHEET_R.T + scene.SHEET_T
    return slcal.PointCloud(points, colors=colors, frame=frame)


def scattered(ax):
    (dots,) = [a for a in ax.collections if a.get_gid() == "cloud"]
    return np.column_stack(dots._offsets3d), dots  # matplotlib has no other way to ask for them.


def test_a_cloud_is_shown_in_its_colours():
    points, dots = scattered(slcal.viz.rig(scene.rig(), cloud=cloud()))
    assert (points == cloud().points).all()
    assert np.abs(PathCollection.get_facecolor(dots)[:, :3] - cloud().colors / 255.0).max() < 1e-9


def test_a_cloud_on_the_sheet_is_brought_before_the_camera():
    points, _ = scattered(slcal.viz.rig(scene.rig(), cloud=cloud("plane")))
    assert np.abs(points - cloud().points).max() < 1e-9


def test_large_clouds_are_sampled_reproducibly():
    first, _ = scattered(slcal.viz.rig(scene.rig(), cloud=cloud(), max_points=50))
    again, _ = scattered(slcal.viz.rig(scene.rig(), cloud=cloud(), max_points=50))
    assert len(first) == 50 and (first == again).all()


def test_a_camera_alone_and_a_rig_without_views():
    ax = slcal.viz.rig(scene.rig(projector=False))
    assert not lines(ax, "projector-edge") and len(lines(ax, "camera-edge")) == 4
    device = slcal.Camera.from_fov((640, 480), 50.0)
    bare = slcal.Rig(device, device, slcal.Pose(np.eye(3), [-100.0, 0, 0]))
    ax = slcal.viz.rig(bare)
    assert lines(ax, "camera-edge")[0][1, 2] == pytest.approx(80.0)  # 0.8 baselines
    slcal.viz.rig(slcal.Rig(device)).figure.canvas.draw()


def test_a_lens_without_inverse_at_the_border_is_drawn_as_a_pinhole():
    device = slcal.Camera(
        np.array([[300.0, 0, 320], [0, 300.0, 240], [0, 0, 1]]), (640, 480), [-0.6, 0, 0, 0, 0]
    )
    (edge, *_) = lines(slcal.viz.rig(slcal.Rig(device), depth_mm=300.0), "camera-edge")
    assert np.abs(edge[1] - [-320.5, -240.5, 300.0]).max() < 1e-9


def test_axes_given_are_used():
    figure = plt.figure()
    ax = figure.add_subplot(projection="3d")
    assert slcal.viz.rig(scene.rig(), ax) is ax
    assert plt.get_fignums() == [figure.number]
    with plt.style.context("dark_background"):
        slcal.viz.rig(scene.rig()).figure.canvas.draw()


def test_invalid_arguments_are_refused():
    with pytest.raises(TypeError, match="slcal.Rig"):
        slcal.viz.rig(scene.rig().camera)
    with pytest.raises(slcal.Error, match="3-D"):
        slcal.viz.rig(scene.rig(), plt.subplots()[1])
    with pytest.raises(slcal.Error, match="at least one point"):
        slcal.viz.rig(scene.rig(), cloud=slcal.PointCloud(np.empty((0, 3))))
    with pytest.raises(slcal.Error, match="plane"):
        slcal.viz.rig(scene.rig(views=0), cloud=cloud("plane"))
    with pytest.raises(slcal.Error, match="max_points"):
        slcal.viz.rig(scene.rig(), max_points=0)
    with pytest.raises(slcal.Error, match="depth_mm"):
        slcal.viz.rig(scene.rig(), depth_mm=-1.0)
