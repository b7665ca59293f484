#!/usr/bin/env python3
"""Prints the notes of a version from CHANGELOG.md, once everything that states the version states this one.

    scripts/release_notes.py 0.1.0
    scripts/release_notes.py 0.1.0 --draft    # also while the section says "unreleased" instead of its date
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from packaging_checksums import FILES as PACKAGING

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
    parser.add_argument("--draft", action="store_true", help="the section need not be dated yet")
    args = parser.parse_args()
    version = args.version
    places = {"Cargo.toml": r'^version = "(.*)"$', "CITATION.cff": r"^version: (.*)$"}
    places |= {path: pattern for path, (pattern, _) in PACKAGING.items()}
    wrong = {path: found for path, pattern in places.items() if (found := stated(path, pattern)) != version}
    if wrong:
        raise SystemExit("\n".join(f"{path}: expected version {version}, found {found}" for path, found in wrong.items()))
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    date = r"(?:\d{4}-\d\d-\d\d|unreleased)" if args.draft else r"\d{4}-\d\d-\d\d"
    section = re.search(rf"^## \[{re.escape(version)}\] - {date}\n(.*?)(?=^## \[|\Z)", changelog, re.M | re.S)
    if not section or not section[1].strip():
        expected = "entries" if args.draft else "a date and entries"
        raise SystemExit(f"CHANGELOG.md: expected a section [{version}] with {expected}, found none")
    sys.stdout.write(section[1].strip() + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
