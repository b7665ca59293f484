"""slcal.ray on a local cluster: bad frames, workers that die, a second run, datasets."""

import json
import logging
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import slcal
from slcal import simulate as simulated
from slcal._slcal import run_command

ray = pytest.importorskip("ray", reason="needs the extra slcal[ray]")
pytest.importorskip("ray.data", reason="needs the extra slcal[ray]")

import pyarrow.parquet as pq  # noqa: E402
from PIL import Image  # noqa: E402

import slcal.ray  # noqa: E402

# Ray Data sets options of its own that it has deprecated.
pytestmark = pytest.mark.filterwarnings(r"ignore:.*is deprecated:DeprecationWarning:ray\.data\.context")

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "examples" / "ray_folder.py"


def simulate(folder, *options):
    command = ["slcal", "-q", "simulate", "scene", "--surface", "sphere", "--camera", "480x360", "--focal", "560"]
    assert run_command([*command, "--out", str(folder), *options]) == 0
    return folder


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return simulate(tmp_path_factory.mktemp("scene"))


@pytest.fixture(scope="module")
def rig(scene):
    return slcal.Rig.load(scene / "rig.json")


@pytest.fixture(scope="module")
def pattern(scene):
    return slcal.StripePattern.load(scene / "pattern.json")


@pytest.fixture(scope="module")
def photos(scene, tmp_path_factory):
    """Ten good photographs, of 8 and of 16 bit, one to be turned upright; one that is none and one that shows nothing."""
    folder = tmp_path_factory.mktemp("photos")
    (folder / "left").mkdir()
    (folder / "right").mkdir()
    photo = (scene / "photo.png").read_bytes()
    for name in ["left/1", "right/1", "a", "b", "c", "stalled", "deadly"]:
        (folder / f"{name}.png").write_bytes(photo)
    for seed in "23":
        simulate(scene / seed, "--bits", "16", "--seed", seed)
        (folder / f"deep{seed}.png").write_bytes((scene / seed / "photo.png").read_bytes())
    upright = Image.open(scene / "photo.png")
    exif = Image.Exif()
    exif[0x0112] = 6  # To be turned by 90 degrees clockwise.
    upright.transpose(Image.Transpose.ROTATE_90).save(folder / "turned.jpg", quality=95, exif=exif)
    Image.fromarray(np.full((360, 480, 3), 9, np.uint8)).save(folder / "dark.png")
    (folder / "broken.png").write_bytes(photo[: len(photo) // 2])
    return folder


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A cluster whose workers, as long as there is no file `mercy`, stop in the middle of writing the cloud of `stalled`,
    the first time, and die of every attempt at `deadly`."""
    folder = tmp_path_factory.mktemp("cluster")

    def prepare_worker():  # Pickled by value, since this file is no module of the workers.
        import os
        import signal
        import time

        from slcal.ray import _store

        put = _store._put_local

        def put_local(part, path, data):
            name = os.path.basename(path)
            if name == "stalled.ply" and not (folder / "stalled").exists():
                with open(part, "wb") as file:
                    file.write(data[: len(data) // 2])
                (folder / "pid").write_text(str(os.getpid()))
                (folder / "pid").rename(folder / "stalled")
                time.sleep(600)
            if name == "deadly.ply" and not (folder / "mercy").exists():
                os.kill(os.getpid(), signal.SIGKILL)
            put(part, path, data)

        _store._put_local = put_local

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_AUTH_MODE", "disabled")
        patch.setenv("RAY_USAGE_STATS_ENABLED", "0")
        patch.setenv("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        ray.init(
            num_cpus=2,
            include_dashboard=False,
            log_to_driver=False,
            logging_level=logging.ERROR,
            object_store_memory=100_000_000,
            runtime_env={"worker_process_setup_hook": prepare_worker},
            _node_ip_address="127.0.0.1",
        )
        try:
            yield folder
        finally:
            ray.shutdown()


def kill_the_stalled(cluster, killed):
    """Ends the process that is in the middle of a file, from outside."""
    for _ in range(600):
        if (cluster / "stalled").exists():
            killed.append(int((cluster / "stalled").read_text()))
            os.kill(killed[0], signal.SIGKILL)
            return
        time.sleep(0.1)


def by_frame(table):
    return {row["frame"]: row for row in table.to_pylist()}


def visible(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file() and ".slcal/" not in str(p))


GOOD = ["a", "b", "c", "deep2", "deep3", "left/1", "right/1", "stalled", "turned"]


def test_a_job_from_its_first_run_to_its_last(cluster, scene, photos, rig, pattern, tmp_path, monkeypatch):
    out = tmp_path / "out"
    # Two tasks with half of the frames each: what was done before a death is not done again, and counts as done.
    monkeypatch.setattr("slcal.ray._run._PIECES_PER_CORE", 1)
    killed = []
    killer = threading.Thread(target=kill_the_stalled, args=(cluster, killed), daemon=True)
    killer.start()
    table = slcal.ray.reconstruct(photos / "**/*.*g", scene / "rig.json", scene / "pattern.json", out)
    killer.join()
    rows = by_frame(table)

    # Every frame has a row, good ones a cloud: the same bytes as on one machine.
    assert sorted(rows) == sorted([*GOOD, "broken", "dark", "deadly"])
    assert visible(out) == sorted([*(f"{name}.ply" for name in GOOD), "results.parquet"])
    assert pq.read_table(out / "results.parquet").equals(table) and table.schema.equals(slcal.ray.SCHEMA)
    for name in GOOD:
        cloud = rig.reconstruct(slcal.read_image(rows[name]["source"]), pattern)
        assert (out / rows[name]["output"]).read_bytes() == cloud.to_bytes("ply")
        report = cloud.report
        figures = [len(cloud), 0, report.decode.crossings, report.decode.decoded, report.triangulate.median_sigma_mm]
        columns = ["points", "triangles", "crossings", "decoded", "median_sigma_mm"]
        assert [rows[name][column] for column in columns] == figures
        assert rows[name]["error_type"] is None and not rows[name]["skipped"] and rows[name]["seconds"] > 0

    assert all(rows[name]["attempts"] == 1 for name in GOOD if name != "stalled")
    # The one whose worker was killed in the middle of writing was done again, by another.
    assert len(killed) == 1
    assert rows["stalled"]["attempts"] == 2 and not rows["stalled"]["worker"].endswith(f":{killed[0]}")
    # Bad ones tell what is wrong.
    assert (rows["broken"]["error_type"], rows["dark"]["error_type"]) == ("FormatError", "DecodeError")
    assert "broken.png" in rows["broken"]["error"]
    assert rows["deadly"]["error_type"] == "RuntimeError" and "died each of the 3 times" in rows["deadly"]["error"]
    assert rows["deadly"]["output"] is None and rows["deadly"]["points"] is None

    # Again: what is finished stays; what failed is tried again, what has changed is made anew.
    (cluster / "mercy").touch()
    (photos / "a.png").write_bytes((photos / "deep2.png").read_bytes())
    before = {name: (out / f"{name}.ply").stat() for name in GOOD}
    again = by_frame(slcal.ray.reconstruct(photos / "**/*.*g", rig, pattern, out))
    for name in GOOD:
        assert again[name]["skipped"] == (name != "a")
        assert ((out / f"{name}.ply").stat() == before[name]) == (name != "a")
        assert name == "a" or again[name] == {**rows[name], "skipped": True}
    assert (out / "a.ply").read_bytes() == (out / "deep2.ply").read_bytes()
    assert again["deadly"]["error"] is None and (out / "deadly.ply").exists()
    assert again["broken"]["error_type"] == "FormatError"

    # Clouds of other options are neither taken for these nor overwritten unasked.
    with pytest.raises(FileExistsError, match=r"another mesh;.*overwrite"):
        slcal.ray.reconstruct([photos / "b.png"], rig, pattern, out, mesh=True)
    meshed = by_frame(slcal.ray.reconstruct([photos / "b.png"], rig, pattern, out, mesh=True, overwrite=True))
    assert not meshed["b"]["skipped"] and meshed["b"]["triangles"] > 0
    assert (out / "b.ply").read_bytes() == rig.reconstruct(
        slcal.read_image(photos / "b.png"), pattern, mesh=True
    ).to_bytes("ply")


def test_datasets(cluster, photos, rig, pattern, tmp_path):
    """Arrays and files of a dataset give the clouds that paths give; a name given twice is told, not overwritten."""
    (cluster / "mercy").touch()
    names = ["left/1", "right/1", "b", "deep2", "broken"]
    files = ray.data.read_binary_files([str(photos / f"{name}.png") for name in names], include_paths=True)
    rows = by_frame(slcal.ray.reconstruct(files, rig, pattern, tmp_path / "files", root=photos))
    assert sorted(rows) == sorted(names) and rows["broken"]["error_type"] == "FormatError"
    for name in names[:-1]:
        cloud = rig.reconstruct(slcal.read_image(photos / f"{name}.png"), pattern)
        assert (tmp_path / "files" / f"{name}.ply").read_bytes() == cloud.to_bytes("ply")

    images = ray.data.read_images([str(photos / f"{name}.png") for name in names[:2]], include_paths=True)
    black = np.zeros((360, 480, 3), np.uint8)
    table = slcal.ray.reconstruct(images, rig, pattern, tmp_path / "images", black=black, workers=1)
    expected = rig.reconstruct(slcal.read_image(photos / "b.png"), pattern, black=black).to_bytes("ply")
    for row in table.to_pylist():
        assert row["frame"].startswith("1-") and (tmp_path / "images" / row["output"]).read_bytes() == expected

    items = [{"path": str(photos / f"{name}.png"), "frame": "same"} for name in names[:2]]
    table = slcal.ray.reconstruct(ray.data.from_items(items), rig, pattern, tmp_path / "same")
    assert sorted(map(str, table["error_type"].to_pylist())) == ["Error", "None"]
    with pytest.raises(slcal.Error, match="'path'"):
        slcal.ray.reconstruct(ray.data.from_items([1]), rig, pattern, tmp_path / "none")


def test_scans_by_sequences(cluster, tmp_path):
    sequence = slcal.SequencePattern((256, 192), "phase")
    sequence.save(tmp_path / "sequence.json")
    options = {"camera": (160, 120), "focal": 190.0, "projector": (256, 192), "projector_focal": 425.0}
    scene = simulated.scene("sphere", sequence, **options)
    scene.rig.save(tmp_path / "rig.json")
    for scan in ("ball.1", "ball.2", "short"):
        (tmp_path / "scans" / scan).mkdir(parents=True)
        for i, frame in enumerate(scene.frames):
            Image.fromarray(frame).save(tmp_path / "scans" / scan / f"frame_{i:03}.png")
    (tmp_path / "scans/short/frame_004.png").unlink()
    out = tmp_path / "out"
    job = tmp_path / "scans/*", tmp_path / "rig.json", tmp_path / "sequence.json", out
    rows = by_frame(slcal.ray.reconstruct(*job, mesh=True))
    cloud = scene.rig.reconstruct(scene.frames, sequence, mesh=True)
    assert sorted(rows) == ["ball.1", "ball.2", "short"]
    for name in ("ball.1", "ball.2"):
        assert (out / f"{name}.ply").read_bytes() == cloud.to_bytes("ply")
        assert (rows[name]["points"], rows[name]["decoded"]) == (len(cloud), cloud.report.sequence.decoded)
        assert rows[name]["slits"] is None
    assert rows["short"]["error_type"] == "Error" and "frame_004.png" in rows["short"]["error"]
    # A folder is done again when one of its photographs has changed.
    (tmp_path / "scans/ball.1/frame_003.png").write_bytes((tmp_path / "scans/ball.2/frame_003.png").read_bytes())
    again = by_frame(slcal.ray.reconstruct(*job, mesh=True))
    assert [again[name]["skipped"] for name in ("ball.1", "ball.2")] == [False, True]
    wrong = slcal.SequencePattern((512, 384))
    with pytest.raises(slcal.Error, match="256x192"):
        slcal.ray.reconstruct(tmp_path / "scans/*", scene.rig, wrong, tmp_path / "wrong")
    for option in ({"gamma": 2.2}, {"min_confidence": 0.1}, {"black": np.zeros((120, 160, 3), np.uint8)}):
        with pytest.raises(slcal.Error, match="expected none with a SequencePattern"):
            slcal.ray.reconstruct(tmp_path / "scans/*", scene.rig, sequence, tmp_path / "wrong", **option)


def test_when_all_frames_fail_the_table_is_of_the_same_kind(cluster, rig, pattern, photos, tmp_path):
    table = slcal.ray.reconstruct([photos / "absent.png", photos / "broken.png"], rig, pattern, tmp_path / "out")
    assert table.schema.equals(slcal.ray.SCHEMA)
    assert table["error_type"].to_pylist() == ["FileNotFoundError", "FormatError"]
    assert visible(tmp_path / "out") == ["results.parquet"]
    # A cloud of unknown origin is left alone.
    (tmp_path / "out" / "b.ply").write_bytes(b"mine")
    table = slcal.ray.reconstruct([photos / "b.png"], rig, pattern, tmp_path / "out")
    assert table["error_type"].to_pylist() == ["FileExistsError"]
    assert (tmp_path / "out" / "b.ply").read_bytes() == b"mine"


def test_the_documentation_runs_as_printed(cluster, scene, tmp_path, monkeypatch):
    """Its first piece of Python; the others want stores of their own."""
    (tmp_path / "scan").mkdir()
    for name in "12":
        (tmp_path / "scan" / f"{name}.png").write_bytes((scene / "photo.png").read_bytes())
    (tmp_path / "rig.json").write_bytes((scene / "rig.json").read_bytes())
    (tmp_path / "stripes.json").write_bytes((scene / "pattern.json").read_bytes())
    page = (ROOT / "docs" / "ray.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(page.split("```python\n")[1].split("```")[0], names)
    assert names["bad"] == [] and visible(tmp_path / "clouds") == ["1.ply", "2.ply", "results.parquet"]
    columns = [name.strip() for line in page.splitlines() if line.startswith("| `") for name in line.split("|")[1].split(",")]
    assert [name.strip("`") for name in columns] == slcal.ray.SCHEMA.names


def test_the_example(cluster, scene, photos, tmp_path):
    """As a program of its own, on the cluster that runs."""
    (cluster / "mercy").touch()
    address = ray.get_runtime_context().gcs_address
    arguments = [photos / "*.png", scene / "rig.json", scene / "pattern.json", tmp_path / "out", "--address", address]
    said = subprocess.run([sys.executable, EXAMPLE, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert said.returncode == 1, said.stderr  # Two photographs are bad.
    assert "broken: FormatError" in said.stdout and "dark: DecodeError" in said.stdout
    table = pq.read_table(tmp_path / "out" / "results.parquet")
    assert f"{table.num_rows - 2} of {table.num_rows} frames" in said.stdout


# Before any work


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"photos": []}, slcal.Error, "at least one"),
        ({"rig": "absent.json"}, FileNotFoundError, "absent.json"),
        ({"pattern": slcal.StripePattern((800, 600))}, slcal.Error, "800"),
        ({"gamma": -1.0}, slcal.Error, "gamma"),
        ({"workers": 0}, slcal.Error, "workers"),
        ({"output": "/dev/null/out"}, OSError, "null"),
    ],
)
def test_what_cannot_work_is_refused_at_once(change, error, message, rig, pattern, tmp_path):
    arguments = {"photos": ["a.png"], "rig": rig, "pattern": pattern, "output": tmp_path / "out", **change}
    with pytest.raises(error, match=message):
        slcal.ray.reconstruct(**arguments)


def test_the_bookkeeping_is_plain(tmp_path, rig, pattern):
    from slcal.ray._job import Job, claim
    from slcal.ray._store import Store

    options = {"gamma": "srgb", "frame": "camera", "mesh": False, "cull": 5, "min_confidence": 0.4}
    job = Job(rig, pattern, options)
    assert job.fingerprint == Job(rig, pattern, {**options, "cull": 5.0}).fingerprint
    others = [{**options, "mesh": True}, {**options, "gamma": 1}]
    images = [{"black": np.zeros((2, 2), np.uint8)}, {"white": np.zeros((2, 2), np.uint8)}]
    jobs = [*(Job(rig, pattern, o) for o in others), *(Job(rig, pattern, options, i) for i in images)]
    assert len({j.fingerprint for j in [job, *jobs]}) == 5
    claim(Store(str(tmp_path)), job, overwrite=False)
    claim(Store(str(tmp_path)), job, overwrite=False)
    assert json.loads((tmp_path / ".slcal/job.json").read_text())["made with"] == job.parts
