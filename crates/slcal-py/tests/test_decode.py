"""Decoding against truth that was rendered or drawn, and what happens to images that are none."""

from __future__ import annotations

import io
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from common import DEMO, RENDERED, REPOSITORY

import slcal
from slcal import simulate

STRIPES = slcal.StripePattern(projector=(1024, 768))
FIXTURE = REPOSITORY / "fixtures/sphere.jpg"


@pytest.fixture(scope="module")
def scene() -> simulate.Scene:
    return simulate.scene("sphere", camera=(640, 480), focal=750)


def objects() -> list[Path]:
    """Photographs of objects under the default stripes, the rendered ones where they are at hand."""
    found = [p for p in RENDERED.glob("*/stripes_*.png") if not p.stem.endswith(("_black", "_white"))]
    return [FIXTURE, DEMO / "head.jpg", DEMO / "board.jpg", *sorted(found)]


def test_every_slit_is_found_where_it_is_drawn() -> None:
    matches = slcal.decode(STRIPES.image(), STRIPES)
    assert len(matches) == 64 * 768
    assert np.abs(matches.pixels[:, 0] - STRIPES.centres_px[matches.slits]).max() < 0.05
    assert (matches.columns == STRIPES.centres_px[matches.slits]).all()
    assert matches.rows is None


def test_matches_are_those_of_the_scene(scene: simulate.Scene) -> None:
    found, true = slcal.decode(scene.photo, scene.pattern), scene.matches
    where = {(s, v): u for s, (u, v) in zip(true.slits, true.pixels, strict=True)}
    off = [u - where[s, v] for s, (u, v) in zip(found.slits, found.pixels, strict=True) if (s, v) in where]
    assert len(off) > 0.95 * len(true)
    assert len(off) > 0.99 * len(found)
    assert np.median(np.abs(off)) < 0.1
    assert found.report is not None
    assert found.report.decoded == len(found)
    assert found.report.lines == "rows"


@pytest.mark.parametrize("name", ["plane_a", "sphere", "step"])
def test_rendered_truth(name: str) -> None:
    folder = RENDERED / "paper_tilted"
    if not folder.exists():
        pytest.skip(f"{folder} is not there")
    truth = np.load(folder / f"truth/stripes_{name}.npz")
    found = slcal.decode(
        slcal.read_image(folder / f"stripes_{name}.png"), slcal.StripePattern.load(folder / "patterns/stripes.json")
    )
    rows = dict(zip(truth["rows"], truth["column"], strict=True))
    off = [
        column - rows[int(v)][round(u)]
        for (u, v), column in zip(found.pixels, found.columns, strict=True)
        if int(v) in rows and np.isfinite(rows[int(v)][round(u)])
    ]
    # The truth is that of the pixel's middle: half a pixel of the camera is half a pixel of the panel or so.
    assert len(off) > 3000
    assert np.mean(np.abs(off) < 1.5) > 0.99


def test_arrays_have_the_shapes_and_types_that_are_promised(scene: simulate.Scene) -> None:
    found = slcal.decode(scene.photo, scene.pattern)
    n = len(found)
    expected = {
        "pixels": ((n, 2), np.float64), "columns": ((n,), np.float64), "slits": ((n,), np.int32),
        "confidence": ((n,), np.float64), "sigma_px": ((n,), np.float64), "colors": ((n, 3), np.uint8),
    }  # fmt: skip
    for name, (shape, dtype) in expected.items():
        array = getattr(found, name)
        assert array.shape == shape, name
        assert array.dtype == dtype, name
        array[...] = 0
        assert (getattr(found, name) != 0).any(), "a copy: what is done to it changes nothing"
    u, v = found.pixels.round().astype(int).T
    assert np.abs(found.colors.astype(int) - scene.photo[v, u]).max() <= 1


def test_every_layout_of_the_same_picture_gives_the_same(scene: simulate.Scene) -> None:
    rgb = scene.photo
    expected = slcal.decode(rgb, scene.pattern)
    bgr = np.ascontiguousarray(rgb[..., ::-1])
    wide = np.zeros((480, 700, 3), np.uint8)
    wide[:, 20:660] = rgb
    read_only = rgb.copy()
    read_only.setflags(write=False)
    for same in (bgr[..., ::-1], wide[:, 20:660], np.asfortranarray(rgb), rgb[::-1].copy()[::-1], read_only):
        assert slcal.decode(same, scene.pattern) == expected
    words = rgb.astype(np.uint16) * 257
    assert np.array_equal(slcal.decode(words, scene.pattern).slits, expected.slits)


def test_black_and_white_frames_are_used(scene: simulate.Scene) -> None:
    plain = slcal.decode(scene.photo, scene.pattern)
    both = slcal.decode(scene.photo, scene.pattern, black=scene.black, white=scene.white)
    assert both != plain
    assert len(both) > 0.95 * len(plain)
    with pytest.raises(slcal.Error, match="480"):
        slcal.decode(scene.photo, scene.pattern, black=scene.black[:100])
    with pytest.raises(TypeError, match="black"):
        slcal.decode(scene.photo, scene.pattern, black=scene.black.astype(float))


@pytest.mark.parametrize("photo", objects(), ids=lambda p: f"{p.parent.name}-{p.stem}")
def test_the_error_names_bgr_order(photo: Path) -> None:
    image = slcal.read_image(photo)
    slcal.decode(image, STRIPES)
    swapped = np.ascontiguousarray(image[..., ::-1])
    with pytest.raises(slcal.DecodeError, match="red and blue") as caught:
        slcal.decode(swapped, STRIPES)
    assert "image[..., ::-1]" in str(caught.value)
    assert "COLOR_BGR2RGB" in (caught.value.advice or "")


@pytest.mark.parametrize("photo", [FIXTURE, DEMO / "head.jpg"], ids=lambda p: p.stem)
def test_reconstruction_names_bgr_order_too(photo: Path) -> None:
    swapped = np.ascontiguousarray(slcal.read_image(photo)[..., ::-1])
    rig = slcal.Rig.load(DEMO / "truth_rig.json")
    with pytest.raises(slcal.DecodeError, match="red and blue"):
        rig.reconstruct(swapped, STRIPES)
    with pytest.raises(slcal.DecodeError, match="red and blue"):
        slcal.Reconstructor(rig, STRIPES).reconstruct(swapped)


def test_bgr_order_is_named_for_other_patterns() -> None:
    for hues, order in [(2, 6), (3, 4), (5, 3), (6, 2)]:
        drawn = slcal.StripePattern((1024, 768), hues, order, 30)
        image = drawn.image()
        assert len(slcal.decode(image, drawn)) == 30 * 768
        with pytest.raises(slcal.DecodeError, match="red and blue"):
            slcal.decode(np.ascontiguousarray(image[..., ::-1]), drawn)


def test_missing_stripes_are_not_attributed_to_bgr_order() -> None:
    noise = np.random.default_rng(1).integers(0, 255, (300, 400, 3), np.uint8)
    dark = np.zeros((300, 400, 3), np.uint8)
    other = slcal.StripePattern((1024, 768), hues=3, order=3).image()
    for image in (noise, dark, other):
        with pytest.raises(slcal.DecodeError) as caught:
            slcal.decode(image, STRIPES)
        assert "red and blue" not in str(caught.value)
        assert caught.value.what
        assert caught.value.seen
        assert caught.value.advice


@pytest.mark.parametrize(
    ("image", "error", "words"),
    [
        (None, TypeError, "cv2.imread returns None"),
        ("photo.png", TypeError, "read_image"),
        ([[1, 2], [3, 4]], TypeError, "np.asarray"),
        (np.zeros((4, 4, 3)), TypeError, "float64"),
        (np.zeros((4, 4, 3), np.int64), TypeError, "astype"),
        (np.full((4, 4, 3), np.nan), TypeError, "float64"),
        (np.zeros((4, 4, 4), np.uint8), ValueError, "alpha"),
        (np.zeros((4, 4, 1), np.uint8), ValueError, "image[..., 0]"),
        (np.zeros((3, 40, 40), np.uint8), ValueError, "transpose"),
        (np.zeros((2, 4, 4, 3), np.uint8), ValueError, "one photograph at a time"),
        (np.zeros((0, 4, 3), np.uint8), ValueError, ""),
        (np.zeros((1, 1, 3), np.uint8), ValueError, ""),
        (np.zeros((40, 40), np.uint8), ValueError, "colour"),
    ],
    ids=str,
)
def test_what_is_no_image(image: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error) as caught:
        slcal.decode(image, STRIPES)
    assert words in str(caught.value)
    if error is ValueError:
        assert isinstance(caught.value, slcal.Error)


def test_options_are_checked(scene: simulate.Scene) -> None:
    for option in ({"gamma": "rec709"}, {"gamma": -1.0}, {"min_confidence": 2.0}, {"min_confidence": float("nan")}):
        with pytest.raises(slcal.Error):
            slcal.decode(scene.photo, scene.pattern, **option)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        slcal.decode(scene.photo, slcal.CheckerPattern((1024, 768)))  # type: ignore[arg-type]
    sure = slcal.decode(scene.photo, scene.pattern, min_confidence=0.99)
    assert sure.confidence.min() >= 0.99
    assert len(sure) < len(slcal.decode(scene.photo, scene.pattern))


def test_matches_of_arrays() -> None:
    matches = slcal.Matches(
        [[1, 2], [3, 4], [5, 6]], [10, np.nan, 30], [np.nan, np.nan, 7], slits=[0, -1, 65534], confidence=0.5,
        colors=[[1, 2, 3]] * 3,
    )  # fmt: skip
    assert len(matches) == 3
    assert np.array_equal(matches.columns, [10, np.nan, 30], equal_nan=True)
    assert np.array_equal(matches.rows, [np.nan, np.nan, 7], equal_nan=True)
    assert matches.slits.tolist() == [0, -1, 65534]
    assert matches.confidence.tolist() == [0.5] * 3
    assert matches.sigma_px.tolist() == [0.1] * 3
    assert matches.colors.tolist() == [[1, 2, 3]] * 3
    assert matches.report is None
    only_rows = slcal.Matches([[1, 2]], rows=[3])
    assert only_rows.columns is None
    assert only_rows.rows is not None
    assert len(slcal.Matches(np.empty((0, 2)), columns=[])) == 0
    assert slcal.Matches(np.array([[[1, 2]], [[3, 4]]], np.float32), columns=[1, 2]) == slcal.Matches(
        [[1, 2], [3, 4]], columns=(1, 2)
    )


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        (([[1, 2]],), {}, "column"),
        (([[1, 2]], [1, 2]), {}, "columns"),
        (([[1, 2, 3]], [1]), {}, "pixels"),
        (([[1, np.nan]], [1]), {}, "pixels"),
        (([[1, 2]], [np.inf]), {}, "columns"),
        (([[1, 2]], [1]), {"rows": [1, 2]}, "rows"),
        (([[1, 2]], [1]), {"slits": [70000]}, "slits"),
        (([[1, 2]], [1]), {"slits": [0.5]}, "slits"),
        (([[1, 2]], [1]), {"slits": [1, 2]}, "slits"),
        (([[1, 2]], [1]), {"confidence": 2}, "confidence"),
        (([[1, 2]], [1]), {"confidence": np.nan}, "confidence"),
        (([[1, 2]], [1]), {"sigma_px": -0.1}, "sigma_px"),
        (([[1, 2]], [1]), {"colors": [[1, 2]]}, "colors"),
        (([[1, 2]], [1]), {"colors": [[1, 2, 256]]}, "colors"),
        (([[1, 2]], [1]), {"colors": [[1, 2, 3]] * 2}, "colors"),
    ],
)
def test_matches_that_do_not_fit(arguments: Any, options: Any, words: str) -> None:
    with pytest.raises(slcal.Error, match=words):
        slcal.Matches(*arguments, **options)


def test_matches_of_no_numbers() -> None:
    for pixels in (None, "12", [["a", "b"]], [[1j, 2]], np.array([[1j, 2]])):
        with pytest.raises(TypeError, match="pixels"):
            slcal.Matches(pixels, columns=[1])  # type: ignore[arg-type]


def test_matches_are_values(scene: simulate.Scene, tmp_path: Path) -> None:
    matches = slcal.decode(scene.photo, scene.pattern)
    again = pickle.loads(pickle.dumps(matches))
    assert again == matches
    assert again.report == matches.report
    assert matches != scene.matches
    assert matches != "matches"
    with pytest.raises(TypeError):
        hash(matches)
    assert repr(matches).startswith(f"Matches({len(matches)} with columns of ")
    unknown = slcal.Matches([[1, 2], [3, 4]], [np.nan, np.nan], slits=[1, 2])
    assert pickle.loads(pickle.dumps(unknown)) == unknown
    assert repr(unknown) == "Matches(2)"


def test_matches_are_saved_and_loaded(scene: simulate.Scene, tmp_path: Path) -> None:
    matches = slcal.decode(scene.photo, scene.pattern)
    matches.save(tmp_path / "matches.csv")
    loaded = slcal.Matches.load(str(tmp_path / "matches.csv"))
    assert np.abs(loaded.pixels - matches.pixels).max() <= 0.5e-5
    assert (loaded.slits == matches.slits).all()
    assert loaded.report is None
    text = io.StringIO()
    matches.save(text)
    assert text.getvalue() == (tmp_path / "matches.csv").read_text()
    assert slcal.Matches.load(io.BytesIO(text.getvalue().encode())) == loaded
    with pytest.raises(FileNotFoundError):
        slcal.Matches.load(tmp_path / "absent.csv")
    with pytest.raises(slcal.FormatError, match="u"):
        slcal.Matches.load(io.StringIO("x,y\n1,2\n"))
    closed = io.StringIO()
    closed.close()
    with pytest.raises(ValueError, match="closed"):
        matches.save(closed)
    with pytest.raises(ValueError, match="closed"):
        slcal.Matches.load(closed)


def test_a_mirrored_picture_counts_from_the_other_end() -> None:
    made = simulate.scene("plane", mirror=True)
    assert made.rig.mirrored
    said = slcal.decode(made.photo, made.pattern, mirror=True)
    known = slcal.decode(made.photo, made.pattern, rig=made.rig)
    assert np.array_equal(said.columns, known.columns)
    assert np.array_equal(said.columns, 1023 - made.pattern.centres_px[said.slits])
    on_panel = made.pattern.mirrored()
    assert (on_panel.image() == made.pattern.image()[:, ::-1]).all()
    cloud = made.rig.reconstruct(made.photo, made.pattern)
    unsaid = slcal.Rig(made.rig.camera, made.rig.projector, made.rig.projector_from_camera)
    with pytest.raises(slcal.DecodeError, match="left and right of the picture exchanged"):
        unsaid.reconstruct(made.photo, made.pattern)
    assert len(unsaid.reconstruct(made.photo, made.pattern, mirror=True)) == len(cloud)
    scanner = slcal.Reconstructor(unsaid, made.pattern, mirror=True)
    assert len(scanner.reconstruct(made.photo)) == len(cloud)
    with pytest.raises(slcal.Error, match="size of the rig's camera"):
        slcal.decode(made.photo[::2, ::2].copy(), made.pattern, rig=made.rig)
