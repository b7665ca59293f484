"""The studio runs beside the program and hands back what is made in it."""

from __future__ import annotations

import json
import urllib.request
from pathlib import Path

import pytest
from PIL import Image

import slcal
from slcal import simulate


def post(studio: slcal.Studio, path: str, body: bytes, cookie: str = "") -> tuple[dict[str, object], str]:
    """Answer and cookie of a request as the operator's page sends it."""
    origin = studio.url.split("/#")[0]
    headers = {"Origin": origin, "Cookie": cookie} if cookie else {"Origin": origin}
    request = urllib.request.Request(origin + path, data=body, headers=headers, method="POST")
    with urllib.request.urlopen(request, timeout=60) as answer:
        found: dict[str, object] = json.load(answer)
        return found, (answer.headers.get("Set-Cookie") or "").split(";")[0]


def calibrating(folder: Path, size: str) -> None:
    """The settings that an earlier run left."""
    folder.mkdir()
    settings = {
        "schema": "slcal-studio-settings/1",
        "projector": [1024, 768],
        "size": size,
        "pattern_scale": 1.0,
        "camera": "files",
        "step": "calibrate",
    }
    (folder / "studio.json").write_text(json.dumps(settings))


def test_a_photograph_becomes_a_rig(tmp_path: Path) -> None:
    folder = tmp_path / "work"
    sheet = simulate.scene("sheet", pattern=slcal.CheckerPattern((1024, 768), marks=True), tilt=(25, 28))
    calibrating(folder, "594x420mm")
    picture = tmp_path / "sheet.png"
    Image.fromarray(sheet.photo).save(picture)
    with slcal.studio(folder, open_browser=False) as studio:
        assert studio.running and studio.rig is None and studio.clouds == []
        assert studio.url.startswith("http://127.0.0.1:") and "#" in studio.display_url
        with pytest.raises(TimeoutError, match="calibration within"):
            studio.wait_for_rig(timeout=0.1)
        token = json.dumps({"token": studio.url.split("#")[1]}).encode()
        role, cookie = post(studio, "/api/session", token)
        assert role == {"role": "operator"}
        answer, _ = post(studio, "/api/photographs?as=operator", picture.read_bytes(), cookie)
        assert answer["id"] == 1
        rig = studio.wait_for_rig(timeout=120)
        truth = sheet.rig.camera.K[0, 0]
        assert abs(rig.camera.K[0, 0] - truth) < 4 * rig.camera.sigma.focal_px
        assert list(studio.new_clouds(timeout=0.1)) == []
    assert not studio.running
    assert "ended" in repr(studio)
    # What was made is there without it.
    assert slcal.Rig.load(folder / "rig.json") == rig


def test_what_cannot_start_says_why(tmp_path: Path) -> None:
    with slcal.studio(tmp_path, open_browser=False):
        with pytest.raises(slcal.Error, match="another slcal studio has it open"):
            slcal.studio(tmp_path, open_browser=False)
    with pytest.raises(slcal.Error, match="--size"):
        slcal.studio(tmp_path, size_mm="A44", open_browser=False)


def test_a_studio_that_ends_early_is_told(tmp_path: Path) -> None:
    studio = slcal.studio(tmp_path, open_browser=False)
    studio.close()
    with pytest.raises(slcal.Error, match="ended before"):
        studio.wait_for_rig()
    studio.close()
