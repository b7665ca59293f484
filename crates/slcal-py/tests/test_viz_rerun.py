import numpy as np
import pytest
import slcal
import viz_scene as scene

rr = pytest.importorskip("rerun", reason="rerun-sdk is not installed: pip install rerun-sdk")
chunk = pytest.importorskip("rerun.chunk", reason="this version of rerun-sdk does not read recordings back")
import slcal.viz  # noqa: E402


def logged(tmp_path, *args, **kw):
    """What to_rerun writes: {entity path: {component: its values}}, and which entities are static."""
    recording = rr.RecordingStream("test")
    recording.save(tmp_path / "scan.rrd")
    slcal.viz.to_rerun(*args, recording=recording, **kw)
    recording.flush()
    recording.disconnect()
    return read(tmp_path / "scan.rrd")


def read(path):
    entities, static = {}, set()
    for part in chunk.RrdReader(path).stream():
        name = str(part.entity_path)
        if name.startswith("/__"):
            continue
        if part.is_static:
            static.add(name)
        batch = part.to_record_batch()
        for column in batch.schema.names:
            if ":" in column:
                entities.setdefault(name, {})[column] = batch.column(column)[0].as_py()
    return entities, static


def cloud(frame="camera"):
    points = np.random.default_rng(3).uniform([0, 0, -20], [500, 400, 20], (50, 3))
    if frame == "camera":
        points = points @ scene.SHEET_R.T + scene.SHEET_T
    colors = np.random.default_rng(4).integers(0, 255, (50, 3)).astype(np.uint8)
    return slcal.PointCloud(points, colors=colors, sigma=np.linspace(0.1, 0.2, 50), frame=frame)


def rgb(packed):
    return np.array([[c >> 24 & 255, c >> 16 & 255, c >> 8 & 255] for c in packed])


def test_everything_is_logged_where_it_is(tmp_path):
    entities, static = logged(tmp_path, scene.rig(), cloud(), scene.photo())
    assert {"/slcal", "/slcal/camera", "/slcal/projector", "/slcal/baseline", "/slcal/sheet/0"} == static
    assert set(entities) - static == {"/slcal/camera/image", "/slcal/points"}

    camera = entities["/slcal/camera"]
    K = np.reshape(camera["Pinhole:image_from_camera"][0], (3, 3)).T  # Columns first.
    # Rerun's pixels have their corners at integers.
    assert np.abs(K - scene.CAMERA_K - [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]]).max() < 1e-3
    assert camera["Pinhole:resolution"][0] == [scene.WIDTH, scene.HEIGHT]

    projector = entities["/slcal/projector"]
    turn = np.reshape(projector["Transform3D:mat3x3"][0], (3, 3)).T
    shift = np.array(projector["Transform3D:translation"][0])
    assert np.abs(turn - scene.PROJECTOR_R.T).max() < 1e-6
    assert np.abs(shift + scene.PROJECTOR_R.T @ scene.PROJECTOR_T).max() < 1e-3
    (ends,) = entities["/slcal/baseline"]["LineStrips3D:strips"]
    assert np.abs(np.array(ends) - [[0, 0, 0], shift]).max() < 1e-3
    (ring,) = entities["/slcal/sheet/0"]["LineStrips3D:strips"]
    seen = scene.project(scene.CAMERA_K, scene.CAMERA_DISTORTION, np.array(ring)[:4])
    assert np.abs(seen - scene.camera_px(scene.CORNERS_MM)).max() < 1e-3

    points = entities["/slcal/points"]
    assert np.abs(np.array(points["Points3D:positions"]) - cloud().points).max() < 1e-3
    assert (rgb(points["Points3D:colors"]) == cloud().colors).all()
    image = entities["/slcal/camera/image"]
    assert np.array_equal(np.frombuffer(bytes(image["Image:buffer"][0]), np.uint8), scene.photo().ravel())


def test_sigma_colours_points(tmp_path):
    entities, _ = logged(tmp_path, cloud=cloud(), color="sigma", path="world/scan", radius_mm=0.4)
    points = entities["/world/scan/points"]
    brightness = rgb(points["Points3D:colors"]) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(brightness) >= -3).all() and brightness[-1] > brightness[0] + 80
    assert np.allclose(points["Points3D:radii"], 0.4)


def test_a_cloud_on_the_sheet_is_brought_before_the_camera(tmp_path):
    entities, _ = logged(tmp_path, scene.rig(), cloud("plane"))
    positions = np.array(entities["/slcal/points"]["Points3D:positions"])
    assert np.abs(positions - cloud().points).max() < 1e-3


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("grey", [False, True])
def test_images_of_all_kinds_are_logged(tmp_path, dtype, grey):
    photo = scene.photo(dtype)[..., 0] if grey else scene.photo(dtype)
    entities, _ = logged(tmp_path, scene.rig(projector=False), image=photo)
    buffer = bytes(entities["/slcal/camera/image"]["Image:buffer"][0])
    assert np.array_equal(np.frombuffer(buffer, dtype), photo.ravel())
    assert "/slcal/projector" not in entities


def test_the_active_recording_is_used(tmp_path):
    with pytest.raises(RuntimeError, match=r"rerun\.init"):
        slcal.viz.to_rerun(scene.rig())
    rr.init("test")
    try:
        rr.save(tmp_path / "x.rrd")
        slcal.viz.to_rerun(scene.rig(), cloud())
        rr.disconnect()
    finally:
        rr.set_global_data_recording(None)
    assert "/slcal/points" in read(tmp_path / "x.rrd")[0]


def test_invalid_arguments_are_refused():
    recording = rr.RecordingStream("test")
    for kw, kind, said in [
        ({}, slcal.Error, "nothing to log"),
        ({"rig": scene.rig().camera}, TypeError, "slcal.Rig"),
        ({"rig": scene.rig(), "image": scene.photo()[:400]}, slcal.Error, "1280 x 400"),
        ({"cloud": slcal.PointCloud(np.empty((0, 3)))}, slcal.Error, "at least one point"),
        ({"cloud": cloud(), "color": "hue"}, slcal.Error, "hue"),
    ]:
        with pytest.raises(kind, match=said):
            slcal.viz.to_rerun(**kw, recording=recording)
