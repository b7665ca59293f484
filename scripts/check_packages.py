#!/usr/bin/env python3
"""Checks what is published: what packages contain, and what must agree for them.

    scripts/check_packages.py                       # licences, READMEs and the files in packaging/
    scripts/check_packages.py ARCHIVE ...           # crates (.crate), wheels (.whl), source distributions (.tar.gz)
"""

from __future__ import annotations

import argparse
import re
import subprocess
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

from links import LINK, prose
from packaging_checksums import FILES, MARK

ROOT = Path(__file__).resolve().parent.parent
LICENCES = ["LICENSE-MIT", "LICENSE-APACHE"]
CRATES = ["slcal-core", "slcal-cli", "slcal-py"]
REPOSITORY = "https://github.com/slcal/slcal"
#: What the registry of crates takes.
LARGEST_CRATE = 10 * 1024 * 1024


def text(path: str) -> str:
    return (ROOT / path).read_text(encoding="utf-8")


def stated(path: str, pattern: str) -> str:
    found = re.search(pattern, text(path), re.M)
    return found[1] if found else "nothing"


def differing(where: str, expected: str, found: str) -> Iterator[str]:
    if found != expected:
        yield f"{where}: expected {expected}, found {found}"


def licences() -> Iterator[str]:
    for crate in CRATES:
        for name in LICENCES:
            if text(f"crates/{crate}/{name}") != text(name):
                yield f"crates/{crate}/{name}: differs from {name}"


def readmes() -> Iterator[str]:
    """Registries show these pages away from the repository: what is relative leads nowhere there."""
    for crate in CRATES:
        page = f"crates/{crate}/README.md"
        shown = prose(text(page))
        targets = [m[2] for m in LINK.finditer(shown)] + re.findall(r"""(?:src|href)=["']([^"']+)""", shown)
        for target in targets:
            inside = re.match(rf"{REPOSITORY}/(?:blob|raw)/main/([^#?]+)", target)
            if not target.startswith("https://"):
                yield f"{page}: {target}: expected an absolute address"
            elif inside and not (ROOT / inside[1]).exists():
                yield f"{page}: {target}: no such file in the repository"
    # Its program is the one of the crate's documentation, which the tests run.
    documented = re.search(r"^//! ```\n(.*?)^//! ```$", text("crates/slcal-core/src/lib.rs"), re.S | re.M)
    program = [line[4:] for line in (documented[1] if documented else "").splitlines() if not line.startswith("//! #")]
    shown_program = re.search(r"^```rust\n(.*?)^```$", text("crates/slcal-core/README.md"), re.S | re.M)
    if not program or not shown_program or shown_program[1].splitlines() != program:
        yield "crates/slcal-core/README.md: the program differs from the first one in crates/slcal-core/src/lib.rs"


def packaging() -> Iterator[str]:
    # Not at the top: wheels and source distributions are checked where it is not installed.
    import yaml

    version = stated("Cargo.toml", r'^version = "(.*)"$')
    for path, (pattern, _) in FILES.items():
        yield from differing(path, f"version {version}", f"version {stated(path, pattern)}")
        if text(path).count(MARK) != 1:
            yield f"{path}: expected one line {MARK!r}"
    rust = stated("Cargo.toml", r'^rust-version = "(.*)"$')
    image = "packaging/docker/Dockerfile"
    yield from differing(image, f"Rust {rust}", f"Rust {stated(image, r'^FROM rust:([0-9.]+)')}")
    maturin = stated("crates/slcal-py/pyproject.toml", r'^requires = \["maturin(.*)"\]$')
    for path in ["packaging/requirements.txt", "tests/requirements.txt"]:
        yield from differing(path, f"maturin{maturin}", f"maturin{stated(path, r'^maturin(.*)$')}")
    name = "packaging/conda-forge/recipe.yaml"
    recipe = yaml.safe_load(text(name))
    missing = {"schema_version", "context", "package", "source", "build", "requirements", "tests", "about"} - recipe.keys()
    if missing:
        yield f"{name}: lacks {', '.join(sorted(missing))}"
        return
    yield from differing(name, "schema_version 1", f"schema_version {recipe['schema_version']}")
    yield from differing(name, "licence MIT OR Apache-2.0", f"licence {recipe['about']['license']}")
    for needed in recipe["requirements"]["host"]:
        if needed.startswith("maturin"):
            yield from differing(name, f"maturin {maturin}", needed)


def contents(archive: Path) -> dict[str, bytes]:
    """Every file by its path below the archive's only folder; in a wheel by its whole path."""
    if archive.suffix == ".whl":
        with zipfile.ZipFile(archive) as wheel:
            return {name: wheel.read(name) for name in wheel.namelist()}
    with tarfile.open(archive) as packed:
        files = {m.name.partition("/")[2]: packed.extractfile(m) for m in packed.getmembers() if m.isfile()}
        return {name: file.read() for name, file in files.items() if file}


def lacking(archive: Path, found: dict[str, bytes], names: list[str]) -> Iterator[str]:
    for name in names:
        if name not in found:
            yield f"{archive.name}: lacks {name}"


def with_licences(archive: Path, found: dict[str, bytes], folder: str = "") -> Iterator[str]:
    yield from lacking(archive, found, [folder + name for name in LICENCES])
    for name in LICENCES:
        if folder + name in found and found[folder + name] != (ROOT / name).read_bytes():
            yield f"{archive.name}: {folder}{name} differs from {name}"


def metadata(archive: Path, found: dict[str, bytes], name: str) -> Iterator[str]:
    lines = found.get(name, b"").decode().splitlines()
    for line in ["License-Expression: MIT OR Apache-2.0", *(f"License-File: {licence}" for licence in LICENCES)]:
        if line not in lines:
            yield f"{archive.name}: {name} lacks the line {line!r}"


def package(archive: Path) -> Iterator[str]:
    found = contents(archive)
    if archive.suffix == ".whl":
        info = next((n.partition("/")[0] + "/" for n in found if n.endswith(".dist-info/METADATA")), "")
        yield from with_licences(archive, found, f"{info}licenses/")
        yield from metadata(archive, found, f"{info}METADATA")
        yield from lacking(archive, found, ["slcal/__init__.py", "slcal/_slcal.pyi", "slcal/py.typed"])
    elif archive.suffix == ".crate":
        yield from with_licences(archive, found)
        yield from lacking(archive, found, ["Cargo.toml", "Cargo.lock", "README.md"])
        if archive.stat().st_size > LARGEST_CRATE:
            yield f"{archive.name}: {archive.stat().st_size} bytes, the registry takes {LARGEST_CRATE}"
    else:
        yield from with_licences(archive, found)
        yield from metadata(archive, found, "PKG-INFO")
        listed = subprocess.run(["git", "ls-files", "crates/slcal-py/python"], cwd=ROOT, check=True, capture_output=True, text=True)
        sources = [path.removeprefix("crates/slcal-py/") for path in listed.stdout.splitlines()]
        manifests = [f"crates/{crate}/Cargo.toml" for crate in CRATES]
        yield from lacking(archive, found, ["Cargo.lock", "Cargo.toml", "README.md", "pyproject.toml", *manifests, *sources])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archives", nargs="*", type=Path, metavar="ARCHIVE")
    archives = parser.parse_args().archives
    if archives:
        wrong = [line for archive in archives for line in package(archive)]
    else:
        wrong = [*licences(), *readmes(), *packaging()]
    if wrong:
        raise SystemExit("\n".join(wrong))
    print(*(f"{a.name}: licences and sources are complete" for a in archives), sep="\n", end="\n" if archives else "")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
