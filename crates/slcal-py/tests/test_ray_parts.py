"""What slcal.ray is made of, without a cluster."""

import io
import subprocess
import sys
import zipfile

import numpy as np
import pytest

import slcal

pytest.importorskip("ray.data", reason="needs the extra slcal[ray]")
fsspec = pytest.importorskip("fsspec")

from fsspec.implementations.memory import MemoryFileSystem  # noqa: E402
from PIL import Image  # noqa: E402

from slcal.ray import SCHEMA, find_photos  # noqa: E402
from slcal.ray import _store as stores  # noqa: E402
from slcal.ray._frames import Frame, find_scans, name_frames, name_of_row  # noqa: E402
from slcal.ray._run import _pattern  # noqa: E402
from slcal.ray._scan import Scan, identity_of, in_order  # noqa: E402
from slcal.ray._store import Store  # noqa: E402
from slcal.ray._table import Row, as_table, parquet  # noqa: E402
from slcal.ray._work import Photo  # noqa: E402


def python(script):
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)


def test_importing_slcal_imports_no_ray():
    said = python("import sys, slcal; print([m for m in ('ray', 'pyarrow', 'fsspec', 'slcal.ray') if m in sys.modules])")
    assert said.stdout == "[]\n", said.stderr


@pytest.mark.parametrize("module", ["ray", "pyarrow", "fsspec"])
def test_a_missing_extra_says_how_to_install_it(module):
    said = python(f"import sys; sys.modules[{module!r}] = None; import slcal.ray")
    assert "ImportError" in said.stderr and "pip install 'ray[data]'" in said.stderr


# Names


def test_frames_of_one_folder_are_called_after_their_files():
    assert name_frames(["/p/a.png", "/p/b.c.JPG"], None) == [Frame("a", "/p/a.png"), Frame("b.c", "/p/b.c.JPG")]
    assert name_frames(["/p/a.png"], None) == [Frame("a", "/p/a.png")]


def test_equal_names_in_different_folders_stay_apart():
    names = [f.name for f in name_frames(["/p/x/1.png", "/p/y/1.png", "/p/y/z/1.png"], None)]
    assert names == ["x/1", "y/1", "y/z/1"]
    across = name_frames(["s3://one/p/1.png", "gs://one/p/1.png", "/one/p/1.png"], None)
    assert [f.name for f in across] == ["s3/one/p/1", "gs/one/p/1", "one/p/1"]


def test_a_root_makes_names_independent_of_the_other_frames():
    assert name_frames(["/p/x/1.png"], "/p")[0].name == "x/1"
    assert name_frames(["https://h/p/1.png?token=a/b"], "https://h")[0].name == "p/1"
    with pytest.raises(slcal.Error, match="root"):
        name_frames(["/q/1.png"], "/p")


def test_relative_paths_mean_the_same_to_every_process(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert name_frames(["a.png"], None) == [Frame("a", str(tmp_path / "a.png"))]


@pytest.mark.parametrize("paths", [["/p/a.png", "/p/a.jpg"], ["/p/a.png", "/p/a.png"], ["/p/a.png", "/p/A.png"]])
def test_frames_that_would_overwrite_each_other_are_refused(paths):
    with pytest.raises(slcal.Error, match="both become"):
        name_frames(paths, None)


def test_a_mapping_names_frames():
    assert name_frames({"x/1": "/p/a.png", "2": "/p/a.jpg"}, None) == [Frame("x/1", "/p/a.png"), Frame("2", "/p/a.jpg")]
    for name in ["", "/a", "../a", "a//b", ".a", "a/.slcal/b", "a\\b"]:
        with pytest.raises(slcal.Error, match="frame name"):
            name_frames({name: "/p/a.png"}, None)


def test_nothing_to_do_is_an_error():
    for nothing in ([], {}):
        with pytest.raises(slcal.Error, match="at least one"):
            name_frames(nothing, None)


def test_frames_of_a_dataset_are_told_apart_by_their_path_alone():
    one, other = name_of_row("/p/x/1.png", None), name_of_row("/p/y/1.png", None)
    assert one.startswith("1-") and other.startswith("1-") and one != other
    assert one == name_of_row("/p/x/1.png", None)
    assert name_of_row("bucket/p/x/1.png", "bucket/p") == "x/1"


# Sources


def test_photographs_are_found_in_folders_patterns_and_archives(tmp_path):
    for name in ["b.png", "a.JPG", "c.txt", "._a.png", "inner/d.tif"]:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    assert find_photos(tmp_path) == [str(tmp_path / "a.JPG"), str(tmp_path / "b.png")]
    assert find_photos(tmp_path / "**/*.tif") == [str(tmp_path / "inner/d.tif")]
    assert find_photos(tmp_path / "b.png") == [str(tmp_path / "b.png")]
    assert find_photos(f"file://{tmp_path}/*.png") == [f"file://{tmp_path}/b.png"]
    with pytest.raises(slcal.Error, match="found none"):
        find_photos(tmp_path / "*.tif")
    archive = tmp_path / "photos.zip"
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("x/1.png", b"")
    assert find_photos(f"zip://**/*.png::{archive}") == [f"zip://x/1.png::{archive}"]


def test_scans_are_folders(tmp_path):
    for name in ["two.1/a.png", "two.2/a.png", ".hidden/a.png", "file.png"]:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    found = find_scans(tmp_path / "*")
    assert found == [str(tmp_path / "two.1"), str(tmp_path / "two.2")]
    # A folder has no extension to leave out.
    assert [frame.name for frame in name_frames(found, None, folders=True)] == ["two.1", "two.2"]
    assert name_of_row(found[0], str(tmp_path), folders=True) == "two.1"
    assert find_scans(tmp_path / "two.1") == [str(tmp_path / "two.1")]
    for place in (tmp_path / "*.png", tmp_path / "file.png", tmp_path / "none"):
        with pytest.raises(slcal.Error, match="expected folders"):
            find_scans(place)


def test_the_photographs_of_a_scan_have_the_order_of_the_pattern():
    pattern = slcal.SequencePattern((64, 48), bits=1)  # White, black, a bit, its inverse.
    named = [f"/s/frame_00{i}.TIF" for i in range(4)]
    assert in_order("/s", [*named[::-1], "/s/other.png"], pattern) == named
    with pytest.raises(slcal.Error, match=r"/s: frames: expected frame_003\.png .* found none"):
        in_order("/s", named[:3], pattern)
    with pytest.raises(slcal.Error, match=r"frame 1 \(black\), found frame_001.TIF and frame_001.png"):
        in_order("/s", [*named, "/s/frame_001.png"], pattern)
    numbered = ["/s/2.png", "/s/10.png", "/s/1.png", "/s/b1.png"]
    assert in_order("/s", numbered, pattern) == ["/s/1.png", "/s/2.png", "/s/10.png", "/s/b1.png"]
    with pytest.raises(slcal.Error, match="/s: frames: expected the 4 frames.*found 3"):
        in_order("/s", numbered[:3], pattern)


def test_a_scan_reads_what_it_is_asked_for(tmp_path):
    pattern = slcal.SequencePattern((64, 48), bits=1)
    for i in range(4):
        Image.fromarray(np.full((4, 6), i, np.uint8)).save(tmp_path / f"frame_00{i}.png")
    scan = Scan(str(tmp_path), pattern, {})
    assert [frame[0, 0] for frame in scan] == [0, 1, 2, 3] and len(scan) == 4
    before = identity_of(str(tmp_path), {})
    assert before == identity_of(str(tmp_path), {})
    (tmp_path / "frame_002.png").write_bytes(b"another")
    assert before != identity_of(str(tmp_path), {})
    with pytest.raises(slcal.FormatError, match="frame_002.png"):
        scan[2]


def test_patterns_of_jobs(tmp_path):
    for pattern in (slcal.StripePattern((640, 480)), slcal.SequencePattern((640, 480))):
        pattern.save(tmp_path / "pattern.json")
        assert _pattern(tmp_path / "pattern.json") == pattern == _pattern(pattern)
    slcal.CheckerPattern((640, 480)).save(tmp_path / "pattern.json")
    with pytest.raises(slcal.Error, match="a checkerboard"):
        _pattern(tmp_path / "pattern.json")


def test_photographs_are_read_as_the_command_reads_them(tmp_path):
    """Upright, and from any store."""
    picture = np.random.default_rng(1).integers(0, 255, (12, 20, 3), np.uint8)
    exif = Image.Exif()
    exif[0x0112] = 6  # To be turned by 90 degrees clockwise.
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "png", exif=exif)
    with zipfile.ZipFile(tmp_path / "photos.zip", "w") as archive:
        archive.writestr("1.png", file.getvalue())
    for photo in [Photo(f"zip://1.png::{tmp_path}/photos.zip", None), Photo("1.png", file.getvalue())]:
        assert (photo.image({}) == np.rot90(picture, -1)).all()
    with pytest.raises(slcal.FormatError, match="x/1.png"):
        Photo("x/1.png", b"no picture").image({})
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "tiff")  # As camera raw files are, of which it would be the thumbnail.
    with pytest.raises(slcal.FormatError, match="raw file"):
        Photo("x/1.dng", file.getvalue()).image({})


def test_a_photograph_that_changes_changes_its_identity(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(b"one")
    before = Photo(str(path), None).identity({})
    assert before == Photo(str(path), None).identity({})
    path.write_bytes(b"three")
    assert before != Photo(str(path), None).identity({})
    image = np.zeros((4, 6, 3), np.uint8)
    turned = image.reshape(6, 4, 3)
    wide = image.astype(np.uint16)
    assert len({Photo("a", content).identity({}) for content in (image, turned, wide, b"one", b"two")}) == 5


# Outputs


class Plain(MemoryFileSystem):
    """A store of which nothing is known."""

    protocol = "plain"
    store: dict = {}  # noqa: RUF012
    pseudo_dirs = [""]  # noqa: RUF012


@pytest.fixture(params=["local", "memory", "plain"])
def store(request, tmp_path):
    fsspec.register_implementation("plain", Plain, clobber=True)
    return Store(str(tmp_path / "out") if request.param == "local" else f"{request.param}://{tmp_path.name}/out")


def names(store):
    fs, root = store._place
    return sorted(path.removeprefix(root + "/") for path in fs.find(root))


def test_files_come_and_go(store):
    assert store.size("a/b.ply") is None and store.read("a/b.ply") is None
    store.remove("a/b.ply")
    for content in (b"one", b"three"):
        store.put("a/b.ply", content)
        assert store.size("a/b.ply") == len(content) and store.read("a/b.ply") == content
    assert names(store) == ["a/b.ply"]
    store.remove("a/b.ply")
    assert names(store) == []


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_file_that_is_not_complete_is_not_seen(tmp_path, monkeypatch, step):
    store = Store(str(tmp_path))
    store.put("a.ply", b"old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(stores.os, step, full)
    with pytest.raises(OSError, match="space"):
        store.put("a.ply", b"new")
    assert store.read("a.ply") == b"old" and names(store) == ["a.ply"]


def test_files_of_dead_workers_are_removed(tmp_path):
    store = Store(str(tmp_path))
    store.put("x/a.ply", b"whole")
    (tmp_path / "x" / ".slcal-part-0123").write_bytes(b"ha")
    store.tidy()
    assert names(store) == ["x/a.ply"]


def test_the_table_has_the_same_columns_whatever_the_rows_are():
    import pyarrow.parquet as pq

    failed = Row("a", "/p/a.png")
    failed.fail(OSError("gone"))
    for rows in ([], [failed], [Row("b", "/p/b.png", "b.ply", points=3)], [failed, Row("b", "/p/b.png", points=3)]):
        read = pq.read_table(io.BytesIO(parquet(as_table(rows))))
        assert read.schema.equals(SCHEMA)
        assert read.num_rows == len(rows)
