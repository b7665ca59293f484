"""Tables and pictures onto docs/experiments.md."""

import re
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"


def put(folder, tables):
    """Replaces what stands between the markers of each table, {name: Markdown}, and the pictures of the same names as those in `folder`."""
    place = DOCS / "experiments.md"
    text = place.read_text()
    for name, table in tables.items():
        pattern = rf"(<!-- table {name} -->\n).*?(<!-- end -->)"
        text, count = re.subn(pattern, lambda m: f"{m[1]}\n{table}\n\n{m[2]}", text, flags=re.S)
        if count != 1:
            sys.exit(f"{place}: expected one pair of markers <!-- table {name} --> and <!-- end -->, found {count}")
    place.write_text(text)
    for picture in folder.glob("*.png"):
        (DOCS / "images" / picture.name).write_bytes(picture.read_bytes())
