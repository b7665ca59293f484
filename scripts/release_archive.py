#!/usr/bin/env python3
"""Makes the archive of a release for one platform: the command, manual pages, completions, licences and README, with a checksum.

    scripts/release_archive.py --out dist                     # for this platform
    scripts/release_archive.py --target aarch64-apple-darwin --out dist

The same commit gives the same archive: files have the time of the commit and stand in the order of their names.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import io
import re
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from datetime import datetime, timezone
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SHELLS = {"bash": "slcal.bash", "zsh": "_slcal", "fish": "slcal.fish", "powershell": "_slcal.ps1", "elvish": "slcal.elv"}
TEXTS = ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"]


def output(*command: str | Path) -> str:
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def files(binary: Path, runs_here: bool) -> dict[str, tuple[bytes, int]]:
    """Content and mode of each file of the archive. What the command says of itself needs one that runs here."""
    content = {binary.name: (binary.read_bytes(), 0o755)}
    content |= {name: ((ROOT / name).read_bytes(), 0o644) for name in TEXTS}
    if runs_here:
        for shell, name in SHELLS.items():
            content[f"completions/{name}"] = (output(binary, "completions", shell).encode(), 0o644)
        with tempfile.TemporaryDirectory() as folder:
            output(binary, "man", "--out", folder)
            for page in Path(folder).iterdir():
                content[f"man/{page.name}"] = (page.read_bytes(), 0o644)
    return dict(sorted(content.items()))


def tar(name: str, content: dict[str, tuple[bytes, int]], time: int) -> bytes:
    out = io.BytesIO()
    with gzip.GzipFile(fileobj=out, mode="wb", mtime=time) as packed, tarfile.open(fileobj=packed, mode="w") as archive:
        for path, (data, mode) in content.items():
            entry = tarfile.TarInfo(f"{name}/{path}")
            entry.size, entry.mode, entry.mtime = len(data), mode, time
            archive.addfile(entry, io.BytesIO(data))
    return out.getvalue()


def zipped(name: str, content: dict[str, tuple[bytes, int]], time: int) -> bytes:
    out = io.BytesIO()
    when = datetime.fromtimestamp(time, timezone.utc).timetuple()[:6]
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, (data, mode) in content.items():
            entry = zipfile.ZipInfo(f"{name}/{path}", when)
            entry.external_attr, entry.compress_type = mode << 16, zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return out.getvalue()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", help="target triple [default: this platform]")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--binary", type=Path, help="a command that is built already [default: build it]")
    args = parser.parse_args()
    host = re.search(r"^host: (.*)$", output("rustc", "-vV"), re.M)
    target = args.target or (host[1] if host else "")
    windows = "windows" in target
    binary = args.binary
    if binary is None:
        subprocess.run(["cargo", "build", "--locked", "--release", "-p", "slcal-cli", "--target", target], cwd=ROOT, check=True)
        binary = ROOT / "target" / target / "release" / ("slcal.exe" if windows else "slcal")
    version = re.search(r'^version = "(.*)"$', (ROOT / "Cargo.toml").read_text(encoding="utf-8"), re.M)
    name = f"slcal-{version[1] if version else ''}-{target}"
    time = int(output("git", "log", "-1", "--format=%ct"))
    content = files(binary.resolve(), host is not None and target == host[1])
    packed, suffix = (zipped(name, content, time), ".zip") if windows else (tar(name, content, time), ".tar.gz")
    args.out.mkdir(parents=True, exist_ok=True)
    archive = args.out / f"{name}{suffix}"
    archive.write_bytes(packed)
    digest = hashlib.sha256(packed).hexdigest()
    archive.with_name(archive.name + ".sha256").write_text(f"{digest}  {archive.name}\n", encoding="utf-8")
    print(f"{archive}: {len(content)} files, {len(packed) / 1e6:.1f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
