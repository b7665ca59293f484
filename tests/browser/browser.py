"""A headless Chromium that opens reports: what it logs, what it asks the network for, what it draws."""

from __future__ import annotations

import base64
import json
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

PATIENCE_S = 60.0
"""Drawing on a busy machine without a graphics card may take long; nothing is asserted about speed."""


@dataclass
class Page:
    """A report in the browser."""

    driver: webdriver.Chrome
    seconds: float
    """From the request until all is drawn."""

    def run(self, script: str, *args: Any) -> Any:
        return self.driver.execute_script(script, *args)

    def cdp(self, command: str, **options: Any) -> dict[str, Any]:
        return dict(self.driver.execute_cdp_cmd(command, options))

    def complaints(self) -> list[str]:
        """Errors and warnings in the console, breaches of the page's policy among them."""
        entries = logged(self.driver, "browser")
        return [e["message"] for e in entries if e["level"] in {"SEVERE", "WARNING"} and not graphics(e["message"])]

    def requests(self) -> list[str]:
        """Addresses that were asked for, beyond the page itself and what it carries."""
        asked = []
        for entry in logged(self.driver, "performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.append(message["params"]["request"]["url"])
        return [u for u in asked if not u.startswith(("data:", "blob:")) and u != self.driver.current_url]

    def picture(self, path: Path, whole: bool = True) -> None:
        """A screenshot, of the whole page."""
        shot = self.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(shot["data"]))

    def pdf(self) -> bytes:
        """As printed on A4."""
        made = self.cdp("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, preferCSSPageSize=False)
        return base64.b64decode(made["data"])

    def pixels(self, element: str) -> bytes:
        """What an element looks like, as PNG."""
        return bytes(self.driver.find_element("css selector", element).screenshot_as_png)

    def drag(self, element: str, right: int, down: int) -> None:
        """Moves the pressed mouse over an element, and waits until it is drawn anew."""
        box = self.driver.find_element("css selector", element)
        ActionChains(self.driver).click_and_hold(box).move_by_offset(right, down).release().perform()
        time.sleep(1.0)


def graphics(message: str) -> bool:
    """Whether a message is of the browser about drawing without a graphics card, not of the page."""
    return "GPU stall" in message or "Automatic fallback to software WebGL" in message


def chromium() -> tuple[str, str] | None:
    """Browser and driver, where they are installed."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    driver = shutil.which("chromedriver")
    return (browser, driver) if browser and driver else None


@contextmanager
def launched(*arguments: str, preferences: dict[str, Any] | None = None) -> Iterator[webdriver.Chrome]:
    """A browser with a profile of its own, which logs its console and its network."""
    found = chromium()
    if found is None:
        raise RuntimeError("expected chromium and chromedriver, found none; install them")
    browser, driver_path = found
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        options = Options()
        options.binary_location = browser
        for argument in (
            "--headless=new", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
            "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader", f"--user-data-dir={profile}", "--hide-scrollbars", *arguments,
        ):
            options.add_argument(argument)
        # No bar that says that the browser is being driven: it would take room from pages in full screen.
        options.add_experimental_option("excludeSwitches", ["enable-automation"])
        options.add_experimental_option("prefs", preferences or {})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        driver = webdriver.Chrome(options=options, service=Service(driver_path))
        try:
            yield driver
        finally:
            driver.quit()


def logged(driver: webdriver.Chrome, kind: str) -> list[dict[str, Any]]:
    """What was logged since the last time: by the console ("browser") or of the network ("performance")."""
    read: Any = driver.get_log  # It has no types.
    return list(read(kind))


@contextmanager
def opened(path: Path, size: tuple[int, int] = (1280, 900), scheme: str = "light", scripts: bool = True) -> Iterator[Page]:
    """A report, all of it drawn, in a window of a size under a colour scheme."""
    with launched() as driver:
        width, height = size
        page = Page(driver, 0.0)
        page.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                 mobile=width < 600)
        # What scrolls smoothly has moved on when it is clicked.
        page.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme},
                                                         {"name": "prefers-reduced-motion", "value": "reduce"}])
        page.cdp("Emulation.setScriptExecutionDisabled", value=not scripts)
        # The first page of a new window asks for things of its own.
        driver.get("about:blank")
        logged(driver, "performance")
        start = time.monotonic()
        driver.get(path.resolve().as_uri())
        while scripts and page.run("return document.documentElement.dataset.drawn !== 'all' && !!document.getElementById('space')"):
            if time.monotonic() - start > PATIENCE_S:
                raise TimeoutError(f"not all of {path} drawn after {PATIENCE_S} s: {logged(driver, 'browser')}")
            time.sleep(0.02)
        page.seconds = time.monotonic() - start
        yield page
