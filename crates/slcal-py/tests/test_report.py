"""The page that shows a rig: what is on it, and what is refused."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pytest
from common import DEMO, command

import slcal

SIZE = (594, 420)


@pytest.fixture(scope="module")
def checker() -> slcal.CheckerPattern:
    return slcal.CheckerPattern(projector=(1024, 768))


@pytest.fixture(scope="module")
def photo() -> np.ndarray:
    return slcal.read_image(DEMO / "sheet.jpg")


def fields(page: str) -> set[tuple[str, str]]:
    """Numbers of the rig, and what they say."""
    return set(re.findall(r'data-field="([^"]*)" data-value="([^"]*)"', page))


def test_the_page_is_that_of_the_command(photo: np.ndarray, checker: slcal.CheckerPattern, tmp_path: Path) -> None:
    seen = slcal.observe(photo, SIZE, checker)
    rig = slcal.calibrate_observations(seen)
    rig.save_report(tmp_path / "page.html", photos=photo, observations=seen)
    page = (tmp_path / "page.html").read_text()
    rig.save(tmp_path / "rig.json")
    seen.save(tmp_path / "seen.json")
    command("report", "--rig", tmp_path / "rig.json", "--observations", tmp_path / "seen.json",
            "--photo", DEMO / "sheet.jpg", "-o", tmp_path / "by_command.html")
    by_command = (tmp_path / "by_command.html").read_text()
    assert len(fields(page)) > 20 and fields(page) == fields(by_command)
    for drawn in (r'id="scene">(.*?)</script>', r'<div class="plot".*?</svg></div>'):
        assert re.findall(drawn, page, re.S) and re.findall(drawn, page, re.S) == re.findall(drawn, by_command, re.S)
    assert page.count("data:image/jpeg") == by_command.count("data:image/jpeg") == 1


def test_a_rig_alone_and_a_cloud(tmp_path: Path) -> None:
    rig = slcal.Rig.load(DEMO / "truth_rig.json")
    into = io.StringIO()
    rig.save_report(into)
    assert "residuals-image" not in into.getvalue() and 'id="space"' in into.getvalue()
    cloud = slcal.PointCloud(np.array([[0.0, 0, 900], [10, 0, 910], [0, 10, 905]]))
    rig.save_report(tmp_path / "cloud.html", cloud=cloud)
    assert "All 3 points" in (tmp_path / "cloud.html").read_text()


def test_others_photographs_and_observations_are_refused(photo: np.ndarray, checker: slcal.CheckerPattern) -> None:
    seen = slcal.observe(photo, SIZE, checker)
    rig = slcal.calibrate_observations(seen)
    with pytest.raises(slcal.Error, match=r"photos: expected one for each of the 1 views .*2"):
        rig.save_report(io.BytesIO(), photos=[photo, photo])
    with pytest.raises(slcal.Error, match=r"photos\[0\]: .*1280x960 px.*640x960"):
        rig.save_report(io.BytesIO(), photos=[photo[:, :640]])
    with pytest.raises(slcal.Error, match="view"):
        rig.save_report(io.BytesIO(), observations=slcal.observe([photo, photo], SIZE, checker))
    with pytest.raises(TypeError, match="photos"):
        rig.save_report(io.BytesIO(), photos="sheet.jpg")
    with pytest.raises(TypeError, match="observations"):
        rig.save_report(io.BytesIO(), observations=3)
