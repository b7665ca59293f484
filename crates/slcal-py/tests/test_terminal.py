"""The command on a terminal: colours, width, progress, and a clean line after an interrupt."""

from __future__ import annotations

import os
import re
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

import slcal
from slcal import simulate

pty = pytest.importorskip("pty", reason="needs pseudo-terminals")
fcntl = pytest.importorskip("fcntl", reason="needs pseudo-terminals")
termios = pytest.importorskip("termios", reason="needs pseudo-terminals")

ESCAPE = "\x1b"
# Long enough that progress is shown on any machine.
SLOW = ["simulate", "noise", "--levels", "1/9", "--draws", "4000"]


class Terminal:
    """A run of the command on a terminal of its own."""

    def __init__(self, *args: str | Path, columns: int = 80, stdout: int | None = None, **variables: str) -> None:
        self.ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        environment = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "CI")}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "slcal", *map(str, args)],
            stdin=subprocess.DEVNULL,
            stdout=theirs if stdout is None else stdout,
            stderr=theirs,
            env={**environment, "TERM": "xterm-256color", **variables},
            start_new_session=True,
        )
        os.close(theirs)
        self.seen = ""

    def read(self, until: str | None = None, seconds: float = 60.0) -> str:
        """All that appears, or what appears until a text does."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and (until is None or until not in self.seen):
            try:
                more = os.read(self.ours, 4096)
            except OSError:  # the other side is closed
                break
            if not more:
                break
            self.seen += more.decode(errors="replace")
        return self.seen.replace("\r\n", "\n")

    def all(self) -> str:
        text = self.read()
        self.process.wait(timeout=60)
        os.close(self.ours)
        return text


def bare(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text)


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scene = simulate.scene("sheet", pattern=slcal.CheckerPattern(projector=(1024, 768)), tilt=(25, 28))
    path = tmp_path_factory.mktemp("rig") / "rig.json"
    slcal.calibrate([scene.photo], size_mm=(594, 420), pattern=slcal.CheckerPattern(projector=(1024, 768))).save(path)
    return path


def test_colours_on_a_terminal_and_not_elsewhere(rig: Path) -> None:
    line = ["advise", "--rig", rig]
    painted = Terminal(*line).all()
    assert "\x1b[1mnow" in painted
    plain = bare(painted)
    assert "next" in plain
    for variables in ({"NO_COLOR": "1"}, {"TERM": "dumb"}, {"CLICOLOR": "0"}):
        assert Terminal(*line, **variables).all() == plain, variables
    assert Terminal(*line, "--color", "never").all() == plain
    # Of stdout and stderr each by itself.
    piped = Terminal(*line, stdout=subprocess.PIPE)
    assert piped.process.stdout is not None
    with piped.process.stdout as out:
        assert out.read().decode() == plain
    assert piped.all() == ""
    failing = Terminal("advise", "--rig", "no_such_rig.json", stdout=subprocess.PIPE)
    assert failing.process.stdout is not None
    with failing.process.stdout as out:
        assert out.read() == b""
    assert "\x1b[1m\x1b[31mslcal:" in failing.all()


@pytest.mark.parametrize("columns", [60, 80, 200])
def test_lines_fit_the_terminal(rig: Path, columns: int) -> None:
    said = bare(Terminal("advise", "--rig", "a_name_of_a_rig_that_does_not_exist.json", columns=columns).all())
    assert max(map(len, said.splitlines())) <= columns
    said = bare(Terminal("simulate", "noise", "--levels", "0.1", "--draws", "3", columns=columns).all())
    sentences = [line for line in said.splitlines() if "," in line and "±" not in line]
    assert max(map(len, sentences)) <= min(columns, 80)
    said = bare(Terminal("reconstruct", "--help", columns=columns).all())
    assert max(map(len, said.splitlines())) <= 80


def test_progress_is_shown_for_what_lasts_and_cleared() -> None:
    running = Terminal(*SLOW)
    assert "draws" in running.read(until=" draws, ")
    running.process.send_signal(signal.SIGTERM)
    running.all()
    quick = Terminal("simulate", "noise", "--levels", "0.1", "--draws", "2").all()
    assert "of 2 draws" not in quick
    for options, variables in ((["-q"], {}), ([], {"TERM": "dumb"})):
        silent = Terminal(*SLOW[:-1], "60", *options, **variables)
        assert "draws, " not in silent.all()


def test_an_interrupt_leaves_a_clean_line() -> None:
    running = Terminal(*SLOW)
    running.read(until=" draws, ")
    running.process.send_signal(signal.SIGINT)
    seen = running.all()
    assert running.process.returncode in (130, -signal.SIGINT)
    assert seen.endswith("\r\x1b[2K"), repr(seen[-80:])
