"""Sequences of Gray code and shifted sinusoids: against the truth of simulated scenes, and against a decoder of plain NumPy."""

from __future__ import annotations

import io
import pickle
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import slcal
from slcal import reports, simulate

PERIOD, STEPS = 16, 8
PHASE = slcal.SequencePattern((512, 384), "phase", period=PERIOD, steps=STEPS)
BOTH = slcal.SequencePattern((256, 192), "gray", "both")
CAMERA: Any = {"camera": (320, 240), "focal": 375.0}
#: The projector of `CAMERA` for 512 x 384 px.
PROJECTOR: Any = {"projector": (512, 384), "projector_focal": 850.0}


def stack_of(scene: simulate.Scene) -> NDArray[np.uint8]:
    return np.stack([np.asarray(frame, np.uint8) for frame in scene.frames])


@pytest.fixture(scope="module")
def ball() -> simulate.Scene:
    # In perfect focus, columns follow the squares of the projector's pixels, which σ does not contain.
    return simulate.scene("sphere", PHASE, noise=2, projector_blur=0.5, **CAMERA, **PROJECTOR)


@pytest.fixture(scope="module")
def frames(ball: simulate.Scene) -> NDArray[np.uint8]:
    return stack_of(ball)


@pytest.fixture(scope="module")
def dense(ball: simulate.Scene, frames: NDArray[np.uint8]) -> slcal.DenseMatches:
    return slcal.decode(frames, PHASE)


def on_one_surface(scene: simulate.Scene) -> NDArray[np.bool_]:
    """Pixels that are more than two pixels from those of another surface, and from shadow."""
    kind = np.where(np.isfinite(scene.column), scene.surface, 255)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(kind, 2, mode="edge"), (5, 5))
    return np.asarray((around == kind[..., None, None]).all(axis=(2, 3)))


def decoded_by_numpy(frames: NDArray[np.uint8], pattern: slcal.SequencePattern) -> NDArray[np.float64]:
    """Columns from the bits of the Gray code and the phase, whose period is the nearest one to the code."""
    grey = frames.astype(float).mean(axis=3) if frames.ndim == 4 else frames.astype(float)
    bits: dict[int, dict[bool, int]] = {}
    steps: dict[int, int] = {}
    for i, frame in enumerate(pattern.frames):
        if frame["is"] == "bit":
            bits.setdefault(frame["bit"], {})[frame["inverted"]] = i
        elif frame["is"] == "sinusoid":
            steps[frame["step"]] = i
    binary = np.zeros(grey.shape[1:], int)
    above = np.zeros(grey.shape[1:], int)
    for bit in sorted(bits, reverse=True):
        above = above ^ (grey[bits[bit][False]] > grey[bits[bit][True]])
        binary = 2 * binary + above
    cell = 2 ** int(np.ceil(np.log2(pattern.projector[0]))) / 2 ** len(bits)
    code = (binary + 0.5) * cell - 0.5
    turn = sum(grey[i] * np.exp(2j * np.pi * k / STEPS) for k, i in steps.items())
    # Where the sinusoid's maximum is depends on its definition alone: read off the pictures themselves.
    drawn = sum(pattern.image(i)[0].astype(float) * np.exp(2j * np.pi * k / STEPS) for k, i in steps.items())
    rising = np.angle(drawn[1] / drawn[0]) > 0
    phase = np.angle(turn / drawn[0]) * (1 if rising else -1) * PERIOD / (2 * np.pi)
    return np.asarray(phase + PERIOD * np.round((code - phase) / PERIOD), float)


def test_columns_are_those_of_the_scene(ball: simulate.Scene, dense: slcal.DenseMatches) -> None:
    off = np.abs(dense.column - ball.column)
    known = np.isfinite(off)
    assert known.sum() > 0.95 * np.isfinite(ball.column).sum()
    assert np.median(off[known]) <= 0.03
    # A pixel on the outline of the sphere sees it and the wall, whose columns differ by several periods.
    assert off[known & on_one_surface(ball)].max() < PERIOD / 2
    # The stated σ is that of the errors: robustly, since pixels at outlines see two surfaces.
    score = np.median(off[known] / dense.sigma_column[known]) / 0.6745
    assert 0.8 < score < 1.25, score
    assert dense.row is None and dense.sigma_row is None


def test_columns_are_those_of_a_decoder_in_numpy(frames: NDArray[np.uint8], dense: slcal.DenseMatches) -> None:
    there = decoded_by_numpy(frames, PHASE)
    off = np.abs(dense.column - there)
    off = np.minimum(off, np.abs(off - PERIOD))  # Periods are told apart by other means here.
    known = np.isfinite(off)
    assert known.sum() > 20_000
    assert np.median(off[known]) < 0.01
    assert (off[known] < 0.2).mean() > 0.99


def test_matches_are_arrays_that_cannot_be_written_to(dense: slcal.DenseMatches) -> None:
    shape = (240, 320)
    for plane in (dense.column, dense.sigma_column, dense.confidence):
        assert (plane.shape, plane.dtype) == (shape, np.float32)
        assert not plane.flags.writeable
        assert not plane.flags.owndata
        with pytest.raises(ValueError, match="WRITEABLE"):
            plane.flags.writeable = True
    assert dense.color.shape == (*shape, 3)
    assert np.shares_memory(dense.column, dense.column)
    assert len(dense) == np.isfinite(dense.column).sum()
    assert (np.isfinite(dense.sigma_column) == np.isfinite(dense.column)).all()
    kept = slcal.DenseMatches([[1.0, 2.0]]).column
    assert kept.tolist() == [[1.0, 2.0]]  # After the matches themselves are gone.


def test_the_report_counts(dense: slcal.DenseMatches) -> None:
    report = dense.report
    assert isinstance(report, reports.SequenceDecodeReport)
    assert (report.frames, report.pixels, report.decoded) == (len(PHASE), 320 * 240, len(dense))
    assert report.lit >= report.decoded
    # Two levels of 255 in every channel; the grey level is a sum over them.
    assert 0.5 / 255 < report.noise < 2.5 / 255
    assert report.median_sigma_column_px == pytest.approx(np.nanmedian(dense.sigma_column), rel=0.1)
    assert report.median_sigma_row_px is None
    assert reports.SequenceDecodeReport._of(report.to_dict()) == report


def test_frames_come_in_any_form(frames: NDArray[np.uint8], dense: slcal.DenseMatches, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image", reason="Pillow is not installed")
    paths = []
    for i, frame in enumerate(frames):
        paths.append(tmp_path / f"{i:03}.png")
        image.fromarray(frame).save(paths[-1])
    wide = np.zeros((*frames.shape[:2], 330, 3), np.uint8)
    wide[:, :, 5:325] = frames
    forms: list[Any] = [
        list(frames),
        tuple(frames),
        (frame for frame in frames),
        np.ascontiguousarray(frames[..., ::-1])[..., ::-1],
        wide[:, :, 5:325],
        paths,
        map(str, paths),
        [*paths[:3], *frames[3:]],
    ]
    for form in forms:
        assert slcal.decode(form, PHASE) == dense


def test_frames_of_a_scene_and_grey_frames_of_16_bit(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    assert slcal.decode(ball.frames, PHASE) == slcal.decode(frames, PHASE)
    grey = frames[..., 1]
    shallow, deep = slcal.decode(grey, PHASE), slcal.decode(grey.astype(np.uint16) * 257, PHASE)
    both = np.isfinite(shallow.column) & np.isfinite(deep.column)
    assert both.sum() > 0.98 * max(len(shallow), len(deep))
    assert np.abs(shallow.column - deep.column)[both].max() < 0.05


def test_an_iterator_is_taken_one_by_one(frames: NDArray[np.uint8]) -> None:
    alive: list[int] = []

    def one_by_one() -> Iterator[NDArray[np.uint8]]:
        for i in range(len(frames)):
            alive.append(i)
            yield frames[i].copy()

    assert len(slcal.decode(one_by_one(), PHASE)) > 0
    assert alive == list(range(len(frames)))

    def broken() -> Iterator[NDArray[np.uint8]]:
        yield frames[0]
        raise RuntimeError("the camera was unplugged")

    with pytest.raises(RuntimeError, match="unplugged"):
        slcal.decode(broken(), PHASE)


def test_columns_and_rows_of_gray_code() -> None:
    scene = simulate.scene("plane", BOTH, noise=1, **CAMERA, projector=(256, 192), projector_focal=425.0)
    dense = slcal.decode(scene.frames, BOTH)
    for found, true, sigma in [
        (dense.column, scene.column, dense.sigma_column),
        (dense.row, scene.row, dense.sigma_row),
    ]:
        off = np.abs(found - true)
        known = np.isfinite(off)
        assert known.sum() > 0.9 * np.isfinite(true).sum()
        assert np.median(off[known]) < 0.3
        assert np.isfinite(sigma[known]).all()
    assert "columns" in repr(dense) and "rows" in repr(dense)
    assert pickle.loads(pickle.dumps(dense)) == dense


def test_clouds_have_points_of_the_surface_and_normals(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    cloud = ball.rig.reconstruct(frames, PHASE, mesh=True)
    u, v = cloud.pixels.astype(int).T
    off = cloud.points[:, 2] - ball.depth[v, u]
    assert np.median(np.abs(off)) < 0.3
    assert len(cloud) > 0.9 * np.isfinite(ball.column).sum()
    assert len(cloud.triangles) > len(cloud)
    assert cloud.report.sequence.frames == len(PHASE)
    assert cloud.report.decode is None
    normals = cloud.normals
    assert (normals.shape, normals.dtype) == ((len(cloud), 3), np.float32)
    length = np.linalg.norm(normals, axis=1)
    assert (np.isclose(length, 1, atol=1e-5) | (length == 0)).all()
    # Those of the sphere point away from its centre.
    fit = slcal.evaluate(cloud, "sphere")
    out = cloud.points - fit.centre_mm
    on = (np.abs(np.linalg.norm(out, axis=1) - fit.radius_mm) < 2) & (length > 0)
    on &= -out[:, 2] > 0.5 * fit.radius_mm  # Where the surface faces the camera.
    cosines = (normals * out).sum(axis=1)[on] / np.linalg.norm(out[on], axis=1)
    assert on.sum() > 1000
    assert np.median(cosines) > 0.95


def test_a_reconstructor_takes_scan_after_scan(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    options: Any = {"mesh": True, "near": 700.0, "far": 1500.0}
    cloud = ball.rig.reconstruct(frames, PHASE, **options)
    scanner = slcal.Reconstructor(ball.rig, PHASE, **options)
    assert repr(scanner) == f"Reconstructor(camera 320x240, projector 512x384, {len(PHASE)} frames)"
    with pytest.raises(slcal.Error, match=f"expected {len(PHASE)}, as the pattern has, found 3"):
        scanner.reconstruct(iter(frames[:3]))
    # A scan that failed leaves nothing behind.
    assert scanner.reconstruct(frames) == cloud
    assert scanner.reconstruct(frame for frame in frames) == cloud

    def within() -> Iterator[NDArray[np.uint8]]:
        assert scanner.reconstruct(frames) == cloud
        yield from frames

    assert scanner.reconstruct(within()) == cloud
    made: list[slcal.PointCloud] = []
    threads = [threading.Thread(target=lambda: made.append(scanner.reconstruct(iter(frames)))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 3
    assert all(m == cloud for m in made)


def test_a_reconstructor_refuses_what_is_of_stripes(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    anything: Any = slcal.Reconstructor
    for option in ({"gamma": "srgb"}, {"min_confidence": 0.4}):
        (name,) = option
        with pytest.raises(slcal.Error, match=f"{name}: expected none with a SequencePattern"):
            anything(ball.rig, PHASE, **option)
    scanner = slcal.Reconstructor(ball.rig, PHASE)
    for name in ("black", "white"):
        taken: Any = {name: frames[0]}
        with pytest.raises(slcal.Error, match=f"{name}: expected none with a SequencePattern"):
            scanner.reconstruct(frames, **taken)
    with pytest.raises(slcal.Error, match="512x384"):
        slcal.Reconstructor(ball.rig, slcal.SequencePattern((256, 192), "phase"))


def test_matches_triangulate_as_frames_reconstruct(
    ball: simulate.Scene, frames: NDArray[np.uint8], dense: slcal.DenseMatches
) -> None:
    options: Any = {"mesh": True, "cull": 50.0, "near": 700.0, "far": 1500.0}
    cloud = ball.rig.reconstruct(frames, PHASE, **options)
    assert ball.rig.triangulate(dense, **options) == cloud
    assert ball.rig.triangulate(slcal.decode(frames, PHASE, rig=ball.rig), **options) == cloud
    listed = ball.rig.triangulate(dense.to_matches())
    assert len(dense.to_matches()) == len(dense)
    assert len(listed) == len(ball.rig.triangulate(dense))
    for name, value in [("columns", [1.0]), ("sigma_px", 0.1)]:
        with pytest.raises(slcal.Error, match=f"{name}: expected DenseMatches alone"):
            ball.rig.triangulate(dense, **{name: value})


def test_mirrored_pictures() -> None:
    options: Any = {"noise": 0.5, **CAMERA, **PROJECTOR}
    scene = simulate.scene("plane", PHASE, mirror=True, **options)
    assert scene.rig.mirrored
    off = np.abs(slcal.decode(scene.frames, PHASE, rig=scene.rig).column - scene.column)
    assert np.nanmedian(off) < 0.03
    same = slcal.decode(scene.frames, PHASE, mirror=True)
    assert same == slcal.decode(scene.frames, PHASE, rig=scene.rig)
    cloud = scene.rig.reconstruct(scene.frames, PHASE)
    u, v = cloud.pixels.astype(int).T
    assert np.median(np.abs(cloud.points[:, 2] - scene.depth[v, u])) < 0.3


def test_normals_of_clouds_travel(tmp_path: Path) -> None:
    normals = np.array([[0, 0, -1], [0.6, 0, -0.8], [0, 0, 0]], np.float32)
    cloud = slcal.PointCloud([[0, 0, 1000], [3, 4, 1000], [5, 5, 1000]], normals=normals)
    assert (cloud.normals == normals).all()
    assert (cloud[1:].normals == normals[1:]).all()
    assert pickle.loads(pickle.dumps(cloud)) == cloud
    cloud.save(tmp_path / "cloud.ply")
    assert (slcal.PointCloud.load(tmp_path / "cloud.ply").normals == normals).all()
    bare = slcal.PointCloud(cloud.points)
    assert bare.normals is None
    assert bare != cloud
    assert b"nx" not in bare.to_bytes("ply")
    with pytest.raises(slcal.Error, match="normals: expected 3 rows"):
        slcal.PointCloud(cloud.points, normals=normals[:2])


def test_matches_are_values_and_files(dense: slcal.DenseMatches, tmp_path: Path) -> None:
    again = pickle.loads(pickle.dumps(dense))
    assert again == dense
    assert again.report == dense.report
    assert dense != slcal.DenseMatches(dense.column)
    assert dense != 3
    dense.save(tmp_path / "matches.npz")
    arrays = np.load(tmp_path / "matches.npz")
    known = np.isfinite(dense.column)
    assert (arrays["projector_column"] == dense.column[known]).all()
    assert (arrays["v"] == np.nonzero(known)[0]).all()
    read = slcal.DenseMatches.load(tmp_path / "matches.npz")
    assert slcal.DenseMatches.load(io.BytesIO((tmp_path / "matches.npz").read_bytes())) == read
    assert np.array_equal(read.column, dense.column, equal_nan=True)
    assert read.report is None
    (tmp_path / "matches.npz").write_bytes(b"nonsense")
    with pytest.raises(slcal.FormatError, match="matches.npz"):
        slcal.DenseMatches.load(tmp_path / "matches.npz")


def test_matches_of_other_decoders() -> None:
    column = np.array([[10.0, np.nan], [30.0, 40.0]])
    own = slcal.DenseMatches(column, column / 2, sigma_column=0.05, confidence=[[1, 1], [0.5, 1]])
    assert len(own) == 3
    assert own.sigma_row[0, 0] == np.float32(0.1)
    assert np.isnan(own.sigma_column[0, 1])
    assert own.color is None
    assert own.to_matches().columns.tolist() == [10, 30, 40]
    assert own.to_matches().pixels.tolist() == [[0, 0], [0, 1], [1, 1]]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "column: expected the projector column or row"),
        ({"column": [1.0, 2.0]}, r"column: expected shape \(H, W\)"),
        ({"column": [[1.0, np.inf]]}, "column: expected finite numbers"),
        ({"column": [[1.0, 2.0]], "row": [[1.0]]}, r"row: expected shape \(1, 2\)"),
        ({"column": [[1.0]], "sigma_column": -1.0}, "sigma_column: expected numbers above zero"),
        ({"column": [[1.0]], "sigma_row": 1.0}, "sigma_row: expected none without row"),
        ({"column": [[1.0]], "confidence": 2.0}, "confidence: expected numbers from 0 to 1"),
        ({"column": [[1.0]], "color": np.zeros((2, 1, 3), np.uint8)}, r"color: expected an array .*\(1, 1, 3\)"),
    ],
)
def test_what_is_no_dense_match(given: dict[str, Any], words: str) -> None:
    with pytest.raises(slcal.Error, match=words):
        slcal.DenseMatches(**given)


def test_what_is_no_sequence_of_frames(frames: NDArray[np.uint8], tmp_path: Path) -> None:
    n = len(PHASE)
    wrong: list[tuple[Any, str]] = [
        (frames[:-1], rf"frames: expected {n}, as the pattern has, found {n - 1} in an array of shape"),
        (list(frames) * 2, rf"frames: expected {n}, as the pattern has, found {2 * n}"),
        (iter(frames[:3]), rf"frames: expected {n}, as the pattern has, found 3"),
        (iter([*frames, frames[0]]), rf"frames: expected {n}, as the pattern has, found more"),
        (frames[0, :, :, 0], "frames: expected the frames of the sequence"),
        ([*frames[:-1], frames[-1, :100]], r"320x100"),
    ]
    for given, words in wrong:
        with pytest.raises(slcal.Error, match=words):
            slcal.decode(given, PHASE)
    refused: list[tuple[Any, str]] = [
        (tmp_path, "frames: expected the frames of the sequence.*found a path"),
        (None, "frames: expected the frames of the sequence.*found None"),
        (3, "frames: expected the frames of the sequence.*found an int"),
        (frames.astype(float), r"frames\[0\]: .*float64"),
        ([None] * n, r"frames\[\d+\]: .*None"),
    ]
    for given, words in refused:
        with pytest.raises(TypeError, match=words):
            slcal.decode(given, PHASE)
    with pytest.raises(FileNotFoundError):
        slcal.decode([tmp_path / f"{i}.png" for i in range(n)], PHASE)


def test_options_of_stripes_do_not_go_with_a_sequence(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    options: list[dict[str, Any]] = [
        {"black": frames[1]},
        {"white": frames[0]},
        {"gamma": 2.2},
        {"min_confidence": 0.5},
    ]
    for option in options:
        (name,) = option
        for call in (slcal.decode, ball.rig.reconstruct):
            anything: Any = call
            with pytest.raises(slcal.Error, match=f"{name}: expected none with a SequencePattern"):
                anything(frames, PHASE, **option)
    with pytest.raises(TypeError, match="a StripePattern or a SequencePattern, found None"):
        slcal.decode(frames, None)  # type: ignore[call-overload]


def test_frames_without_light_and_of_another_rig(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    rng = np.random.default_rng(1)
    dark = rng.normal(20, 1.5, frames.shape[:3]).round().astype(np.uint8)
    for call in (slcal.decode, ball.rig.reconstruct):
        with pytest.raises(slcal.DecodeError, match="projector"):
            call(dark, PHASE)
    with pytest.raises(slcal.Error, match="320x240"):
        ball.rig.reconstruct(frames[:, :200], PHASE)
    with pytest.raises(slcal.Error, match="512x384"):
        ball.rig.reconstruct(frames, slcal.SequencePattern((256, 192), "phase"))


def test_frames_that_do_not_fit_are_named(ball: simulate.Scene, frames: NDArray[np.uint8]) -> None:
    n = len(PHASE)
    first_bit, last_bit = 2, n - STEPS - 1
    twice = frames.copy()
    twice[5] = frames[4]
    brighter = frames.copy()
    # A bit of few stripes, exposed for longer; clipping would hide by how much.
    brighter[first_bit] = np.minimum(frames[first_bit] * 1.25, 255).round()
    bits = list(range(first_bit, last_bit + 1))
    inverses_first = [0, 1, *(i ^ 1 for i in bits), *range(last_bit + 1, n)]
    pictures = np.stack([PHASE.image(i) for i in range(n)])
    wrong: list[tuple[NDArray[np.uint8], str]] = [
        (twice, r"frames 4 .* and 5 .* with the same pixels"),
        (brighter, rf"frame {first_bit} \(bit .* exposure"),
        (frames[[1, 0, *range(2, n)]], "order of the pattern.*white is darker than black"),
        (frames[inverses_first], "order of the pattern.*after its inverse"),
        (pictures, "parallax"),
    ]
    for given, words in wrong:
        with pytest.raises(slcal.Error, match=words):
            slcal.decode(given, PHASE)
    with pytest.raises(slcal.Error, match="8 bit|16 bit"):
        slcal.decode([*frames[:-1], frames[-1].astype(np.uint16) * 257], PHASE)


def test_what_happened_to_the_scene_is_told(frames: NDArray[np.uint8], dense: slcal.DenseMatches) -> None:
    assert not dense.report.warnings
    moved = frames.copy()
    # After half of the bits something dark stands before a part of the scene.
    moved[8:, 90:150, 120:200] = 9
    (warning,) = slcal.decode(moved, PHASE).report.warnings
    assert warning.code == "moved"
    overexposed = np.minimum(frames.astype(int) * 2, 255).astype(np.uint8)
    assert "saturated" in [w.code for w in slcal.decode(overexposed, PHASE).report.warnings]


def test_threads_decode_at_the_same_time(frames: NDArray[np.uint8], dense: slcal.DenseMatches) -> None:
    made: list[slcal.DenseMatches] = []
    threads = [threading.Thread(target=lambda: made.append(slcal.decode(frames, PHASE))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 4
    assert all(m == dense for m in made)
