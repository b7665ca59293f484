"""Checks with a webcam and a projector that the browser believes in: a video file, and screens that it draws nowhere."""

from __future__ import annotations

import io
import statistics
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from studio_bench import PANEL, SHEET, Bench, agrees_with_truth, calibrated_from, quiet, sphere_radius
from studio_demo import canvas_of
from studio_pages import Browser, Operator, Window, browser, selected
from studio_server import Skipped, Socket, Studio, wait_until

LAPTOP, PROJECTOR = (1280, 800), (1024, 768)
TWO_SCREENS = "{1280x800 label=Laptop}{1280,0 1024x768 label=Projector}"
SCREENS = TWO_SCREENS + "{0,800 1280x960 devicePixelRatio=1.25 label=Scaled}{1280,800 1280x720 label=Other}"
SCALED_AT, OTHER_AT = (100, 900), (1400, 900)
FPS = 10
FRAMES = 25
"""Live frames of which the delay is measured."""


class FakeCamera:
    """A video of one frame, which can be exchanged while it is played."""

    def __init__(self, path: Path, size: tuple[int, int] = (1280, 960)) -> None:
        self.path, self.size = path, size
        self.path.write_bytes(self._video(Image.new("RGB", size, (60, 60, 60))))

    def _video(self, picture: Image.Image) -> bytes:
        assert picture.size == self.size
        rgb = np.asarray(picture.convert("RGB")).astype(np.float64)
        red, green, blue = rgb[:, :, 0], rgb[:, :, 1], rgb[:, :, 2]
        luma = 0.299 * red + 0.587 * green + 0.114 * blue

        def half(plane: NDArray[np.float64]) -> NDArray[np.float64]:
            return (plane[::2, ::2] + plane[1::2, ::2] + plane[::2, 1::2] + plane[1::2, 1::2]) / 4

        planes = (16 + luma * 219 / 255, 128 + half(blue - luma) * 112 / 226, 128 + half(red - luma) * 112 / 179)
        head = f"YUV4MPEG2 W{self.size[0]} H{self.size[1]} F{FPS}:1 Ip A1:1 C420jpeg\nFRAME\n"
        return head.encode() + b"".join(np.clip(np.rint(plane), 0, 255).astype(np.uint8).tobytes() for plane in planes)

    def sees(self, picture: Path) -> None:
        """From now on."""
        with Image.open(picture) as opened, self.path.open("r+b") as file:
            file.write(self._video(opened))

    def is_taken_away(self) -> None:
        """The browser finds no frame any more."""
        with self.path.open("r+b") as file:
            file.truncate(100)


@contextmanager
def with_camera(bench: Bench, name: str, screens: str = TWO_SCREENS) -> Iterator[tuple[Browser, FakeCamera]]:
    """A browser with a webcam, beside whose screen stands a projector."""
    camera = FakeCamera(bench.folder / f"{name}.y4m")
    with browser("--use-fake-device-for-media-stream=device-count=1", "--use-fake-ui-for-media-stream",
                 f"--use-file-for-fake-video-capture={camera.path}", f"--screen-info={screens}") as b:
        yield b, camera


def has_two_screens(page: Window) -> None:
    """Only pages of the studio are told: about:blank is no secure context."""
    if not page.run("return screen.isExtended"):
        raise Skipped("this browser does not know --screen-info")


def in_full_screen(b: Browser, studio: Studio, page: Operator) -> Window:
    """The display window, opened by its button, on the projector."""
    page.wait_for(selected("open-display"))
    has_two_screens(page)
    # What is not named is denied, also to a camera that is open already.
    b.driver.execute_cdp_cmd("Browser.grantPermissions", {"permissions": ["windowManagement", "videoCapture"], "origin": studio.origin})
    display = b.opened_by(lambda: page.press("open-display"))
    display.wait_for("#full-screen")
    display.keys("f")
    studio.wait("the display fills the projector", lambda s: s["display"]["measured"] and s["display"]["measured"]["fullscreen"])
    return display


def shown_pixels(display: Window) -> Image.Image:
    """What is on the screen of the display window."""
    return Image.open(io.BytesIO(display.picture())).convert("RGB")


def is_pixel_for_pixel(display: Window, pattern: Path) -> None:
    wanted = Image.open(pattern).convert("RGB")

    def same() -> bool:
        seen = shown_pixels(display)
        return seen.size == wanted.size and seen.tobytes() == wanted.tobytes()

    wait_until(f"{pattern.name} pixel for pixel", same, 10)


def a_webcam_and_a_projector_give_a_rig(bench: Bench) -> None:
    with with_camera(bench, "webcam") as (b, camera), bench.studio("webcam") as studio, quiet(b, studio):
        page = b.window(studio.link("operator"))
        page.pictures = bench.pictures
        display = in_full_screen(b, studio, page)
        measured = studio.state()["display"]["measured"]
        assert measured["screen"] == measured["viewport"] == list(PROJECTOR), measured
        page.press("use-measured")
        studio.wait("the projector's pixels", lambda s: s["set_up"]["projector"] == list(PROJECTOR))
        size = page.wait_for("#size")
        size.send_keys(SHEET, "\n")
        studio.wait("the sheet's size", lambda s: s["set_up"]["size"] == SHEET)
        page.press("camera", kind="webcam")
        state = studio.wait("the webcam", lambda s: s["camera"]["connected"])
        assert state["camera"]["kind"] == "webcam" and state["camera"]["size"] == [1280, 960], state["camera"]
        page.wait_for_text("[data-state=size]", "1280x960")
        shows_corner_marks(display)
        page.keep("20-webcam-set-up")
        page.press("go-on", step="calibrate")
        studio.wait("the checkerboard", lambda s: s["display"]["wanted"]["kind"] == "checker" and painted(s))
        is_pixel_for_pixel(display, studio.folder / "checker.png")
        assert "sheet" in page.wait_for("[data-state=picture-problem]").text, "a grey picture has no sheet"
        takes_by_hand(studio, page)
        first, second = bench.sheets()
        camera.sees(first)
        corners = sees_corners(page)
        page.keep("21-webcam-sheet")
        outline_lies_on_the_sheet(page, first)
        page.run("document.activeElement.blur()")
        page.keys(" ")
        state = studio.wait("the first photograph", lambda s: calibrated_from(s, 1))
        is_full_size(studio.folder / state["photographs"][0]["name"])
        assert state["photographs"][0]["corners"] >= 0.8 * state["photographs"][0]["of"], state["photographs"][0]
        camera.sees(second)
        time.sleep(1.0)
        page.press("take")
        state = studio.wait("the second photograph", lambda s: calibrated_from(s, 2))
        is_full_size(studio.folder / state["photographs"][1]["name"])
        off = agrees_with_truth(studio.folder / "rig.json", first.with_name("rig.json"))
        page.keep("22-webcam-calibrated")
        delays = delays_in_the_page(page)
        bench.figure(f"webcam: {corners} corners over the live picture; overlay behind the picture by {spread(delays)} in the page, "
                     "encoding included; off the truth by " + ", ".join(f"{name} {value:+.1f} σ" for name, value in off.items()))
        page.press("go-on", step="scan")
        camera.sees(bench.sphere())
        studio.wait("the stripes", lambda s: s["display"]["wanted"]["kind"] == "stripes" and painted(s))
        is_pixel_for_pixel(display, studio.folder / "stripes.png")
        time.sleep(0.5)
        page.press("scan", mode="once")
        studio.wait("a cloud", lambda s: s["scan"]["clouds"] and not s["busy"])
        radius = sphere_radius(studio.folder / "scan-001.ply")
        assert abs(radius / 180.0 - 1.0) < 0.005, radius
        page.press("scan", mode="start")
        state = studio.wait("live clouds", lambda s: s["scan"]["live"] and s["scan"]["live"]["sequence"] >= 5)
        time.sleep(1.5)
        bench.figure(f"webcam: sphere {radius:.2f} mm; continuous scan {studio.state()['scan']['fps']:.1f} clouds per second "
                     f"from a camera of {FPS} frames per second")
        page.press("scan", mode="stop")
        studio.wait("the last cloud is kept", lambda s: len(s["scan"]["clouds"]) == 2 and not s["busy"])


def takes_by_hand(studio: Studio, page: Operator) -> None:
    """Photographs are not taken by themselves any more."""
    page.wait_for(f"{selected('auto-shot')}:checked").click()
    studio.wait("photographs by hand", lambda s: not s["auto_shot"])


def painted(state: Any) -> bool:
    display = state["display"]
    return bool(display["painted"] == display["wanted"]["sequence"] and not display["problem"])


def sees_corners(page: Operator) -> int:
    """How many corners are drawn over the live picture."""
    def count() -> int:
        return int(page.run("return Number(document.querySelector('path[data-state=corners]')?.dataset.count ?? 0)"))

    try:
        return wait_until("the corners over the live picture", count, 20)
    except AssertionError as error:
        raise AssertionError(f"{error}\n    {page.words()}") from None


def is_full_size(photo: Path) -> None:
    with Image.open(photo) as picture:
        assert picture.size == (1280, 960), picture.size


def outline_lies_on_the_sheet(page: Operator, photo: Path) -> None:
    """The outline that is drawn surrounds what the rendering says is the sheet."""
    surface = np.asarray(Image.open(photo.with_name("truth_surface.png")))
    y, x = np.nonzero(surface == 1)
    true = (x.min(), y.min(), x.max(), y.max())
    drawn = page.run("const p = [...document.querySelector('polygon[data-state=sheet]').points];"
                     "const [x, y] = [p.map(q => q.x), p.map(q => q.y)];"
                     "return [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)]")
    box = page.run("const v = document.querySelector('svg.overlay').viewBox.baseVal; return [v.width, v.height]")
    scale = 1280 / box[0]
    assert all(abs((d + 0.5) * scale - 0.5 - t) < 3 for d, t in zip(drawn, true, strict=True)), (drawn, box, true)


def shows_corner_marks(display: Window) -> None:
    picture = shown_pixels(display)
    assert picture.size == PROJECTOR
    corners = [picture.getpixel((x, y)) for x in (0, PROJECTOR[0] - 1) for y in (0, PROJECTOR[1] - 1)]
    assert all(corner == (255, 255, 255) for corner in corners), corners


TIMED = """
if (window.OffscreenCanvas && !window.slcalDelays) {
    const begun = [], bySeq = new Map();
    window.slcalDelays = [];
    const convert = OffscreenCanvas.prototype.convertToBlob;
    OffscreenCanvas.prototype.convertToBlob = function (...all) { begun.push(performance.now()); return convert.apply(this, all); };
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (data) {
        if (data instanceof Blob) {
            const at = begun.pop();
            begun.length = 0;
            data.slice(0, 4).arrayBuffer().then((b) => bySeq.set(new DataView(b).getUint32(0, true), at));
            if (!this.slcalTimed) {
                this.slcalTimed = true;
                this.addEventListener("message", ({ data }) => {
                    const m = JSON.parse(data);
                    if (m.type === "live" && bySeq.has(m.live.seq)) window.slcalDelays.push(performance.now() - bySeq.get(m.live.seq));
                });
            }
        }
        return send.call(this, data);
    };
}
"""


def delays_in_the_page(page: Operator) -> list[float]:
    """From the moment at which a live frame was drawn to its answer, ms."""
    page.run(TIMED)

    def enough() -> list[float] | None:
        delays: list[float] = page.run("return window.slcalDelays")
        return delays if len(delays) >= FRAMES else None

    return wait_until("live frames are answered", enough)


def spread(delays: list[float]) -> str:
    return f"{statistics.median(delays):.0f} ms (median of {len(delays)}, at most {max(delays):.0f} ms)"


def displays_that_would_scale_are_refused(bench: Bench) -> None:
    with with_camera(bench, "scaled", SCREENS) as (b, _), bench.real("scaled") as studio, quiet(b, studio):
        page = b.window(studio.link("operator"))
        page.press("camera", kind="webcam")
        studio.wait("the webcam", lambda s: s["camera"]["connected"])
        display = in_full_screen(b, studio, page)
        page.press("go-on", step="calibrate")
        studio.wait("the checkerboard", painted)
        is_pixel_for_pixel(display, studio.folder / "checker.png")
        page.pictures = bench.pictures
        for name, at, code, size in (("scaled", SCALED_AT, "display-scaled", "1280x960"), ("other", OTHER_AT, "display-size", "1280x720")):
            display.keys("f")
            wait_until("not full screen", lambda: not display.run("return !!document.fullscreenElement"))
            studio.wait("refused in a window", lambda s: s["display"]["problem"])
            wait_until("no part of the pattern in a window", lambda: not has_pattern(display))
            move(display, at)
            display.keys("f")
            state = studio.wait(f"refused: {code}", lambda s: (s["display"]["problem"] or {}).get("code") == code)
            problem = state["display"]["problem"]
            assert size in problem["message"] and PANEL in problem["message"] and problem["advice"], problem
            page.wait_for_text("body", size)
            wait_until("the display page says why", lambda: display.run("return document.getElementById('card').dataset.code ?? null") == code)
            assert "Not shown" in display.words() and size in display.words(), display.words()
            assert not has_pattern(display), "the pattern is still on the display"
            if bench.pictures:
                (bench.pictures / f"30-display-{name}.png").write_bytes(display.picture())
                page.keep(f"31-refused-{name}")
            with studio.socket("operator") as other:
                other.send("take-over")
                other.send("take")
                problem = other.receive("refused")["problem"]
                assert problem["code"] == code, problem
            wait_until("the page operates again", lambda: page.value("role") == "operating")
        move(display, (1400, 100))
        display.keys("f")
        wait_until("full screen on the projector", lambda: display.run("return !!document.fullscreenElement"))
        studio.wait("the checkerboard again", painted)
        is_pixel_for_pixel(display, studio.folder / "checker.png")
        assert not studio.state()["photographs"]


def move(display: Window, at: tuple[int, int]) -> None:
    """Drags a window to another screen."""
    if display.run("return !!document.fullscreenElement"):
        display.keys("f")
        wait_until("not full screen", lambda: not display.run("return !!document.fullscreenElement"))
    window = display.cdp("Browser.getWindowForTarget")["windowId"]
    display.cdp("Browser.setWindowBounds", windowId=window, bounds={"left": at[0], "top": at[1], "width": 600, "height": 400})
    wait_until("the window has moved", lambda: display.run("return screenX === arguments[0] || innerWidth <= 750", at[0]))


def has_pattern(display: Window) -> bool:
    """Whether anything bright can be seen, but for words."""
    if display.run("return getComputedStyle(document.getElementById('panel')).visibility") == "hidden":
        return False
    painted = Image.open(io.BytesIO(canvas_of(display))).convert("L")
    return bool(np.asarray(painted).max() > 0)


def zoomed_displays_are_exact_or_refused(bench: Bench) -> None:
    """At the browser's own zoom the pattern comes out pixel for pixel, or not at all."""
    zoom = {"partition": {"default_zoom_level": {"x": 1.2239010857415447}}}  # 125 %
    with browser(f"--screen-info={SCREENS}", preferences=zoom) as b, bench.real("zoomed") as studio, quiet(b, studio):
        with studio.socket("operator") as page:
            page.send("camera", kind="files")
            page.send("step", step="calibrate")
            display = b.window(studio.link("display"), None)
            has_two_screens(display)
            move(display, (1400, 100))
            display.keys("f")
            wait_until("full screen on the projector", lambda: display.run("return !!document.fullscreenElement"))
            ratio = display.run("return devicePixelRatio")
            assert abs(ratio - 1.25) < 0.01, ratio
            studio.wait("painted or refused", lambda s: s["display"]["measured"] and (painted(s) or s["display"]["problem"]))
            time.sleep(0.5)
            if painted(studio.state()):
                is_pixel_for_pixel(display, studio.folder / "checker.png")
                bench.figure("a browser zoom of 125 % is compensated: the pattern is shown pixel for pixel")
            else:
                assert not has_pattern(display)
                bench.figure(f"a browser zoom of 125 % is refused: {studio.state()['display']['problem']['code']}")


def sees_the_sheet(bench: Bench, b: Browser, studio: Studio, camera: FakeCamera) -> Operator:
    """A page with the webcam, in the step Calibrate; photographs are taken by hand."""
    page = b.window(studio.link("operator"))
    page.press("camera", kind="webcam")
    studio.wait("the webcam", lambda s: s["camera"]["connected"])
    in_full_screen(b, studio, page)
    page.press("go-on", step="calibrate")
    takes_by_hand(studio, page)
    camera.sees(bench.sheets()[0])
    sees_corners(page)
    return page


def a_camera_that_is_taken_away_is_missed(bench: Bench) -> None:
    with with_camera(bench, "away") as (b, camera), bench.real("away") as studio, quiet(b, studio):
        page = sees_the_sheet(bench, b, studio, camera)
        camera.is_taken_away()
        state = studio.wait("the studio knows", lambda s: s["camera"]["problem"])
        assert state["camera"]["problem"]["code"] == "camera-lost" and not state["camera"]["connected"], state["camera"]
        page.wait_for("[data-state=problem][data-value=camera-lost]")
        page.pictures = bench.pictures
        page.keep("32-camera-away")
        assert not page.find("video"), "the last picture looks like a live one"
        assert not page.find(f"{selected('take')}:not([aria-disabled=true])")
        # Plugged in again.
        FakeCamera(camera.path).sees(bench.sheets()[0])
        page.press("start-webcam")
        studio.wait("the webcam again", lambda s: s["camera"]["connected"] and not s["camera"]["problem"])
        sees_corners(page)
        page.press("take")
        studio.wait("a photograph", lambda s: calibrated_from(s, 1))


def a_camera_comes_back_with_its_operator(bench: Bench) -> None:
    """Somebody else takes over and leaves again: the camera of the first page runs again by itself, as the browser need not ask."""
    with with_camera(bench, "back") as (b, camera), bench.real("back") as studio, quiet(b, studio):
        page = sees_the_sheet(bench, b, studio, camera)
        with studio.socket("operator") as other:
            other.send("take-over")
            wait_until("the first page waits", lambda: page.value("role") == "waiting")
            wait_until("and lets the camera go", lambda: not page.find("video"))
        wait_until("the first page operates", lambda: page.value("role") == "operating")
        sees_corners(page)
        page.press("take")
        studio.wait("a photograph", lambda s: calibrated_from(s, 1))


def a_missing_or_forbidden_camera_is_explained(bench: Bench) -> None:
    for name, arguments, code in (("none", ("--use-fake-device-for-media-stream=device-count=0", "--use-fake-ui-for-media-stream"), "camera-missing"),
                                  ("forbidden", ("--use-fake-device-for-media-stream", "--deny-permission-prompts"), "camera-refused")):
        with browser(*arguments) as b, bench.real(f"camera-{name}") as studio, quiet(b, studio):
            page = b.window(studio.link("operator"))
            page.press("camera", kind="webcam")
            page.wait_for(f"[data-state=problem][data-value={code}]")
            studio.wait("the studio knows", lambda s: not s["camera"]["connected"])
            page.pictures = bench.pictures
            page.keep(f"33-camera-{name}")
            # Another one can be chosen.
            page.press("camera", kind="files")
            studio.wait("files", lambda s: s["camera"]["kind"] == "files" and not s["camera"]["problem"])
            wait_until("the problem is gone", lambda: not page.find(f"[data-state=problem][data-value={code}]"))


def answers_come_while_it_works(bench: Bench) -> None:
    """Live frames are looked at soon, and the state is answered while a calibration runs."""
    with bench.real("live") as studio, studio.socket("display") as display, studio.socket("operator") as page:
        width, height = PROJECTOR
        display.send("measured", device_pixel_ratio=1, screen=[width, height], viewport=[width, height], fullscreen=True)
        page.send("camera", kind="webcam", size=[1280, 960], held=[])
        page.send("auto-shot", on=False)
        page.send("step", step="calibrate")
        wanted = studio.wait("step calibrate", lambda s: s["display"]["wanted"]["kind"] == "checker" and not s["busy"])["display"]["wanted"]
        display.send("painted", sequence=wanted["sequence"])
        jpeg = io.BytesIO()
        Image.open(bench.sheets()[0]).convert("RGB").save(jpeg, "JPEG", quality=80)
        first, *delays = [answered(page, seq, jpeg.getvalue()) for seq in range(FRAMES + 1)]
        bench.figure(f"live at 1280x960: the answer comes {spread(delays)} after the frame, {first:.0f} ms after the first one; "
                     f"{1000 / statistics.mean(delays):.1f} frames per second")

        asked: list[float] = []
        ended = threading.Event()
        asking = threading.Thread(target=ask, args=(studio, asked, ended))
        for photo in bench.sheets():
            assert studio.upload(photo.read_bytes()).status == 200
            studio.wait("found", lambda s: not s["busy"])
        asking.start()
        begun = time.monotonic()
        behind = []
        for turn in range(3):
            page.send("photograph", id=1, used=bool(turn % 2))
            behind.append(answered(page, 100 + turn, jpeg.getvalue()))
            studio.wait("calibrated", lambda s: not s["busy"])
        studio.wait("calibrated from both", lambda s: not s["busy"])
        seconds = time.monotonic() - begun
        ended.set()
        asking.join()
        bench.figure(f"while it calibrates three times in {seconds:.1f} s: the state is answered within {max(asked):.0f} ms ({spread(asked)}), "
                     f"a live frame within {max(behind):.0f} ms")
        assert max(asked) < 2000, max(asked)


def answered(page: Socket, seq: int, jpeg: bytes) -> float:
    """How long the answer to a live frame takes, ms."""
    begun = time.monotonic()
    page.frame(seq, jpeg)
    live = page.receive("live", lambda m: m["live"]["seq"] == seq)["live"]
    assert live["sheet"] and len(live["corners"]) > 50, live["problem"]
    return 1000 * (time.monotonic() - begun)


def ask(studio: Studio, asked: list[float], ended: threading.Event) -> None:
    """Asks for the state again and again; how long the answers take, ms."""
    while not ended.is_set():
        begun = time.monotonic()
        studio.state()
        asked.append(1000 * (time.monotonic() - begun))
        ended.wait(0.02)


def continuous_scans_keep_up_with_the_decoder(bench: Bench) -> None:
    """Frames are sent as fast as they are answered, and one more."""
    with bench.calibrated("continuous") as studio, studio.socket("operator") as page:
        page.send("camera", kind="webcam", size=[1280, 960], held=[])
        page.send("scan", mode="start")
        page.receive("state", lambda m: m["state"]["scan"]["continuous"])
        jpeg = io.BytesIO()
        Image.open(bench.sphere()).convert("RGB").save(jpeg, "JPEG", quality=80)
        begun = time.monotonic()
        points, answered = [], 0
        # As the page does: one is on its way while another one is reconstructed. A frame that comes before the one before it was
        # taken replaces it, and its answer counts for both.
        page.frame(1, jpeg.getvalue())
        for seq in range(2, FRAMES + 2):
            page.frame(seq, jpeg.getvalue())
            live = page.receive("live", lambda m: m["live"]["seq"] > answered)["live"]
            answered = live["seq"]
            points.append(live["stripes"])
        rate = FRAMES / (time.monotonic() - begun)
        assert all(n and n > 10_000 for n in points), points
        live = studio.request("GET", "/api/cloud/live?sequence=1", role="operator")
        assert live.status == 200 and live.body[:4] == b"SLCV" and int.from_bytes(live.body[8:12], "little") == points[-1]
        seconds = decoder_seconds(bench, studio.folder)
        bench.figure(f"continuous scan of frames that are there: {rate:.1f} clouds per second; "
                     f"slcal reconstruct alone {1 / seconds:.1f} per second, with start and files")
        page.send("scan", mode="stop")
        studio.wait("the last cloud is kept", lambda s: len(s["scan"]["clouds"]) == 2 and not s["busy"])
        # Another size than that of the calibration.
        page.send("scan", mode="start")
        small = io.BytesIO()
        Image.open(bench.sphere()).convert("RGB").resize((640, 480)).save(small, "JPEG")
        page.frame(1000, small.getvalue())
        assert page.receive("live", lambda m: m["live"]["seq"] == 1000)["live"]["problem"]["message"]


def decoder_seconds(bench: Bench, folder: Path) -> float:
    times = []
    for _ in range(3):
        begun = time.monotonic()
        bench.run("reconstruct", "--rig", folder / "rig.json", "--pattern", folder / "stripes.json", folder / "scan-001.png", "--mesh",
                  "-o", bench.folder / "decoder.ply", "--force")
        times.append(time.monotonic() - begun)
    return min(times)


TIMES = (answers_come_while_it_works, continuous_scans_keep_up_with_the_decoder)
CHECKS = (
    a_webcam_and_a_projector_give_a_rig, displays_that_would_scale_are_refused, zoomed_displays_are_exact_or_refused,
    a_camera_that_is_taken_away_is_missed, a_camera_comes_back_with_its_operator, a_missing_or_forbidden_camera_is_explained,
)
