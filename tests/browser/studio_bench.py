"""What the checks of the studio share: the program, folders, photographs of a simulated sheet, and the truth about them."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from studio_pages import Browser
from studio_server import Studio

PANEL, SHEET = "1024x768", "594x420mm"
SIGMAS = 4.0
"""Figures must lie within so many of their own σ of the truth. Scenes are the same every time: this is no test of σ itself."""


@dataclass
class Bench:
    """The program under test and a folder for what it makes."""

    slcal: Path
    folder: Path
    pictures: Path | None = None
    figures: list[str] = field(default_factory=list)
    """Measured figures, printed at the end."""
    until_end: ExitStack = field(default_factory=ExitStack)

    def run(self, *args: str | Path) -> str:
        done = subprocess.run([self.slcal, "-q", *args], check=True, capture_output=True, text=True)
        return done.stdout

    def studio(self, name: str, *args: str | Path, port: int | None = None) -> Studio:
        """A studio for the simulated panel and sheet in a folder of this name."""
        return Studio(self.slcal, self.folder / name, *map(str, args), port=port)

    def real(self, name: str, *args: str | Path, port: int | None = None) -> Studio:
        """The same without --demo."""
        return self.studio(name, "--projector", PANEL, "--size", SHEET, *args, port=port)

    def scene(self, name: str, surface: str, pattern: str, *args: str) -> Path:
        """A rendered photograph under the studio's own pattern; the true rig lies beside it."""
        out = self.folder / name
        if not out.exists():
            self.run("simulate", "scene", "--surface", surface, "--pattern", self.patterns / pattern, "--out", out, *args)
        return out / "photo.png"

    @cached_property
    def patterns(self) -> Path:
        """The folder of a studio that has drawn its patterns."""
        with self.real("patterns") as studio:
            studio.wait("patterns", lambda s: not s["busy"])
        return studio.folder

    def sheets(self) -> list[Path]:
        """Two photographs of the sheet from one rig."""
        return [self.scene("sheet-1", "sheet", "checker.json", "--tilt", "25,28"),
                self.scene("sheet-2", "sheet", "checker.json", "--tilt=-30,-20", "--seed", "2")]

    def sphere(self) -> Path:
        """A photograph of a sphere of 180 mm from the same rig."""
        return self.scene("sphere", "sphere", "stripes.json", "--radius", "180")

    @contextmanager
    def calibrated(self, name: str, *args: str) -> Iterator[Studio]:
        """A studio with two photographs that were uploaded, their rig, and a scan."""
        with self.real(name, *args) as studio:
            with studio.socket("operator") as page:
                page.send("camera", kind="files")
                page.send("step", step="calibrate")
                studio.wait("step calibrate", lambda s: s["step"] == "calibrate" and not s["busy"])
                for n, sheet in enumerate(self.sheets(), 1):
                    assert studio.upload(sheet.read_bytes(), sheet.name).status == 200
                    studio.wait(f"a calibration from {n}", lambda s: calibrated_from(s, n))
                page.send("step", step="scan")
                studio.wait("step scan", lambda s: s["step"] == "scan")
                assert studio.upload(self.sphere().read_bytes()).json()["scan"]
                studio.wait("a cloud", lambda s: s["scan"]["clouds"] and not s["busy"])
            yield studio

    @cached_property
    def finished(self) -> Studio:
        """One such studio for all checks that must not change anything in it."""
        return self.until_end.enter_context(self.calibrated("finished"))

    def figure(self, text: str) -> None:
        self.figures.append(text)


BEFORE_WALL_MM = 200.0
PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "uint": "<u4", "int": "<i4"}


def points_of(cloud: Path) -> NDArray[np.float64]:
    """The points of a binary PLY, mm."""
    data = cloud.read_bytes()
    head, _, rest = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    vertices = next(i for i, line in enumerate(lines) if line[:2] == ["element", "vertex"])
    columns = []
    for line in lines[vertices + 1:]:
        if line[0] != "property":
            break
        columns.append((line[2], PLY_TYPES[line[1]]))
    read = np.frombuffer(rest, np.dtype(columns), int(lines[vertices][2]))
    return np.stack([read[axis] for axis in "xyz"], axis=1).astype(float)


def sphere_radius(cloud: Path) -> float:
    """Radius of the sphere that is nearest to the camera; what stands behind it is left out."""
    points = points_of(cloud)
    points = points[points[:, 2] < np.percentile(points[:, 2], 1) + BEFORE_WALL_MM]
    keep = np.full(len(points), True)
    for _ in range(5):
        # |p|^2 = 2 c p + (r^2 - |c|^2): linear in what is sought.
        known = np.c_[2 * points[keep], np.ones(keep.sum())]
        solved = np.linalg.lstsq(known, (points[keep] ** 2).sum(1), rcond=None)[0]
        centre, radius = solved[:3], float(np.sqrt(solved[3] + solved[:3] @ solved[:3]))
        off = np.abs(np.linalg.norm(points - centre, axis=1) - radius)
        keep = off < 4 * 1.4826 * np.median(off[keep])
    return radius


def calibrated_from(state: Any, count: int) -> bool:
    """Whether the calibration is from so many photographs, and nothing is under way."""
    calibration = state["calibration"]
    return bool(calibration and calibration["photographs"] == count and not state["busy"])


def off_by_sigmas(rig: Any, truth: Any) -> dict[str, float]:
    """How far focal lengths and baseline lie from the truth, in their own σ."""
    off = {}
    for device in ("camera", "projector"):
        found, true = rig[device], truth[device]
        off[f"{device} focal length"] = (found["K"][0][0] - true["K"][0][0]) / found["sigma"]["focal_px"]
    found, true = rig["projector_from_camera"], truth["projector_from_camera"]
    length = math.hypot(*found["t"])
    # σ along t: that of its components, which count as much as they contribute to the length.
    sigma = math.hypot(*(t / length * s for t, s in zip(found["t"], found["sigma_t_mm"], strict=True)))
    off["baseline"] = (length - math.hypot(*true["t"])) / sigma
    return off


def agrees_with_truth(rig: Path, truth: Path) -> dict[str, float]:
    """Focal lengths and baseline lie within a few of their own σ of the truth."""
    off = off_by_sigmas(json.loads(rig.read_text()), json.loads(truth.read_text()))
    assert all(abs(value) < SIGMAS for value in off.values()), off
    return off


@contextmanager
def quiet(browser: Browser, studio: Studio, *expected: str) -> Iterator[None]:
    """Pages ask nothing of another host, and complain about nothing but what is expected. Closes their windows."""
    browser.look()
    browser.asked.clear()
    browser.said.clear()
    try:
        yield
        browser.look()
        foreign = browser.foreign(studio.host)
        assert not foreign, foreign
        said = [line for line in browser.said if not any(part in line for part in expected)]
        assert not said, said
    finally:
        browser.close_all()
