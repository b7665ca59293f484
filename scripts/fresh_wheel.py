#!/usr/bin/env python3
"""Installs a wheel into a new virtual environment, as a new user would, and tries what the README promises of it.

    python scripts/fresh_wheel.py target/wheels/slcal-*.whl

The Python of README.md runs exactly as printed, the command shows its demonstration, and importing slcal brings nothing along
but NumPy.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

README = Path(__file__).resolve().parent.parent / "README.md"

#: Modules of extras and of other programs' world that a plain import must not bring along.
FOREIGN = ["cv2", "fsspec", "matplotlib", "open3d", "pyarrow", "ray", "rerun", "scipy", "trimesh"]
IMPORTED = f"import sys, slcal, slcal.simulate; sys.exit(', '.join(m for m in {FOREIGN} if m in sys.modules) or 0)"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheel", type=Path)
    wheel = parser.parse_args().wheel.resolve()
    snippets = re.findall(r"^```python\n(.*?)^```", README.read_text(encoding="utf-8"), re.S | re.M)
    if not snippets:
        raise SystemExit(f"{README}: expected a block of Python, found none")
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        venv.create(home / "venv", with_pip=True)
        programs = home / "venv" / ("Scripts" if sys.platform == "win32" else "bin")

        def run(program: str, *args: str | Path) -> None:
            command = [programs / program, *args]
            said = subprocess.run(command, cwd=home, capture_output=True, text=True)
            if said.returncode != 0:
                shown = " ".join(map(str, command))
                raise SystemExit(f"{shown}: exit code {said.returncode}\n{said.stdout}{said.stderr}")

        run("python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", wheel)
        run("python", "-W", "error", "-c", IMPORTED)
        for snippet in snippets:
            run("python", "-W", "error", "-c", snippet)
        run("slcal", "demo", "--out", "demo")
        missing = [f for f in ("ball.ply", "demo/rig.json") if not (home / f).is_file()]
        if missing:
            raise SystemExit(f"expected {', '.join(missing)} to be written, found nothing")
    print(f"{wheel.name}: installed, {len(snippets)} of README's blocks run as printed, the demonstration shown")
    return 0


if __name__ == "__main__":
    sys.exit(main())
