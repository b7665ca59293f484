"""Checks of the whole way with the simulated projector, camera and sheet, in the pages."""

from __future__ import annotations

import base64
import io
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from studio_bench import Bench, agrees_with_truth, calibrated_from, quiet, sphere_radius
from studio_pages import DESK, PHONE, Browser, Keys, Operator, Window, browser, selected
from studio_server import Studio, wait_until

MOST_CLICKS = 10
MOST_SECONDS = 120
RADIUS_MM = 180.0
RADIUS_SHARE = 0.005
SHEET_MM = (594.0, 420.0)
SLACK = 0.015
DISC_PICTURE = (1200, 800)
DISCS = ((240, 160), (960, 160), (960, 640), (240, 640))
"""As the sides of the picture, a rectangle of its shape."""
TABS = 80
"""More presses of Tab than any step has controls."""
CONTROLS = {"button", "link", "textbox", "slider", "checkbox", "radio", "combobox", "spinbutton", "searchbox", "switch", "DisclosureTriangle"}


def sphere_is_right(bench: Bench, cloud: Path) -> float:
    radius = sphere_radius(cloud)
    assert abs(radius / RADIUS_MM - 1.0) < RADIUS_SHARE, radius
    return radius


def turned_and_taken(studio: Studio, page: Operator, count: int) -> Any:
    """The sheet is turned by the page's button; the photograph is taken by itself."""
    page.press("turn-for-me")
    return studio.wait(f"photograph {count}, taken by itself, and a calibration", lambda s: calibrated_from(s, count), 40)


def two_photographs_give_a_rig_and_a_cloud_in_ten_clicks(bench: Bench, b: Browser) -> None:
    with bench.studio("demo", "--demo") as studio, quiet(b, studio):
        start = time.monotonic()
        page = b.window(studio.link("operator"))
        page.pictures = bench.pictures
        page.wait_for(selected("open-display"))
        page.keep("1-set-up")
        display = b.opened_by(lambda: page.press("open-display"))
        page.wait_for(selected("go-on", step="calibrate"))
        page.keep("2-display-open")
        page.press("go-on", step="calibrate")
        page.wait_for("[data-state=ghost-words]")
        page.keep("3-calibrate")
        turned_and_taken(studio, page, 1)
        page.keep("4-one-photograph")
        turned_and_taken(studio, page, 2)
        page.wait_for(selected("go-on", step="scan"))
        page.keep("5-two-photographs")
        assert page.value("verdict") == studio.state()["calibration"]["verdict"] == "good"
        assert page.run("return document.querySelectorAll('[data-state=photograph][data-value=used]').length") == 2
        off = agrees_with_truth(studio.folder / "rig.json", studio.folder / "truth_rig.json")
        to_rig = time.monotonic() - start
        page.press("go-on", step="scan")
        page.press("scan", mode="once")
        studio.wait("a cloud", lambda s: s["scan"]["clouds"] and not s["busy"])
        shown = cloud_is_drawn(page)
        seconds, clicks = time.monotonic() - start, page.clicks
        page.keep("6-cloud")
        radius = sphere_is_right(bench, studio.folder / "scan-001.ply")
        bench.figure(f"demo: {clicks} clicks and {to_rig:.0f} s to the rig, {seconds:.0f} s to the cloud of {shown} points"
                     f"{' (screenshots included)' if bench.pictures else ''}; sphere {radius:.2f} mm; off the truth by "
                     + ", ".join(f"{name} {value:+.1f} σ" for name, value in off.items()))
        assert clicks <= MOST_CLICKS and (bench.pictures or seconds < MOST_SECONDS), (clicks, seconds)

        scans_continuously(bench, studio, page)
        used(bench, studio, page, display)
        assert page.clicks <= MOST_CLICKS + 4, page.clicks


def cloud_is_drawn(page: Operator) -> int:
    """The cloud is there to see, and turns. The number of its points as the page says it."""
    wait_until("the cloud's figures", lambda: page.run("return document.querySelector('[data-state=cloud-figures]')?.dataset.points ?? null"))
    page.wait_for(".cloud-place canvas")
    before = wait_until("a cloud in colours", lambda: colourful(page.pixels(".cloud-place canvas")))
    page.drag(".cloud-place canvas", 120, 30)
    wait_until("the cloud turns", lambda: page.pixels(".cloud-place canvas") != before)
    return int(page.run("return Number(document.querySelector('[data-state=cloud-figures]').dataset.points)"))


def colourful(picture: bytes) -> bytes | None:
    found = Image.open(io.BytesIO(picture)).convert("RGB").getcolors(1 << 24)
    return picture if len(found or []) > 100 else None


def scans_continuously(bench: Bench, studio: Studio, page: Operator) -> None:
    """Clouds come one after the other; the last one is kept."""
    page.press("scan", mode="start")
    studio.wait("the first live clouds", lambda s: s["scan"]["live"] and s["scan"]["live"]["sequence"] >= 3 and s["scan"]["fps"] > 0)
    assert wait_until("the page says that it is live", lambda: page.value("cloud-figures") == "live")
    before, since = studio.state()["scan"]["live"]["sequence"], time.monotonic()
    first = page.pixels(".cloud-place canvas")
    time.sleep(3.0)
    state = studio.state()
    rate = (state["scan"]["live"]["sequence"] - before) / (time.monotonic() - since)
    page.keep("7-continuous")
    assert page.pixels(".cloud-place canvas") != first, "the cloud is drawn anew"
    page.press("scan", mode="stop")
    state = studio.wait("the last cloud is kept", lambda s: len(s["scan"]["clouds"]) == 2 and not s["busy"])
    assert not state["scan"]["continuous"] and state["scan"]["live"] is None
    sphere_is_right(bench, studio.folder / "scan-002.ply")
    begun = time.monotonic()
    bench.run("reconstruct", "--rig", studio.folder / "rig.json", "--pattern", studio.folder / "stripes.json",
              studio.folder / "scan-002.jpg", "--mesh", "-o", bench.folder / "once.ply")
    bench.figure(f"continuous scan: {rate:.1f} clouds per second with simulated frames; "
                 f"slcal reconstruct takes {time.monotonic() - begun:.2f} s for one, with start and files")
    for form in ("ply", "glb", "pcd", "obj"):
        saved = studio.request("GET", f"/api/clouds/2.{form}", role="operator")
        assert saved.status == 200 and "attachment" in saved.headers["content-disposition"] and len(saved.body) > 1000, form
    assert len(page.run("return [...document.querySelectorAll('[data-action=save]')].map(a => a.href)")) == 8


def used(bench: Bench, studio: Studio, page: Operator, display: Window) -> None:
    """A picture is projected, the rig exported, the report read."""
    page.press("go-on", step="use")
    page.press("test-picture")
    studio.wait("the test picture on the display", lambda s: s["use"]["picture"] and shows(s, "picture"))
    page.keep("8-use")
    own = bench.folder / "own picture.png"
    disc_picture().save(own)
    page.front()
    page.driver.find_element("css selector", selected("picture-file")).send_keys(str(own))
    studio.wait("the own picture on the display", lambda s: s["use"]["picture"] == own.name and shows(s, "picture"))
    painted = Image.open(studio.folder / "picture.png").convert("RGB")
    assert painted.size == (1024, 768)
    seen = Image.open(io.BytesIO(canvas_of(display))).convert("RGB")
    assert seen.size == painted.size and seen.tobytes() == painted.tobytes(), "the display shows the picture pixel for pixel"
    wrong = [""]
    try:
        wait_until("the picture straight on the sheet", lambda: not lies_with_keystone(studio, wrong), 15)
    except AssertionError as error:
        raise AssertionError(f"{error}: {wrong[0]}") from None
    report = page.wait_for(selected("report"))
    opened = b_opened(page, report.click)
    opened.wait_for("h1")
    assert "rig.json" in opened.words(), opened.words()
    for form in ("opencv", "npz", "blender"):
        page.press("export", format=form)
    studio.wait("exports in the folder", lambda s: (studio.folder / "export-blender").exists() and s["use"]["exported"])
    assert (studio.folder / "export-opencv").is_dir() and (studio.folder / "export-npz").is_dir()


def b_opened(page: Window, press: Any) -> Window:
    return Browser(page.driver).opened_by(press)


def shows(state: Any, kind: str) -> bool:
    """Whether the display has painted what it should, and that is of a kind."""
    display = state["display"]
    return bool(display["wanted"]["kind"] == kind and display["painted"] == display["wanted"]["sequence"] and not state["busy"])


def canvas_of(display: Window) -> bytes:
    """What the display page painted, as PNG."""
    url = display.run("return document.getElementById('panel').toDataURL('image/png')")
    return base64.b64decode(url.split(",")[1])


def disc_picture() -> Image.Image:
    """A picture for the sheet with discs at known places."""
    picture = Image.new("RGB", DISC_PICTURE, (250, 250, 250))
    draw = ImageDraw.Draw(picture)
    for x, y in DISCS:
        draw.ellipse((x - 50, y - 50, x + 50, y + 50), fill=(200, 30, 30))
    return picture


def lies_with_keystone(studio: Studio, wrong: list[str]) -> bool:
    """On the sheet, as the simulated camera sees it, the discs of the picture should be the corners of an upright rectangle of its shape."""
    answer = studio.request("GET", "/api/live.jpg", role="operator")
    picture = np.asarray(Image.open(io.BytesIO(answer.body)).convert("RGB")).astype(int)
    red = (picture[:, :, 0] > 1.8 * picture[:, :, 1]) & (picture[:, :, 0] > 60)
    y, x = np.nonzero(red)
    wrong[0] = f"{len(x)} red pixels"
    if len(x) < 400:
        return True
    low, right = y > y.mean(), x > x.mean()
    middles = [(x[part].mean(), y[part].mean()) for part in (~low & ~right, ~low & right, low & right, low & ~right)]
    corners = on_the_sheet(studio.state()["photographs"][-1], picture.shape[1], middles)
    width, height = corners[1] - corners[0], corners[3] - corners[0]
    side = float(np.linalg.norm(width))
    shape = side / float(np.linalg.norm(height)) / (DISC_PICTURE[0] / DISC_PICTURE[1])
    wrong[0] = f"discs at {corners.round(1).tolist()} mm, shape {shape:.3f} times that of the picture"
    # Nothing leans, nothing is stretched, by a pixel of the live picture or so.
    return bool(np.abs(corners[2] - corners[3] - width).max() > SLACK * side or abs(width[1]) > SLACK * side
                or abs(height[0]) > SLACK * side or abs(shape - 1) > SLACK)


def on_the_sheet(photo: Any, width: int, places: list[tuple[float, float]]) -> NDArray[np.float64]:
    """Places of a picture of this width in mm on the sheet, by the outline that was found in a photograph."""
    rows: list[list[float]] = []
    known: list[float] = []
    scale = width / photo["size"][0]
    corners = [(0.0, 0.0), (SHEET_MM[0], 0.0), SHEET_MM, (0.0, SHEET_MM[1])]
    for (u, v), (px, py) in zip(corners, photo["outline"], strict=True):
        x, y = (px + 0.5) * scale - 0.5, (py + 0.5) * scale - 0.5
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
        known += [u, v]
    h = np.append(np.linalg.solve(np.array(rows), np.array(known)), 1.0).reshape(3, 3)
    found = np.c_[np.array(places), np.ones(len(places))] @ h.T
    return np.asarray(found[:, :2] / found[:, 2:])


def tab_to(page: Window, selector: str) -> None:
    """Moves the focus by Tab alone."""
    page.wait_for_still(selector)
    for _ in range(TABS):
        if page.run("return document.activeElement.matches(arguments[0])", selector):
            # The focus can be seen.
            assert page.run("return document.activeElement.matches(':focus-visible')"), selector
            return
        page.keys(Keys.TAB)
    raise AssertionError(f"not reached by {TABS} times Tab: {selector}")


def has_no_sideways_scrolling(page: Window) -> None:
    wide, window = page.run("return [document.documentElement.scrollWidth, innerWidth]")
    over = page.run("return [...document.querySelectorAll('body *')]"
                    ".filter(e => e.getBoundingClientRect().right > innerWidth + 1 && e.checkVisibility())"
                    ".slice(0, 5).map(e => e.outerHTML.slice(0, 120))") if wide > window else []
    assert wide <= window, (wide, window, over)


def is_told_to_screen_readers(page: Window) -> None:
    """Every control has a name, and the attribute by which tests find it."""
    nameless = [role for role, name in page.accessible() if role in CONTROLS and not name.strip()]
    assert not nameless, nameless
    unmarked = page.run(
        "return [...document.querySelectorAll('button, a[href], input, select, textarea')]"
        ".filter(e => e.checkVisibility() && !e.dataset.action).map(e => e.outerHTML.slice(0, 120))")
    assert not unmarked, unmarked
    count = "return [document.querySelectorAll('main').length, document.querySelectorAll('h1').length, document.documentElement.lang]"
    assert page.run(count) == [1, 1, "en"]
    for state in ("sentence", "next", "command", "step"):
        assert page.run("return !!document.querySelector(`[data-state=${arguments[0]}]`)", state), state
    assert page.run("return !!document.querySelector('[data-state=sentence]').closest('[aria-live=polite]')")


def a_phone_and_the_keyboard_suffice(bench: Bench, b: Browser) -> None:
    """The same way in a narrow window, in dark colours, with Tab, Enter and Space."""
    with bench.studio("keyboard", "--demo") as studio, quiet(b, studio):
        page = b.window(studio.link("operator"), PHONE)
        page.scheme("dark")

        def fits() -> None:
            has_no_sideways_scrolling(page)
            is_told_to_screen_readers(page)

        tab_to(page, selected("open-display"))
        fits()
        display = b.opened_by(lambda: page.keys(Keys.ENTER))
        tab_to(page, selected("go-on", step="calibrate"))
        page.keys(Keys.ENTER)
        for count, key in ((1, Keys.SPACE), (2, Keys.ENTER)):
            tab_to(page, selected("turn-for-me"))
            fits()
            page.keys(key)
            studio.wait(f"photograph {count}", lambda s: calibrated_from(s, count), 40)
        tab_to(page, selected("go-on", step="scan"))
        fits()
        page.keys(Keys.ENTER)
        tab_to(page, selected("scan", mode="once"))
        page.keys(Keys.SPACE)
        studio.wait("a cloud", lambda s: s["scan"]["clouds"] and not s["busy"])
        page.wait_for(".cloud-place canvas")
        fits()
        # Space takes a photograph where no control has the focus.
        page.run("document.activeElement.blur()")
        page.keys(Keys.SPACE)
        studio.wait("a second cloud", lambda s: len(s["scan"]["clouds"]) == 2 and not s["busy"])
        tab_to(page, selected("go-on", step="use"))
        page.keys(Keys.ENTER)
        tab_to(page, selected("test-picture"))
        page.keys(Keys.ENTER)
        studio.wait("a picture", lambda s: s["use"]["picture"] and shows(s, "picture"))
        fits()
        # Back, by the steps themselves.
        tab_to(page, selected("step", step="calibrate"))
        page.keys(Keys.SPACE)
        studio.wait("step calibrate", lambda s: s["step"] == "calibrate")
        sheet_follows_the_arrow_keys(studio, page)
        agrees_with_truth(studio.folder / "rig.json", studio.folder / "truth_rig.json")
        has_no_sideways_scrolling(display)


def sheet_follows_the_arrow_keys(studio: Studio, page: Window) -> None:
    before = studio.state()["demo_scene"]["tilt_deg"]
    tab_to(page, "[data-state=picture]")
    page.keys(Keys.ARROW_RIGHT, Keys.ARROW_DOWN)
    studio.wait("the sheet turns", lambda s: all(abs(now - old) > 1.0 for now, old in zip(s["demo_scene"]["tilt_deg"], before, strict=True)))


def a_photograph_can_be_thrown_out_and_taken_again(bench: Bench, b: Browser) -> None:
    with bench.calibrated("out") as studio, quiet(b, studio):
        page = b.window(studio.link("operator"))
        page.press("step", step="calibrate")
        value = studio.state()["calibration"]["figures"][0]["value"]
        page.press("photograph", id="1")
        studio.wait("a calibration from one", lambda s: calibrated_from(s, 1))
        page.wait_for("[data-state=photograph][data-id='1'][data-value=out]")
        page.press("photograph", id="1")
        state = studio.wait("a calibration from two", lambda s: calibrated_from(s, 2))
        assert abs(state["calibration"]["figures"][0]["value"] / value - 1) < 1e-6


def watchers_see_the_same_and_change_nothing(bench: Bench, b: Browser) -> None:
    studio = bench.finished
    with quiet(b, studio), browser() as elsewhere, quiet(elsewhere, studio):
        page = b.window(studio.link("operator"))
        other = elsewhere.window(studio.link("watcher"))
        for step in ("calibrate", "scan", "use", "calibrate"):
            page.press("step", step=step)
            wait_until(f"the watcher is at {step}", lambda: other.run("return document.getElementById('page').dataset.step") == step)
            for part in ("sentence", "command"):
                wait_until(f"the same {part}", lambda: page.text(f"[data-state={part}]") == other.text(f"[data-state={part}]"))
            assert page.text("[data-state=next]") and not other.text("[data-state=next]"), "only who operates is told what to do"
        assert other.value("role") == "watcher" and "watching" in other.text("[data-state=role]")
        assert other.run("return document.querySelectorAll('[data-state=photograph]').length") == 2
        wait_until("the operator sees the watcher", lambda: "1 watcher" in page.text("[data-state=others]"))
        before = studio.state()
        for step in ("set-up", "calibrate", "scan", "use"):
            page.press("step", step=step)
            wait_until(f"the watcher is at {step}", lambda: other.run("return document.getElementById('page').dataset.step") == step)
            at = studio.state()
            harmless = {"copy", "look", "live-picture", "cloud", "save", "report", "export", "files", "picture-file"}
            actions = other.run("return [...document.querySelectorAll('[data-action]')].filter(e => e.checkVisibility()).map(e => e.dataset.action)")
            for action in sorted(set(actions)):
                if action in harmless:
                    continue
                for control in other.driver.find_elements("css selector", selected(action)):
                    if control.is_displayed() and control.is_enabled() and control.tag_name in {"button", "input", "label"}:
                        other.run("arguments[0].click()", control)
            other.keys(Keys.SPACE)
            time.sleep(0.2)
            assert studio.state() == at, step
        page.press("step", step=before["step"])
        studio.wait("as before", lambda s: s["step"] == before["step"])


def a_second_operator_takes_over(bench: Bench, b: Browser) -> None:
    studio = bench.finished
    with quiet(b, studio), browser() as elsewhere, quiet(elsewhere, studio):
        page = b.window(studio.link("operator"))
        page.wait_for(selected("step", step="calibrate"))
        wait_until("the first operates", lambda: page.value("role") == "operating")
        other = elsewhere.window(studio.link("operator"))
        other.pictures = bench.pictures
        wait_until("the second waits", lambda: other.value("role") == "waiting")
        assert "Someone else operates" in other.words()
        other.keep("9-someone-else")
        step = studio.state()["step"]
        elsewhere_step = "calibrate" if step != "calibrate" else "scan"
        other.run("document.querySelector(arguments[0]).click()", selected("step", step=elsewhere_step))
        time.sleep(0.3)
        assert studio.state()["step"] == step
        other.press("take-over")
        wait_until("the second operates", lambda: other.value("role") == "operating")
        wait_until("the first sees it", lambda: page.value("role") == "waiting")
        other.press("step", step=elsewhere_step)
        studio.wait("the second's step", lambda s: s["step"] == elsewhere_step)
        # Who leaves hands back.
        other.close()
        wait_until("the first operates again", lambda: page.value("role") == "operating")
        page.press("step", step=step)
        studio.wait("as before", lambda s: s["step"] == step)


def pages_come_back_after_the_studio_was_killed(bench: Bench, b: Browser) -> None:
    refused = ("ERR_CONNECTION_REFUSED", "ERR_CONNECTION_RESET", "ERR_EMPTY_RESPONSE", "WebSocket connection to", "403 (Forbidden)")
    with bench.calibrated("came-back") as studio:
        with quiet(b, studio, *refused):
            page = b.window(studio.link("operator"))
            page.wait_for(selected("step", step="calibrate"))
            studio.kill()
            wait_until("the page says that it is lost", lambda: page.value("connection") == "lost")
            page.pictures = bench.pictures
            page.keep("10-lost")
            with bench.studio("came-back", port=studio.port) as again:
                wait_until("the page says that the studio is another", lambda: page.value("connection") == "ended", 30)
                page.keep("11-ended")
                page.open(again.link("operator"))
                page.wait_for("#page[data-step=scan]")
                again.wait("the calibration of before", lambda s: calibrated_from(s, 2))
                wait_until("the clouds of before", lambda: page.run("return document.querySelectorAll('[data-state=cloud-file]').length") == 1)


def tokens_do_not_stay_in_the_address(bench: Bench, b: Browser) -> None:
    studio = bench.finished
    with quiet(b, studio, "403 (Forbidden)"):
        page = b.window(studio.link("watcher"))
        page.wait_for(selected("step", step="calibrate"))
        assert page.driver.current_url == f"{studio.origin}/", page.driver.current_url
        page.driver.refresh()
        page.wait_for(selected("step", step="calibrate"))
        stored = page.run("return document.documentElement.outerHTML + JSON.stringify([localStorage, sessionStorage, document.cookie])")
        assert studio.token("watcher") not in stored
        page.driver.delete_all_cookies()
        page.run("sessionStorage.clear()")
        page.driver.refresh()
        wait_until("the page says how to get in", lambda: page.value("no-session"))
        assert "address that slcal studio printed" in page.words(), page.words()
        page.open(f"{studio.origin}/#{'0' * 32}")
        wait_until("the page refuses a wrong address", lambda: page.value("no-session") == "token-wrong")
        assert not any(studio.token(role) in url for role in ("operator", "watcher", "display") for url in b.asked if "#" not in url)


def wrong_files_are_explained_in_the_page(bench: Bench, b: Browser) -> None:
    large, text, small = bench.folder / "large.jpg", bench.folder / "notes.jpg", bench.folder / "small.png"
    large.write_bytes(b"\xff\xd8\xff\xe0\0\x10JFIF" + bytes(55 << 20))
    text.write_text("a text file\n" * 50)
    Image.open(bench.sheets()[1]).resize((1000, 750)).save(small)
    with bench.calibrated("wrong") as studio, quiet(b, studio, "415"):
        page = b.window(studio.link("operator"))
        page.press("step", step="calibrate")
        studio.wait("step calibrate", lambda s: s["step"] == "calibrate")
        page.front()
        files = page.driver.find_element("css selector", selected("files"))
        files.send_keys(f"{large}\n{text}\n{small}")
        page.wait_for("[data-state=problem][data-value=too-large]")
        page.wait_for("[data-state=problem][data-value=not-a-picture]")
        wait_until("the tile says what is wrong", lambda: "1000" in page.text("[data-state=photograph][data-id='3'][data-value=refused]"))
        page.pictures = bench.pictures
        page.keep("12-wrong-files")
        assert len(list(studio.folder.glob("sheet-*"))) == 3
        page.metrics(PHONE, phone=True)
        has_no_sideways_scrolling(page)
        page.metrics(DESK)


CHECKS = (
    two_photographs_give_a_rig_and_a_cloud_in_ten_clicks, a_phone_and_the_keyboard_suffice, a_photograph_can_be_thrown_out_and_taken_again,
    watchers_see_the_same_and_change_nothing, a_second_operator_takes_over, pages_come_back_after_the_studio_was_killed,
    tokens_do_not_stay_in_the_address, wrong_files_are_explained_in_the_page,
)
