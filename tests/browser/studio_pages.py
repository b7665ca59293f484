"""The studio's pages in a browser: windows, buttons as a person finds them, what the pages ask and complain about."""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from browser import graphics, launched, logged
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement
from studio_server import PATIENCE_S, SOON_S, wait_until

AWAKE = ("--disable-background-timer-throttling", "--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding")
"""Pages in windows that nobody looks at work on, as they do on a second display."""
DESK, PHONE = (1280, 800), (390, 844)
SETTLE_S = 0.5
"""The page ignores a click just after its buttons changed: it was meant for the one before."""


@dataclass
class Window:
    """A window of the browser."""

    driver: webdriver.Chrome
    handle: str

    def front(self) -> None:
        self.driver.switch_to.window(self.handle)

    def run(self, script: str, *args: Any) -> Any:
        self.front()
        return self.driver.execute_script(script, *args)

    def cdp(self, command: str, **options: Any) -> dict[str, Any]:
        self.front()
        return dict(self.driver.execute_cdp_cmd(command, options))

    def open(self, address: str) -> None:
        """Loads an address; also where only the part after # differs."""
        self.front()
        self.driver.get("about:blank")
        self.driver.get(address)

    def close(self) -> None:
        self.front()
        self.driver.close()

    def find(self, selector: str) -> WebElement | None:
        """The first element that is seen."""
        self.front()
        return next((e for e in self.driver.find_elements("css selector", selector) if e.is_displayed()), None)

    def wait_for(self, selector: str, patience_s: float = PATIENCE_S) -> WebElement:
        try:
            return wait_until(f"{selector} is seen", lambda: self.find(selector), patience_s)
        except AssertionError as error:
            raise AssertionError(f"{error}\n    {self.words()!r}") from None

    def wait_for_still(self, selector: str) -> WebElement:
        """An element that has been there for as long as a person needs to find it."""
        found = self.wait_for(selector)
        since = time.monotonic()
        while time.monotonic() - since < SETTLE_S:
            time.sleep(SOON_S)
            if self.find(selector) != found:
                found, since = self.wait_for(selector), time.monotonic()
        return found

    def text(self, selector: str) -> str:
        found = self.find(selector)
        return found.text if found else ""

    def wait_for_text(self, selector: str, part: str, patience_s: float = PATIENCE_S) -> str:
        def seen() -> str | None:
            said = self.text(selector)
            return said if part in said else None

        return wait_until(f"{part!r} in {selector}", seen, patience_s)

    def value(self, state: str) -> str | None:
        """The value of a part that shows a state."""
        shown: str | None = self.run("return document.querySelector(`[data-state='${arguments[0]}']`)?.dataset.value ?? null", state)
        return shown

    def words(self) -> str:
        """All that can be read."""
        return str(self.run("return document.body.innerText"))[:1500]

    def keys(self, *keys: str) -> None:
        """Keys for whatever has the focus."""
        self.front()
        keyboard: Any = ActionChains(self.driver)  # It has no types.
        keyboard.send_keys(*keys).perform()

    def metrics(self, size: tuple[int, int], scale: float = 1.0, phone: bool = False, screen: tuple[int, int] | None = None) -> None:
        """Pretends a window of this size, in CSS pixels."""
        width, height = screen or size
        self.cdp("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=scale, mobile=phone,
                 screenWidth=width, screenHeight=height)

    def scheme(self, name: str) -> None:
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def picture(self, whole: bool = False) -> bytes:
        shot = self.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        return base64.b64decode(shot["data"])

    def pixels(self, selector: str) -> bytes:
        """What an element looks like, as PNG."""
        return bytes(self.wait_for(selector).screenshot_as_png)

    def drag(self, selector: str, right: int, down: int) -> None:
        """Moves the pressed mouse over an element."""
        mouse: Any = ActionChains(self.driver)  # It has no types.
        mouse.click_and_hold(self.wait_for(selector)).move_by_offset(right, down).release().perform()

    def accessible(self) -> list[tuple[str, str]]:
        """Role and name of everything that a screen reader tells."""
        nodes = self.cdp("Accessibility.getFullAXTree")["nodes"]

        def value(node: Any, key: str) -> str:
            return str(node.get(key, {}).get("value", ""))

        return [(value(n, "role"), value(n, "name")) for n in nodes if not n.get("ignored")]


@dataclass
class Operator(Window):
    """The operator's page, used with a mouse; it counts the clicks."""

    clicks: int = 0
    pictures: Path | None = None

    def press(self, action: str, **data: str) -> None:
        """Presses a button that is seen and can be pressed, as soon as there is one."""
        selector = selected(action, **data)
        self.wait_for_still(f"{selector}:not([aria-disabled=true]):not(:disabled)").click()
        self.clicks += 1

    def keep(self, name: str) -> None:
        """Screenshots of the page as it is: desk and phone, light and dark."""
        if not self.pictures:
            return
        self.pictures.mkdir(parents=True, exist_ok=True)
        for place, size in {"desk": DESK, "phone": PHONE}.items():
            for scheme in ("light", "dark"):
                self.metrics(size, phone=place == "phone")
                self.scheme(scheme)
                time.sleep(0.3)
                (self.pictures / f"{name}-{place}-{scheme}.png").write_bytes(self.picture(whole=place == "phone"))
        self.metrics(DESK)
        self.scheme("light")


def selected(action: str, **data: str) -> str:
    """The selector of a control."""
    return f"[data-action='{action}']" + "".join(f"[data-{k}='{v}']" for k, v in data.items())


@dataclass
class Browser:
    """A browser with windows of studios."""

    driver: webdriver.Chrome
    asked: list[str] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def window(self, address: str, size: tuple[int, int] | None = DESK) -> Operator:
        """A new window that shows an address."""
        switch: Any = self.driver.switch_to  # It has no types.
        switch.new_window("window")
        window = Operator(self.driver, self.driver.current_window_handle)
        if size:
            window.metrics(size, phone=size[0] < 600)
        window.open(address)
        return window

    def opened_by(self, press: Any) -> Window:
        """The window that a click opens."""
        before = set(self.driver.window_handles)
        press()
        handle = wait_until("a new window", lambda: next(iter(set(self.driver.window_handles) - before), None))
        return Window(self.driver, handle)

    def close_all(self) -> None:
        """All windows but the first, which shows nothing."""
        first, *others = self.driver.window_handles
        for handle in others:
            Window(self.driver, handle).close()
        self.driver.switch_to.window(first)

    def look(self) -> None:
        """Takes down what was asked and what was said since the last time, in all windows."""
        for entry in logged(self.driver, "performance"):
            message = json.loads(entry["message"])["message"]
            params = message["params"]
            if message["method"] == "Network.requestWillBeSent":
                self.asked.append(params["request"]["url"])
            elif message["method"] == "Network.webSocketCreated":
                self.asked.append(params["url"])
        for entry in logged(self.driver, "browser"):
            if entry["level"] in {"SEVERE", "WARNING"} and not graphics(entry["message"]):
                self.said.append(entry["message"])
        for handle in self.driver.window_handles:
            # A window that a page opened was not listened to from its beginning.
            loaded = Window(self.driver, handle).run("return performance.getEntriesByType('resource').map(e => e.name)")
            self.asked.extend(loaded)

    def foreign(self, host: str) -> list[str]:
        """Addresses of other hosts that were asked for."""
        def own(url: str) -> bool:
            return url.startswith(("data:", "blob:", "about:", "chrome:")) or urlsplit(url).netloc == host

        return sorted({url for url in self.asked if not own(url)})


@contextmanager
def browser(*arguments: str, preferences: dict[str, Any] | None = None) -> Iterator[Browser]:
    with launched(*AWAKE, *arguments, preferences=preferences) as driver:
        driver.get("about:blank")
        logged(driver, "performance")
        yield Browser(driver)


__all__ = ["Browser", "Keys", "Operator", "Window", "browser", "selected"]
