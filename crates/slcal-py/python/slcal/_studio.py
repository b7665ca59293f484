"""The studio from a notebook: the browser window in which patterns are shown and photographs taken."""

from __future__ import annotations

import atexit
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

from ._errors import Error
from ._slcal import PointCloud, Rig

_POLL_S = 0.2
_END_S = 5.0


class Studio:
    """A studio that runs beside this program; `slcal.studio` starts one.

    Everything that is made in the window lies in the folder `dir`: `rig` and `clouds` read it from there.

    Parameters
    ----------
    process : subprocess.Popen
        The studio.
    folder : Path
        The project's folder.
    addresses : dict
        What ``slcal studio --json`` printed: the addresses of its pages.
    """

    dir: Path
    """The project's folder."""
    url: str
    """Address of the operator's page. It contains a secret: whoever has it may operate."""
    display_url: str
    """Address of the page to show on the projector."""

    def __init__(self, process: subprocess.Popen[str], folder: Path, addresses: dict[str, Any]) -> None:
        self._process = process
        self.dir = folder
        self.url = addresses["operator"]
        self.display_url = addresses["display"]
        atexit.register(self.close)

    @property
    def running(self) -> bool:
        """Whether the studio still runs."""
        return self._process.poll() is None

    @property
    def rig(self) -> Rig | None:
        """The newest calibration; None before the first."""
        path = self.dir / "rig.json"
        return Rig.load(path) if path.exists() else None

    @property
    def clouds(self) -> list[PointCloud]:
        """All clouds, in the order in which they were scanned."""
        return [PointCloud.load(path) for path in self._cloud_files()]

    def wait_for_rig(self, timeout: float | None = None) -> Rig:
        """Waits until there is a calibration.

        `timeout` is in seconds; None waits as long as the studio runs. Raises `TimeoutError`, and `slcal.Error` when the studio
        ends before.
        """
        for _ in self._moments(timeout, "a calibration"):
            rig = self.rig
            if rig is not None:
                return rig
        raise Error("expected a calibration, but the studio ended before there was one; start it again")

    def new_clouds(self, timeout: float | None = None) -> Iterator[PointCloud]:
        """Yields clouds as they are scanned, those that are there first, until the studio ends.

        `timeout` is the longest wait for the next one in seconds; after it the iteration ends.
        """
        seen: set[str] = set()
        waiting_since = time.monotonic()
        while True:
            running = self.running
            for path in self._cloud_files():
                if path.name not in seen:
                    seen.add(path.name)
                    yield PointCloud.load(path)
                    waiting_since = time.monotonic()
            late = timeout is not None and time.monotonic() - waiting_since > timeout
            if not running or late:
                return
            time.sleep(_POLL_S)

    def close(self) -> None:
        """Ends the studio; nothing is lost."""
        atexit.unregister(self.close)
        if self.running:
            self._process.send_signal(signal.SIGTERM if os.name == "nt" else signal.SIGINT)
            try:
                self._process.wait(_END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def __enter__(self) -> Studio:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        state = "running" if self.running else "ended"
        return f"Studio(dir={str(self.dir)!r}, {state})"

    def _cloud_files(self) -> list[Path]:
        # scan-1000 comes after scan-999.
        return sorted(self.dir.glob("scan-*.ply"), key=lambda path: (len(path.name), path.name))

    def _moments(self, timeout: float | None, what: str) -> Iterator[None]:
        """Moments to look whether something is there; a last one after the studio has ended."""
        start = time.monotonic()
        running = True
        while running:
            running = self.running
            yield None
            if timeout is not None and time.monotonic() - start > timeout:
                raise TimeoutError(f"expected {what} within {timeout:g} s, found none")
            time.sleep(_POLL_S)


def studio(
    dir: str | os.PathLike[str] = "slcal-studio",
    *,
    projector: tuple[int, int] | None = None,
    size_mm: str | tuple[float, float] | None = None,
    watch: str | os.PathLike[str] | None = None,
    lan: bool = False,
    port: int | None = None,
    demo: bool = False,
    open_browser: bool = True,
) -> Studio:
    """Starts the studio: a browser window that shows patterns, takes photographs, calibrates and scans.

    It runs beside this program until `Studio.close`, or the end of a ``with`` block. What is made there lies in the folder `dir` and
    comes back as `Studio.rig` and `Studio.clouds`.

    Parameters
    ----------
    dir
        Folder for all files; created when it does not exist. Starting again in it continues the work.
    projector
        Native resolution of the projector; it can be set in the window.
    size_mm
        The sheet: width and height in mm, or a paper ("A4"); it can be set in the window.
    watch
        Folder into which a camera writes its photographs.
    lan
        Lets phones and other computers of the network take part; the connection is not encrypted.
    port
        Port of the server; by default 8642 or the next one that is free.
    demo
        Uses a simulated projector, camera and sheet.
    open_browser
        Whether to open the operator's page.

    Raises
    ------
    slcal.Error
        When it cannot start: the folder is in use, the port is taken.

    Examples
    --------
    >>> with slcal.studio("scans", size_mm="A3") as studio:  # doctest: +SKIP
    ...     rig = studio.wait_for_rig()
    ...     for cloud in studio.new_clouds():
    ...         print(len(cloud), "points")
    """
    command = [sys.executable, "-m", "slcal", "studio", "--json", "--dir", os.fspath(dir)]
    if projector is not None:
        command += ["--projector", f"{projector[0]}x{projector[1]}"]
    if size_mm is not None:
        command += ["--size", size_mm if isinstance(size_mm, str) else f"{size_mm[0]}x{size_mm[1]}mm"]
    if watch is not None:
        command += ["--watch", os.fspath(watch)]
    if port is not None:
        command += ["--port", str(port)]
    command += [
        option for option, given in (("--lan", lan), ("--demo", demo), ("--no-open", not open_browser)) if given
    ]
    # In a session of its own: an interrupt of the notebook's kernel is not for it.
    # What it says later is read by nobody: a file takes it, where a pipe would fill.
    with tempfile.TemporaryFile("w+") as messages:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=messages,
            text=True,
            start_new_session=True,
        )
        addresses = _addresses(process)
        if addresses is None:
            process.communicate()
            messages.seek(0)
            said = messages.read().strip().removeprefix("error: ").removeprefix("slcal: ")
            raise Error(said or "expected the studio to start, but it ended at once")
    return Studio(process, Path(dir), addresses)


def _addresses(process: subprocess.Popen[str]) -> dict[str, Any] | None:
    """The JSON that the studio prints first; None when it ends instead."""
    text = ""
    if process.stdout is None:
        return None
    for line in process.stdout:
        text += line
        if line.rstrip() == "}":
            found: dict[str, Any] = json.loads(text)
            return found
    return None
