#!/usr/bin/env python3
"""Writes copies of the formula and the recipe in packaging/ that have the checksum of a release's source archive.

    scripts/packaging_checksums.py slcal-0.1.0.tar.gz --out dist

The repository's own files have no checksum: the archive contains them.
"""

from __future__ import annotations

import argparse
import hashlib
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

#: The files, with how each states the version and how it spells a checksum.
FILES = {
    "packaging/homebrew/slcal.rb": (r"/releases/download/v([^/]+)/", 'sha256 "{}"'),
    "packaging/conda-forge/recipe.yaml": (r'^  version: "(.+)"$', "sha256: {}"),
}
MARK = "# sha256: filled by scripts/packaging_checksums.py"


def filled(path: str, archive: str, digest: str) -> str:
    """The content of the file with the checksum in place of the mark."""
    pattern, spelling = FILES[path]
    text = (ROOT / path).read_text(encoding="utf-8")
    version = re.search(pattern, text, re.M)
    expected = f"slcal-{version[1] if version else ''}.tar.gz"
    if archive != expected:
        raise SystemExit(f"{path}: expected the archive {expected}, got {archive}")
    if text.count(MARK) != 1:
        raise SystemExit(f"{path}: expected one line {MARK!r}, found {text.count(MARK)}")
    return text.replace(MARK, spelling.format(digest))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", type=Path)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    args = parser.parse_args()
    digest = hashlib.sha256(args.archive.read_bytes()).hexdigest()
    # All or none: what one file refuses is not written for the other either.
    copies = {Path(path).name: filled(path, args.archive.name, digest) for path in FILES}
    args.out.mkdir(parents=True, exist_ok=True)
    for name, text in copies.items():
        (args.out / name).write_text(text, encoding="utf-8")
        print(f"{args.out / name}: sha256 {digest}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
