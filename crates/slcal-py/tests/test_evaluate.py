"""Fits against surfaces whose parameters and scatter are known."""

from __future__ import annotations

import dataclasses
import json
import pickle
from typing import Any

import numpy as np
import pytest

import slcal
from slcal.reports import PlaneFit, SphereFit


def plane(sigma: float, outliers: int = 0) -> Any:
    """Points of 0.6 x + 0.8 z = 800 mm with noise along the normal, and a cloud of others behind it."""
    random = np.random.default_rng(5)
    x, y = random.uniform(-200, 200, (2, 3000))
    on_plane = np.stack([x, y, (800 - 0.6 * x) / 0.8], axis=1)
    on_plane += random.normal(0, sigma, (3000, 1)) * (0.6, 0, 0.8)
    behind = random.uniform((-200, -200, 1400), (200, 200, 1900), (outliers, 3))
    return np.concatenate([on_plane, behind])


@pytest.mark.parametrize("sigma", [0.1, 0.5])
def test_a_plane_is_found_among_other_things(sigma: float) -> None:
    fit = slcal.evaluate(plane(sigma, 1000), "plane")
    assert isinstance(fit, PlaneFit)
    normal = np.array(fit.normal) * np.sign(fit.normal[2])
    assert normal == pytest.approx((0.6, 0, 0.8), abs=5 * sigma / 115 / np.sqrt(3000))
    assert abs(fit.offset_mm) == pytest.approx(800, abs=0.05)
    report = fit.report
    assert report.points == 4000
    assert report.outlier_share == pytest.approx(0.25, abs=0.005)
    assert report.rms_mm == pytest.approx(sigma, rel=0.05)
    # Of a normal distribution: the mean of |x| is sqrt(2/π) σ, its deviation sqrt(1 - 2/π) σ.
    assert report.mean_mm == pytest.approx(np.sqrt(2 / np.pi) * sigma, rel=0.05)
    assert report.std_mm == pytest.approx(np.sqrt(1 - 2 / np.pi) * sigma, rel=0.05)
    assert report.rms_percent == pytest.approx(100 * report.rms_mm / report.camera_distance_mm)
    assert report.camera_distance_mm == pytest.approx(np.linalg.norm(plane(sigma), axis=1).mean(), rel=1e-3)
    assert "4" in report.rule


def test_a_sphere_is_found_before_a_wall() -> None:
    random = np.random.default_rng(6)
    out = random.normal(size=(6000, 3))
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    out = out[out[:, 2] < -0.3]
    ball = (20, -30, 1100) + out * (150 + random.normal(0, 0.2, (len(out), 1)))
    wall = random.uniform((-500, -400, 1500), (500, 400, 1500.1), (2 * len(ball), 3))
    cloud = slcal.PointCloud(np.concatenate([ball, wall]))
    fit = cloud.fit_sphere()
    assert isinstance(fit, SphereFit)
    assert fit.radius_mm == pytest.approx(150, abs=0.1)
    assert fit.centre_mm == pytest.approx((20, -30, 1100), abs=0.1)
    assert fit.report.rms_mm == pytest.approx(0.2, rel=0.1)
    assert slcal.evaluate(cloud, "sphere") == fit


def test_arrays_and_clouds_give_the_same() -> None:
    points = plane(0.2)
    fit = slcal.evaluate(slcal.PointCloud(points), "plane")
    assert slcal.evaluate(points, "plane") == fit
    assert slcal.evaluate(points.tolist(), "plane") == fit
    assert slcal.evaluate(np.asfortranarray(points), "plane") == fit
    assert slcal.PointCloud(points).fit_plane() == fit


def test_a_fit_is_a_record() -> None:
    fit = slcal.evaluate(plane(0.2), "plane")
    assert pickle.loads(pickle.dumps(fit)) == fit
    assert json.loads(json.dumps(fit.to_dict()))["report"]["points"] == 3000
    with pytest.raises(dataclasses.FrozenInstanceError):
        fit.offset_mm = 3.0  # type: ignore[misc, union-attr]


@pytest.mark.parametrize(
    ("points", "shape", "error", "words"),
    [
        (np.zeros((0, 3)), "plane", slcal.Error, "3 points"),
        ([[0, 0, 1]] * 2, "plane", slcal.Error, "3 points"),
        ([[0, 0, 1]] * 3, "sphere", slcal.Error, "4 points"),
        ([[0, 0, 1]] * 30, "plane", slcal.Error, "plane"),
        ([[i, 2, 100] for i in range(50)], "plane", slcal.Error, "plane"),
        ([[i % 20, i // 20, 1500] for i in range(400)], "sphere", slcal.Error, "sphere"),
        ([[0, 0, np.nan]] * 9, "plane", slcal.Error, "row 0"),
        (np.zeros((9, 2)), "plane", slcal.Error, r"\(N, 3\)"),
        (np.zeros((9, 3)), "cube", slcal.Error, "sphere"),
        (np.zeros((9, 3)), None, slcal.Error, "sphere"),
        (None, "plane", TypeError, "cloud"),
        ("cloud.ply", "plane", TypeError, "cloud"),
        (np.zeros((9, 3), complex), "plane", TypeError, "complex"),
    ],
)
def test_clouds_without_a_fit_are_refused(points: Any, shape: Any, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        slcal.evaluate(points, shape)
