#!/usr/bin/env python3
"""Run the commands that the documentation shows, and put what they print beneath them.

    console_blocks.py [--check] [--slcal target/release/slcal] [FILE.md ...]

A block that begins with ```console holds commands after `$ ` and their output. All blocks of a file run one after the other in one
fresh folder that holds the demonstration's photographs and those of fixtures/, as if somebody typed them. Output to both
streams is shown, as a terminal would. `<!-- exit 5 -->` before a block says that its last command ends with that code;
otherwise every command must succeed. `<!-- hidden: COMMAND -->` runs a command that is not shown.

With --check nothing is written: the commands must run, and their output must be that of the file but for digits, so that the last
decimal of another machine does not matter.
"""

import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from shutil import copy

ROOT = Path(__file__).resolve().parent.parent
PAGES = ["README.md", "docs/interpreting-results.md", "docs/uncertainty.md", "docs/cli.md"]
BLOCK = re.compile(
    r"<!-- hidden: (?P<hidden>[^\n]*?) -->|(?:<!-- exit (?P<code>\d+) -->\n)?```console\n(?P<body>.*?)```", re.S
)


class Failed(Exception):
    """A command did not do what the page says."""


def run(command, folder, slcal, expected):
    shell = command.replace("slcal ", f'"{slcal}" ', 1)
    done = subprocess.run(shell, shell=True, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600)
    if done.returncode != expected:
        raise Failed(f"{command}\nexpected exit {expected}, found {done.returncode}\n{done.stdout}")
    return done.stdout


def renewed(text, folder, slcal):
    def block(match):
        if match["hidden"]:
            run(match["hidden"], folder, slcal, 0)
            return match[0]
        commands = [line[2:] for line in match["body"].splitlines() if line.startswith("$ ")]
        code = int(match["code"] or 0)
        body = ""
        for i, command in enumerate(commands):
            body += f"$ {command}\n" + run(command, folder, slcal, code if i + 1 == len(commands) else 0)
        marker = f"<!-- exit {code} -->\n" if code else ""
        return f"{marker}```console\n{body}```"

    return BLOCK.sub(block, text)


def prepare(folder, slcal):
    demo = Path(folder) / "demo"
    subprocess.run([slcal, "demo", "--out", demo], check=True, capture_output=True)
    for photo in [*demo.glob("sheet.jpg"), *demo.glob("board.jpg"), *demo.glob("head.jpg"), *(ROOT / "fixtures").glob("*.jpg")]:
        copy(photo, folder)


def without_digits(text):
    """Words alone: numbers and the spaces that align them differ between machines."""
    return re.sub(r"[ \t]+", " ", re.sub(r"-?\d+(\.\d+)?(e-?\d+)?", "0", text))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; fail where a page is out of date")
    parser.add_argument("--slcal", default=ROOT / "target/release/slcal", type=Path)
    parser.add_argument("pages", nargs="*", default=PAGES, metavar="FILE.md")
    args = parser.parse_args()
    slcal = args.slcal.resolve()
    stale = 0
    for page in args.pages:
        path = ROOT / page
        text = path.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            prepare(folder, slcal)
            try:
                new = renewed(text, folder, slcal)
            except Failed as failed:
                sys.exit(f"{page}: {failed}")
        same = without_digits(new) == without_digits(text)
        print(f"{page}: {'runs' if same else 'is out of date' if args.check else 'renewed'}")
        if args.check:
            stale += not same
        elif new != text:
            path.write_text(new, encoding="utf-8")
    if stale:
        sys.exit("run scripts/console_blocks.py and read what changed")


if __name__ == "__main__":
    main()
