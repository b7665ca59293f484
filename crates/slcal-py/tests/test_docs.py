"""The Python of the documentation runs as printed, from top to bottom."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from common import REPOSITORY, check_types

#: A block of Python; a comment before it may name modules without which it is left out.
BLOCK = re.compile(r"(?:<!-- needs (?P<needs>[\w., ]+?) -->\n)?^```python\n(?P<code>.*?)^```", re.S | re.M)
#: Pages whose blocks are one program, and how many there are at least: a page that loses its blocks fails.
PAGES = {"docs/python.md": 18, "README.md": 1, "crates/slcal-py/README.md": 1}


def blocks(page: str) -> list[tuple[int, str]]:
    """First lines and texts of the blocks that can run here."""
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    found = []
    for match in BLOCK.finditer(text):
        needs = [n.strip() for n in (match["needs"] or "").split(",") if n.strip()]
        if all(importlib.util.find_spec(n) for n in needs):
            found.append((text.count("\n", 0, match.start("code")) + 1, match["code"]))
    return found


@pytest.fixture(params=PAGES)
def script(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The program of a page; each block keeps its lines, so that messages point to the page."""
    page: str = request.param
    if not (REPOSITORY / page).exists():
        pytest.skip(f"{page} is not available: these tests run outside the repository")
    found = blocks(page)
    assert len(found) >= PAGES[page]
    program = ""
    for line, code in found:
        program += "\n" * (line - 1 - program.count("\n")) + code
    path = tmp_path / "page.py"
    path.write_text(program, encoding="utf-8")
    return path


def test_types(script: Path) -> None:
    check_types(script)


def test_the_python_of_the_page_runs(script: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "Agg"},
    )
    assert done.returncode == 0, done.stderr


def test_the_package_page_shows_what_the_readme_shows() -> None:
    """So that what is said of the one is true of the other."""
    pages = [p for p in PAGES if p.endswith("README.md")]
    if not all((REPOSITORY / p).exists() for p in pages):
        pytest.skip("outside the repository")
    first, second = (blocks(p)[0][1] for p in pages)
    assert first == second
