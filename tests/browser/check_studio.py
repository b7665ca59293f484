"""Uses `slcal studio` as people do and as they should not: in a real browser, by requests, by ending it at a bad moment.

    check_studio.py --slcal target/release/slcal [--pictures DIR] [--only PART_OF_A_NAME ...]

Every check is a function whose name says what holds. Passes with a word about it where Chromium or its driver is not installed:
what needs no browser is checked all the same. `--pictures` keeps screenshots of every step, wide and narrow, light and dark.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from functools import partial
from pathlib import Path

import studio_access
import studio_camera
import studio_demo
import studio_files
import studio_sequence
from browser import chromium
from studio_bench import Bench
from studio_pages import browser
from studio_server import Skipped

WITHOUT_BROWSER: tuple[Callable[[Bench], None], ...] = (*studio_access.CHECKS, *studio_files.CHECKS, *studio_camera.TIMES)


def check(bench: Bench, only: list[str]) -> list[str]:
    """The names of those that failed."""
    wanted: Callable[[Callable[..., None]], bool] = lambda of: not only or any(part in of.__name__ for part in only)
    failed: list[str] = []

    def run(name: str, do: Callable[[], None]) -> None:
        begun = time.monotonic()
        try:
            do()
            print(f"ok      {name}, {time.monotonic() - begun:.1f} s", flush=True)
        except Skipped as why:
            print(f"skipped {name}: {why}", flush=True)
        except Exception:  # The other checks are of use all the same.
            failed.append(name)
            print(f"FAILED  {name}, {time.monotonic() - begun:.1f} s\n{traceback.format_exc(limit=-4)}", flush=True)

    for of in filter(wanted, WITHOUT_BROWSER):
        run(of.__name__, partial(of, bench))
    if chromium() is None:
        print("skipped: the pages, because chromium and chromedriver are not both installed")
        return failed
    demo = list(filter(wanted, (*studio_demo.CHECKS, *studio_sequence.CHECKS)))
    if demo:
        with browser() as shared:
            for page in demo:
                run(page.__name__, partial(page, bench, shared))
    for of in filter(wanted, studio_camera.CHECKS):
        run(of.__name__, partial(of, bench))
    return failed


def attempt(slcal: Path, pictures: Path | None, only: list[str]) -> list[str]:
    """The names of the checks that failed, in a folder of their own."""
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(slcal.resolve(), Path(folder), pictures)
        with bench.until_end:
            failed = check(bench, only)
    for figure in bench.figures:
        print(figure)
    return failed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slcal", type=Path, required=True, help="the program to test")
    parser.add_argument("--pictures", type=Path, help="a folder for screenshots")
    parser.add_argument("--only", nargs="+", default=[], help="parts of the names of checks; the others are left out")
    args = parser.parse_args()
    begun = time.monotonic()
    failed = attempt(args.slcal, args.pictures, args.only)
    if failed:
        # Browsers, a server and simulated photographs share a busy machine: what fails is tried once more, from the beginning.
        print(f"again: {', '.join(failed)}", flush=True)
        failed = attempt(args.slcal, args.pictures, failed)
    print(f"{len(failed)} failed{': ' if failed else ''}{', '.join(failed)}; {time.monotonic() - begun:.0f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
