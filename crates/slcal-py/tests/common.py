"""What several tests share: where photographs are, and the command of this very package."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[3]
#: Photographs of the demonstration, with the rig that they were rendered with.
DEMO = REPOSITORY / "crates/slcal-cli/demo"
#: Rendered scenes with exact truth, where they are at hand.
RENDERED = Path(os.environ.get("SLCAL_SHARED", REPOSITORY.parent / "shared")) / "data/rendered"


def scenes() -> list[Path]:
    """The rendered scenes; none where they are not at hand."""
    return sorted(p.parent for p in RENDERED.glob("*/truth_rig.json"))


def command(*args: str | Path) -> str:
    """What the package's command prints; it must succeed."""
    said = subprocess.run([sys.executable, "-m", "slcal", *map(str, args)], capture_output=True, text=True)
    assert said.returncode == 0, f"{args}: {said.stderr}"
    return said.stdout


def command_json(*args: str | Path) -> Any:
    """The same with ``--json``, as Python's own values."""
    return json.loads(command(*args, "--json"))
