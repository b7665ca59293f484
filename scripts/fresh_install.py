#!/usr/bin/env python3
"""Installs a wheel into a fresh virtual environment and uses it as somebody would who has just read the
README.

    scripts/fresh_install.py target/wheels/slcal-*.whl

Runs the README's Python as printed, in an empty folder, and `slcal demo`, with nothing installed but the
wheel and what it asks for.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

README = Path(__file__).resolve().parents[1] / "README.md"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("wheel", type=Path)
    wheel: Path = parser.parse_args().wheel.resolve()
    blocks = re.findall(r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.S | re.M)
    if not blocks:
        print(f"{README} has no Python", file=sys.stderr)
        return 1
    # Neither the environment of the caller nor the repository may lend anything.
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        venv.create(folder / "venv", with_pip=True)
        programs = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
        work = folder / "work"
        work.mkdir()

        def run(*command: str | Path) -> None:
            subprocess.run([str(c) for c in command], check=True, cwd=work, env=environment)

        run(programs / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", wheel)
        (work / "readme.py").write_text("\n".join(blocks), encoding="utf-8")
        run(programs / "python", "-W", "error", "readme.py")
        run(programs / "slcal", "demo", "--out", "demo")
        print("made in a fresh environment:", *sorted(p.name for p in work.rglob("*") if p.is_file()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
