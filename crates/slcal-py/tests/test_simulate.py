"""Simulated scenes are what their options say, by geometry that is computed here once more."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slcal
from slcal import simulate

SMALL: Any = {"camera": (640, 480), "focal": 750}


def test_every_pixel_of_a_plane_is_known() -> None:
    made = simulate.scene("plane", tilt=(0, 0), distance=900, distortion=[-0.1, 0.02], **SMALL)
    assert made.photo.shape == made.white.shape == made.black.shape == (480, 640, 3)
    assert made.photo.dtype == np.uint8
    assert made.surface.dtype == np.uint8
    assert (made.surface == 1).all()
    for truth in (made.depth, made.column, made.row):
        assert truth.shape == (480, 640)
        assert truth.dtype == np.float32
    assert np.abs(made.depth - 900).max() < 1e-3
    assert made.rig.camera.distortion.tolist() == [-0.1, 0.02, 0, 0, 0]
    # What lights a pixel: its ray to the plane, seen by the projector.
    lit = np.isfinite(made.column)
    assert (np.isfinite(made.row) == lit).all()
    v, u = np.nonzero(lit)
    rays = np.append(made.rig.camera.undistort(np.stack([u, v], axis=1)), np.ones((len(u), 1)), axis=1)
    pose, projector = made.rig.projector_from_camera, made.rig.projector
    assert pose is not None
    assert projector is not None
    panel = projector.project(pose.transform(900 * rays))
    assert np.abs(panel[:, 0] - made.column[lit]).max() < 1e-3
    assert np.abs(panel[:, 1] - made.row[lit]).max() < 1e-3
    assert made.report.lit_pixels == lit.sum()
    assert made.report.depth_mm == pytest.approx((900, 900))


def test_true_matches_are_true() -> None:
    made = simulate.scene("sphere", aside=(20, -10), radius=120, wall=200, **SMALL)
    cloud = made.rig.triangulate(made.matches)
    assert len(cloud) == len(made.matches) == made.report.matches
    assert np.abs(cloud.points - made.cloud.points).max() < 1e-3
    on_ball = cloud.points[:, 2] < 1100
    off = np.linalg.norm(cloud.points[on_ball] - (20, -10, 1000), axis=1) - 120
    assert np.median(np.abs(off)) < 1e-3
    far = cloud.points[cloud.points[:, 2] > 1199, 2]
    assert np.abs(far - 1200).max() < 1e-3


def test_light_follows_the_options() -> None:
    dark = simulate.scene("plane", exact=True, ambient=0.0, **SMALL)
    assert dark.photo.dtype == np.uint16
    assert dark.black.max() == 0
    assert dark.white[240, 320].min() > 30000
    red = simulate.scene("plane", exact=True, albedo=(0.9, 0.2, 0.1), **SMALL).white[240, 320].astype(float)
    assert red[0] > red[1] > red[2]
    assert simulate.scene("plane", noise=0, bits=16, **SMALL).photo.dtype == np.uint16
    mixed = simulate.scene("plane", exact=True, crosstalk=0.3, **SMALL)
    matrix = np.array([[1, 0.3, 0], [0.3, 1, 0.3], [0, 0.3, 1]])
    same = simulate.scene("plane", exact=True, crosstalk=matrix / matrix.sum(axis=1, keepdims=True), **SMALL)
    assert (mixed.photo == same.photo).all()
    assert (mixed.photo != simulate.scene("plane", exact=True, **SMALL).photo).any()


def test_seeds_make_the_noise() -> None:
    one, again, other = (simulate.scene("plane", seed=s, noise=3, **SMALL).photo for s in (1, 1, 2))
    assert (one == again).all()
    difference = other.astype(float) - one
    assert np.std(difference[200:280, 280:360]) == pytest.approx(3 * np.sqrt(2), rel=0.1)


def test_patterns_and_rigs_of_ones_own() -> None:
    stripes = slcal.StripePattern((800, 600), hues=3)
    made = simulate.scene("step", stripes, projector=(800, 600), **SMALL)
    assert made.pattern == stripes
    again = simulate.scene("step", made.pattern, rig=made.rig)
    assert (again.photo == made.photo).all()
    assert again.rig == made.rig
    sheet = simulate.scene("sheet", **SMALL)
    assert isinstance(sheet.pattern, slcal.CheckerPattern)
    assert len(sheet.rig.views) == 1
    assert isinstance(simulate.scene("sheet", "stripes", **SMALL).pattern, slcal.StripePattern)
    assert repr(made) == f"Scene(640x480, {made.report.surfaces} surfaces, {len(made.matches)} matches)"


def test_a_sequence_is_photographed_frame_by_frame() -> None:
    sequence = slcal.SequencePattern((256, 192), "phase", period=20, steps=5)
    options = {"projector": (256, 192), "projector_focal": 425, "exact": True, "gamma": "linear", **SMALL}
    made = simulate.scene("sphere", sequence, projector_gamma=1.0, projector_blur=0.7, **options)
    assert made.pattern == sequence
    assert len(made.frames) == len(sequence)
    assert len(made.matches) == 0
    assert repr(made.frames) == f"SceneFrames({len(sequence)})"
    # The phase of the true column, but for whole periods.
    total = np.zeros((480, 640), complex)
    for frame, photo in zip(sequence.frames, made.frames, strict=True):
        assert photo.shape == (480, 640, 3)
        if frame["is"] == "sinusoid":
            total += photo[..., 1].astype(float) * np.exp(2j * np.pi * frame["step"] / frame["of"])
    off = np.angle(total * np.exp(-2j * np.pi * made.column / 20)) / (2 * np.pi) * 20
    inside = (made.column > 4) & (made.column < 251)
    assert inside.sum() > 50_000
    assert np.median(np.abs(off[inside])) < 0.05
    assert (made.frames[-1] == made.frames[len(sequence) - 1]).all()
    assert (made.photo == made.white).all()
    with pytest.raises(IndexError, match=f"below {len(sequence)}"):
        made.frames[len(sequence)]
    assert len(simulate.scene("plane", **SMALL).frames) == 0


def test_bent_sheets_and_real_lenses() -> None:
    lens = {
        "pixel_aspect": 1.01,
        "projector_pixel_aspect": 0.99,
        "projector_offset": (30, -12),
        "projector_distortion": [-0.02, 0.01],
    }
    made = simulate.scene("sheet", bend="0.5%,20,wave", thickness=10, **lens, **SMALL)
    assert made.report.bend == {"kind": "wave", "axis_deg": 20, "sag_mm": pytest.approx(2.97)}
    assert made.report.thickness_mm == 10
    assert (made.surface == 2).sum() > 100
    assert made.rig.camera.K[1, 1] == pytest.approx(757.5)
    assert made.rig.projector.K[0, 2] == pytest.approx(541.5)
    assert made.rig.projector.K[1, 2] == pytest.approx(371.5)
    flat = simulate.scene("sheet", rig=made.rig, thickness=10)
    bent = simulate.scene("sheet", rig=made.rig, bend="3mm")
    assert flat.report.bend is None
    assert np.nanmax(np.abs(flat.depth - bent.depth)) > 1
    seen, rig = simulate.views(poses=2, bend="3mm", edges=9, **lens)
    assert len(seen) == 2
    assert rig.projector.K[0, 2] == pytest.approx(541.5)
    assert simulate.noise([0.1], draws=2, bend="3mm", **lens).config["rig"]["bend"] == "3mm,0,curl"


def test_real_projectors_and_cameras() -> None:
    options = {
        "projector_gamma": 2.0,
        "projector_falloff": 0.2,
        "channel_shift": (0.5, -0.3, -0.4, 0.5),
        "lateral_colour": (6e-4, -5e-4),
        "vignetting": 0.3,
        "flicker": (0.1, 170),
        "demosaic": "malvar",
        "tone": 0.35,
        "sharpen": (0.6, 1.0),
        "jpeg": 88,
    }
    plain = simulate.scene(**SMALL)
    real = simulate.scene(**SMALL, **options)
    assert real.report.render["channel_shift_px"] == [[0.5, -0.3], [-0.4, 0.5]]
    assert real.report.render["sharpen"] == {"amount": 0.6, "radius_px": 1.0}
    assert real.report.render["demosaic"] == "malvar"
    assert real.report.render["jpeg_quality"] == 88
    assert "demosaic" not in plain.report.render
    np.testing.assert_array_equal(real.column, plain.column)  # the geometry of green is the rig's
    assert real.photo.dtype == np.uint8
    assert (real.photo != plain.photo).mean() > 0.5
    np.testing.assert_array_equal(real.photo, simulate.scene(**SMALL, **options).photo)
    corner = simulate.scene("plane", vignetting=0.5, exact=True, gamma="linear", **SMALL)
    bright = simulate.scene("plane", exact=True, gamma="linear", **SMALL)
    assert corner.black[0, 0, 1] / bright.black[0, 0, 1] == pytest.approx(0.5, abs=0.01)


def test_meshes(tmp_path: Path) -> None:
    square = slcal.PointCloud(
        [[-100, -80, 900], [100, -80, 900], [100, 80, 900], [-100, 80, 900]], triangles=[[0, 2, 1], [0, 3, 2]]
    )
    made = simulate.scene(square, mesh_frame="camera", wall=300, **SMALL)
    assert made.depth[240, 320] == pytest.approx(900, abs=1e-3)
    square.save(tmp_path / "square.ply")
    square.save(tmp_path / "square.obj")
    for file in (tmp_path / "square.ply", str(tmp_path / "square.obj")):
        assert (simulate.scene(file, mesh_frame="camera", wall=300, **SMALL).depth == made.depth).all()
    half = simulate.scene(square, mesh_scale=0.5, **SMALL)
    v, u = np.nonzero(half.surface == 1)
    assert (u.max() - u.min() + 1) / 750 * half.depth[240, 320] == pytest.approx(100, abs=1.5)
    with pytest.raises(FileNotFoundError):
        simulate.scene(tmp_path / "absent.ply")
    with pytest.raises(slcal.Error):
        simulate.scene(slcal.PointCloud(square.points))


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"surface": "cube"}, slcal.Error, "sphere"),
        ({"surface": "cube.stl"}, slcal.Error, r"\.ply or \.obj"),
        ({"pattern": "dots"}, slcal.Error, "checker"),
        ({"tilt": (1,)}, slcal.Error, "tilt"),
        ({"tilt": (95, 0)}, slcal.Error, "90"),
        ({"surface": "sheet", "bend": "200%"}, slcal.Error, "sag"),
        ({"surface": "sheet", "bend": 3}, slcal.Error, "AXIS_DEG"),
        ({"bend": "3mm"}, slcal.Error, "bend"),
        ({"surface": "sheet", "thickness": -1}, slcal.Error, "thickness"),
        ({"surface": "sheet", "thickness": float("nan")}, slcal.Error, "thickness"),
        ({"pixel_aspect": 0}, slcal.Error, "pixel aspect"),
        ({"projector_offset": (1, 2, 3)}, slcal.Error, "projector_offset"),
        ({"tilt": (np.nan, 0)}, slcal.Error, "finite"),
        ({"camera": (0, 480)}, slcal.Error, "camera"),
        ({"camera": 640}, slcal.Error, "camera"),
        ({"focal": -3}, slcal.Error, "focal"),
        ({"focal": "long"}, TypeError, "focal"),
        ({"focal": float("nan")}, slcal.Error, "focal"),
        ({"noise": -1}, slcal.Error, "noise"),
        ({"bits": 12}, slcal.Error, "8 or 16"),
        ({"seed": 1.5}, TypeError, "seed"),
        ({"seed": -1}, slcal.Error, "seed"),
        ({"wall": 100}, slcal.Error, "wall"),
        ({"surface": "sphere", "wall": "far"}, slcal.Error, "none"),
        ({"albedo": 2}, slcal.Error, "albedo"),
        ({"gamma": "rec709"}, slcal.Error, "gamma"),
        ({"distortion": [3, 0]}, slcal.Error, "distortion"),
        ({"channel_shift": (0.5, 0.5)}, slcal.Error, "channel_shift"),
        ({"channel_shift": (0, 0, 0, 100)}, slcal.Error, "channel shift"),
        ({"lateral_colour": (np.nan, 0)}, slcal.Error, "finite"),
        ({"projector_gamma": 0}, slcal.Error, "gamma"),
        ({"projector_falloff": 2}, slcal.Error, "falloff"),
        ({"vignetting": -1}, slcal.Error, "vignetting"),
        ({"flicker": (0.5, 0)}, slcal.Error, "period"),
        ({"demosaic": "nearest"}, slcal.Error, "malvar, bilinear"),
        ({"tone": 2}, slcal.Error, "tone"),
        ({"sharpen": (1, -1)}, slcal.Error, "radius"),
        ({"jpeg": 0}, slcal.Error, "1 to 100"),
        ({"jpeg": 101}, slcal.Error, "1 to 100"),
        ({"jpeg": 90, "exact": True}, slcal.Error, "8 with JPEG"),
        ({"rig": 3}, TypeError, "Rig"),
        ({"pattern": slcal.StripePattern((640, 480))}, slcal.Error, "640x480"),
    ],
)
def test_what_cannot_be_simulated(options: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        simulate.scene(**options)


def test_a_rig_and_its_numbers_exclude_each_other() -> None:
    rig = slcal.Rig(slcal.Camera.from_fov((640, 480), 45))
    with pytest.raises(slcal.Error, match="both"):
        simulate.scene(rig=rig, focal=700)
    with pytest.raises(slcal.Error, match="projector"):
        simulate.scene(rig=rig)


def test_views_calibrate_to_their_truth() -> None:
    seen, truth = simulate.views(4, noise=0.0, lens_shift=0.5)
    assert isinstance(seen, slcal.Observations)
    assert len(seen) == 4
    rig = slcal.calibrate_observations(seen, distortion="none", projector_distortion="none")
    assert rig.camera.K == pytest.approx(truth.camera.K, rel=1e-4, abs=1e-2)
    assert rig.projector is not None
    assert truth.projector is not None
    assert rig.projector.K == pytest.approx(truth.projector.K, rel=1e-4, abs=1e-1)
    assert simulate.views(4, noise=0.0, lens_shift=0.5).observations == seen
    assert simulate.views(4, seed=2).observations != simulate.views(4).observations
    given = simulate.views(pose=[(25, 28), (-20, 10, 5)], edges=40)
    assert len(given.observations) == 2
    assert given.observations.views[0].sheet_corners is None
    for options in ({"poses": 0}, {"pose": [(25,)]}, {"noise": -1}, {"edges": 1.5}, {"distance": 0}):
        with pytest.raises((slcal.Error, TypeError)):
            simulate.views(**options)


def test_noise_is_that_of_the_published_experiment() -> None:
    report = simulate.noise([0.1, 0.4], draws=20)
    assert len(report.levels) == 2
    assert report.truth["camera_focal_px"] == 1500
    assert report.config["draws"] == 20
    assert [level["level_px"] for level in report.levels] == [0.1, 0.4]
    assert simulate.noise([0.1, 0.4], draws=20) == report
    assert simulate.noise([0.1, 0.4], draws=20, seed=2) != report
    for options in ({"levels": []}, {"levels": [-1]}, {"levels": [np.nan]}, {"draws": 0}, {"principal_points": "free"}):
        with pytest.raises(slcal.Error):
            simulate.noise(**options)


@pytest.mark.skipif(os.name == "nt", reason="signals are sent as on Unix")
def test_an_experiment_can_be_interrupted() -> None:
    script = "from slcal import simulate; print('on', flush=True); simulate.noise(draws=50_000)"
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout is not None
        running.stdout.readline()
        running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=20)
    assert b"KeyboardInterrupt" in said
