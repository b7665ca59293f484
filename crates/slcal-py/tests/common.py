"""What several tests share: where photographs are, and the command of this very package."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import slcal

REPOSITORY = Path(__file__).resolve().parents[3]
#: Photographs of the demonstration, with the rig that they were rendered with.
DEMO = REPOSITORY / "crates/slcal-cli/demo"
#: Rendered scenes with exact truth, where they are at hand.
RENDERED = Path(os.environ.get("SLCAL_SHARED", REPOSITORY.parent / "shared")) / "data/rendered"


def scenes() -> list[Path]:
    """The rendered scenes with a sheet under and without the pattern; none where they are not at hand."""
    folders = sorted(p.parent for p in RENDERED.glob("*/truth_rig.json"))
    return [f for f in folders if (f / "checker.png").exists() and (f / "screen.png").exists()]


def check_types(*files: Path) -> None:
    """Runs ``mypy --strict`` on programs that use the package."""
    pytest.importorskip("mypy", reason="mypy is not installed: pip install mypy")
    home, options = Path(slcal.__file__).resolve().parents[1], ["--strict"]
    environment = dict(os.environ)
    if home.name != "site-packages":
        # Out of its folder: mypy needs to be told, and would report on the package itself as well.
        environment["MYPYPATH"] = str(home)
        options.append("--follow-imports=silent")
    target = REPOSITORY / "target"
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *options, *files],
        cwd=target if target.is_dir() else files[0].parent,
        capture_output=True,
        text=True,
        env=environment,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def command(*args: str | Path) -> str:
    """What the package's command prints; it must succeed."""
    said = subprocess.run([sys.executable, "-m", "slcal", *map(str, args)], capture_output=True, text=True, timeout=300)
    assert said.returncode == 0, f"{args}: {said.stderr}"
    return said.stdout


def command_json(*args: str | Path) -> Any:
    """The same with ``--json``, as Python's own values."""
    return json.loads(command(*args, "--json"))
