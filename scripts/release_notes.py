#!/usr/bin/env python3
"""Prints the notes of a version from CHANGELOG.md, once everything that states the version states this one.

    scripts/release_notes.py 0.1.0
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def stated(path: str, pattern: str) -> str:
    """What the first line of a file says that matches the pattern."""
    found = re.search(pattern, (ROOT / path).read_text(encoding="utf-8"), re.M)
    if not found:
        raise SystemExit(f"{path}: expected a line with the version, found none")
    return found[1]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("version")
    version = parser.parse_args().version
    places = {"Cargo.toml": r'^version = "(.*)"$', "CITATION.cff": r"^version: (.*)$"}
    wrong = {path: found for path, pattern in places.items() if (found := stated(path, pattern)) != version}
    if wrong:
        raise SystemExit("\n".join(f"{path}: expected version {version}, found {found}" for path, found in wrong.items()))
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    section = re.search(rf"^## \[{re.escape(version)}\] - \d{{4}}-\d\d-\d\d\n(.*?)(?=^## \[|\Z)", changelog, re.M | re.S)
    if not section or not section[1].strip():
        raise SystemExit(f"CHANGELOG.md: expected a section [{version}] with a date and entries, found none")
    sys.stdout.write(section[1].strip() + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
