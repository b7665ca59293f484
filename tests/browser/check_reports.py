"""Looks at reports in a real browser: do they draw, ask for nothing, say what rig.json says, fit a phone and a page?

    check_reports.py --slcal target/release/slcal [--pictures DIR]

Passes with a word about it where Chromium or its driver is not installed. `--pictures` keeps screenshots to look at.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import random
import re
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pypdfium2
from browser import Page, chromium, opened
from PIL import Image, ImageChops, ImageStat
from selenium.webdriver.common.keys import Keys

DEMO_BYTES = 2_000_000
LARGE_BYTES = 5_000_000
LARGE_POINTS = 100_000
STAGE = "#space .cloud-view-stage"
"""What is turned."""
HOSTILE = "</script><script>document.title='hacked'</script><!-- \"'é& <b>"


class Reports:
    """Reports made by the program under test, in a folder of their own."""

    def __init__(self, slcal: Path, folder: Path) -> None:
        self.slcal, self.folder = slcal, folder
        self.demo = folder / "demo"
        self.run("demo", "--out", str(self.demo))

    def run(self, *args: str) -> None:
        subprocess.run([self.slcal, "-q", *args], check=True, stdout=subprocess.DEVNULL, cwd=self.folder)

    def large(self) -> Path:
        """A cloud of many points beside the demo's rig."""
        cloud, report = self.folder / "large.ply", self.folder / "large.html"
        cloud.write_bytes(scattered(LARGE_POINTS))
        self.run("report", "--rig", str(self.demo / "rig.json"), "--cloud", str(cloud), "-o", str(report))
        return report

    def of_cloud(self) -> Path:
        report = self.folder / "cloud.html"
        self.run("reconstruct", "--rig", str(self.demo / "rig.json"), "--pattern", str(self.demo / "stripes.json"),
                 str(self.demo / "board.jpg"), "-o", str(self.folder / "board.ply"), "--mesh", "--report", str(report),
                 "--fit", "plane")
        return report

    def hostile(self) -> Path:
        """Names that would be scripts if anything forgot to escape them."""
        rig = json.loads((self.demo / "rig.json").read_text())
        rig["views"][0]["photo"] = HOSTILE
        rig["method"] = HOSTILE
        rig["quality"].update(cause=HOSTILE, advice=HOSTILE)
        rig["quality"]["warnings"] = [{"code": HOSTILE, "message": HOSTILE, "advice": HOSTILE}]
        name = HOSTILE.replace("/", "_")
        (self.folder / f"{name}.json").write_text(json.dumps(rig))
        (self.folder / f"{name}.ply").write_bytes((self.demo / "cloud.ply").read_bytes())
        report = self.folder / f"{name}.html"
        self.run("report", "--rig", f"{name}.json", "--cloud", f"{name}.ply", "--photo", str(self.demo / "sheet.jpg"),
                 "-o", report.name)
        return report

    def bare(self) -> Path:
        """A rig as one writes it by hand: nothing but two devices."""
        device = {"width": 640, "height": 480, "K": [[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]], "distortion": [0] * 5}
        pose = {"R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [-200, 0, 0]}
        rig = {"schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "camera": device, "projector": device,
               "projector_from_camera": pose, "views": [], "method": "by hand"}
        (self.folder / "hand.json").write_text(json.dumps(rig))
        self.run("report", "--rig", "hand.json", "-o", "hand.html")
        return self.folder / "hand.html"


def scattered(count: int) -> bytes:
    """A PLY of a wavy surface in front of the camera."""
    rng = random.Random(1)
    header = (f"ply\nformat binary_little_endian 1.0\ncomment units mm\ncomment frame camera\nelement vertex {count}\n"
              "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
              "property uchar blue\nproperty float sigma\nproperty ushort slit\nproperty float confidence\n"
              "property float noise\nend_header\n")
    rows = []
    for _ in range(count):
        x, y = rng.uniform(-350, 350), rng.uniform(-250, 250)
        z = 1000 + 0.0005 * (x * x + y * y) + rng.gauss(0, 0.3)
        colour = [rng.randrange(256) for _ in range(3)]
        rows.append(struct.pack("<3f3BfHff", x, y, z, *colour, 20 + 0.01 * x, 3, 1.0, 0.3))
    return header.encode() + b"".join(rows)


def at(rig: Any, path: str) -> Any:
    """The value of a rig under a name like camera.K.0.0."""
    for key in path.split("."):
        rig = rig[int(key)] if key.isdigit() else rig[key]
    return rig


def is_quiet(page: Page) -> None:
    """Nothing in the console, nothing asked of any network."""
    complaints, asked = page.complaints(), page.requests()
    assert not complaints, complaints
    assert not asked, asked


def shows_rig(page: Page, rig: Any) -> int:
    """Every number that is said to be a field of the rig is that field."""
    shown = page.run("return [...document.querySelectorAll('[data-field]')].map(e => [e.dataset.field, e.dataset.value])")
    assert len(shown) >= 20, shown
    for field, value in shown:
        assert at(rig, field) == float(value), (field, value, at(rig, field))
    return len(shown)


def places_projector(page: Page, rig: Any) -> None:
    """The page gives the projector's optical centre, which is not t."""
    rotation, t = (rig["projector_from_camera"][key] for key in ("R", "t"))
    centre = [-sum(rotation[i][k] * t[i] for i in range(3)) for k in range(3)]
    sides = [("to the left", "to the right"), ("above", "below"), ("behind", "in front")]
    expected = [(words[value > 0], abs(value)) for words, value in zip(sides, centre, strict=True)]
    shown = page.run(
        "return [...'xyz'].map(k => document.querySelector(`[data-derived=centre_${k}]`))"
        ".map(e => [e.closest('tr').querySelector('th').textContent, Number(e.dataset.value)])")
    for (side, value), (label, number) in zip(expected, shown, strict=True):
        assert label == side and math.isclose(number, value, rel_tol=1e-9), (expected, shown)


def colours(picture: bytes) -> int:
    """How many colours a picture has."""
    found = Image.open(io.BytesIO(picture)).convert("RGB").getcolors(1 << 24)
    return len(found or [])


def turns(page: Page) -> None:
    """What is in space is drawn, and drawn anew when it is turned."""
    page.run("document.getElementById('space').scrollIntoView({ block: 'center', behavior: 'instant' })")
    before = page.pixels(STAGE)
    assert colours(before) > 100, colours(before)
    page.drag(STAGE, 120, 30)
    assert page.pixels(STAGE) != before, "the view does not turn"


def steers(page: Page) -> None:
    """Keys turn what is in space, and say from where it is seen."""
    stage = page.driver.find_element("css selector", STAGE)

    def seen_from(key: str) -> tuple[float, float]:
        stage.send_keys(key)
        told = page.driver.find_element("css selector", "#space [role=status].cloud-view-heard").text
        found = re.fullmatch(r"Seen from (\d+)° to the (left|right) and (\d+)° (above|below), \d+ mm away\.", told)
        assert found, told
        return (float(found[1]) * (1 if found[2] == "left" else -1), float(found[3]) * (1 if found[4] == "above" else -1))

    first = seen_from("+")
    assert seen_from("-") == first
    left, above = seen_from(Keys.ARROW_RIGHT)
    assert abs(abs(left - first[0]) - 10) <= 1 and above == first[1], (first, left, above)
    for _ in range(20):
        high = seen_from(Keys.ARROW_UP)
    assert high == (left, 90.0), high


def chooses(page: Page) -> None:
    """Each button changes what is drawn, and says that it is pressed."""
    buttons = page.driver.find_elements("css selector", "#space [role=group][aria-label=Colour] button:not([hidden])")
    buttons += page.driver.find_elements("css selector", "#space [role=group][aria-label=Form] button")[1:]
    assert len(buttons) == 5, [b.text for b in buttons]
    last = page.pixels(STAGE)
    for button in buttons[1:]:
        button.click()
        time.sleep(1.0)
        now = page.pixels(STAGE)
        assert now != last and button.get_attribute("aria-pressed") == "true", button.text
        last = now


def chooses_plots(page: Page) -> None:
    """One of the plots of a choice is shown; no script is needed for it."""
    labels = page.driver.find_elements("css selector", "#expected-slice .chooser > label")
    plots = page.driver.find_elements("css selector", "#expected-slice .plot")
    assert len(labels) == len(plots) == 2, (len(labels), len(plots))
    for label, chosen in zip(reversed(labels), reversed(plots), strict=True):
        label.click()
        assert [p.is_displayed() for p in plots] == [p == chosen for p in plots], label.text


def readable(page: Page) -> None:
    """Letters in plots are large enough, however narrow the window is."""
    sizes = page.run(
        "return [...document.querySelectorAll('.plot svg text')].filter(t => t.getClientRects().length)"
        ".map(t => [t.textContent, parseFloat(getComputedStyle(t).fontSize) * t.getScreenCTM().a])")
    assert sizes and all(size > 9.5 for _, size in sizes), min(sizes, key=lambda s: s[1])


def plots_are_whole(page: Page) -> None:
    """No label of a plot is cut off at its side."""
    beyond = page.run(
        "return [...document.querySelectorAll('.plot svg text')].filter(t => t.getClientRects().length).filter(t => {"
        "const [a, b] = [t.getBoundingClientRect(), t.ownerSVGElement.getBoundingClientRect()];"
        "return a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 2 || a.bottom > b.bottom + 2;"
        "}).map(t => t.textContent)")
    assert not beyond, beyond


def fits_width(page: Page) -> None:
    """Neither the page nor a table in it scrolls to the side."""
    wide, window = page.run("return [document.documentElement.scrollWidth, innerWidth]")
    assert wide <= window, (wide, window)
    tables = page.run("return [...document.querySelectorAll('.scroll')].map(e => [e.closest('section').id, e.scrollWidth, e.clientWidth])")
    assert all(wide <= room for _, wide, room in tables), tables


def shown_first(page: Page) -> None:
    """The page is there to read before what is in space is drawn."""
    painted, drawn = page.run(
        "return ['first-contentful-paint', 'drawn'].map(name => performance.getEntriesByName(name)[0].startTime)")
    assert painted < drawn, (painted, drawn)


def accessible(page: Page) -> None:
    """Landmarks, one first heading, tables with scopes, plots with a text."""
    count: Callable[[str], int] = lambda what: len(page.driver.find_elements("css selector", what))
    assert count("main") == count("h1") == count("header") == count("footer") == 1
    assert count("th:not([scope])") == 0 and count("svg[role=img]:not([aria-label])") == 0
    assert count(".plot svg:not([aria-label]):not([aria-hidden])") == 0 and count("section:not([aria-labelledby])") == 0
    assert count("#space [role=application][aria-label]") == 1
    assert page.run("return document.documentElement.lang") == "en"


def prints(page: Page) -> list[Image.Image]:
    """Pages, none of them blank."""
    document = pypdfium2.PdfDocument(page.pdf())
    sheets = [document[i].render(scale=40 / 72).to_pil().convert("RGB") for i in range(len(document))]
    assert sheets
    for number, sheet in enumerate(sheets):
        assert len(sheet.getcolors(1 << 24) or []) > 2, f"page {number + 1} is blank"
    return sheets


def prints_alike(light: list[Image.Image], dark: list[Image.Image]) -> None:
    """Paper is white, whatever the screen is: nothing is printed in colours that are meant for a dark one."""
    assert len(light) == len(dark)
    for number, (a, b) in enumerate(zip(light, dark, strict=True)):
        off = sum(ImageStat.Stat(ImageChops.difference(a, b)).mean) / 3
        assert off < 1.0, f"page {number + 1} differs by {off:.1f} levels when it is printed from a dark screen"


def check(slcal: Path, folder: Path, pictures: Path | None) -> None:
    reports = Reports(slcal, folder)
    demo = reports.demo / "report.html"
    rig = json.loads((reports.demo / "rig.json").read_text())
    size = demo.stat().st_size
    assert size < DEMO_BYTES, size

    def keep(page: Page, name: str) -> None:
        if pictures:
            pictures.mkdir(parents=True, exist_ok=True)
            page.picture(pictures / f"{name}.png")

    with opened(demo) as page:
        fields = shows_rig(page, rig)
        places_projector(page, rig)
        accessible(page)
        shown_first(page)
        keep(page, "demo")
        pages = prints(page)
        plots_are_whole(page)
        chooses_plots(page)
        steers(page)
        turns(page)
        chooses(page)
        light = page.run("return getComputedStyle(document.body).backgroundColor")
        is_quiet(page)
        print(f"demo: {size / 1e6:.2f} MB, {page.seconds:.2f} s until drawn, {fields} numbers of rig.json, {len(pages)} pages")
    with opened(demo, scheme="dark") as page:
        assert page.run("return getComputedStyle(document.body).backgroundColor") != light
        prints_alike(pages, prints(page))
        keep(page, "dark")
        is_quiet(page)
    with opened(demo, size=(360, 780)) as page:
        fits_width(page)
        readable(page)
        plots_are_whole(page)
        keep(page, "phone")
        is_quiet(page)
    with opened(demo, scripts=False) as page:
        text = page.driver.find_element("css selector", "body").text
        assert "Good" in text and "3D view needs JavaScript" in text, text[:300]
        chooses_plots(page)
        assert page.driver.find_elements("css selector", "#photographs svg image")

    for name, report in [("large", reports.large()), ("cloud", reports.of_cloud()), ("bare", reports.bare())]:
        size = report.stat().st_size
        assert size < LARGE_BYTES, (name, size)
        with opened(report) as page:
            accessible(page)
            turns(page)
            keep(page, name)
            prints(page)
            is_quiet(page)
            print(f"{name}: {size / 1e6:.2f} MB, {page.seconds:.2f} s until drawn")
    with opened(reports.hostile()) as page:
        keep(page, "hostile")
        assert "hacked" != page.driver.title and HOSTILE.replace("/", "_") in page.driver.title
        assert HOSTILE in page.run("return document.getElementById('warnings').textContent")
        assert page.run("return document.querySelectorAll('body script').length") == 4
        is_quiet(page)
    print("names that would be scripts are texts")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slcal", type=Path, required=True, help="the program to test")
    parser.add_argument("--pictures", type=Path, help="a folder for screenshots")
    args = parser.parse_args()
    if chromium() is None:
        print("skipped: chromium and chromedriver are not both installed")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        check(args.slcal.resolve(), Path(folder), args.pictures)
    return 0


if __name__ == "__main__":
    sys.exit(main())
