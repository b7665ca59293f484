#!/usr/bin/env python3
"""Check that links lead somewhere.

    links.py                 those in README.md, CHANGELOG.md and docs/: files and the headings in them
    links.py target/book     those in the pages of a book that was built
    links.py outside         a preprocessor of mdbook: links that leave docs/ lead to the repository, which the book is not part of
"""

import json
import os
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"(!?\[(?:[^\[\]]|\[[^\]]*\])*\]\()([^()\s]+)(\))")
FENCED = re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.S | re.M)
CODE = re.compile(FENCED.pattern + r"|`[^`\n]*`", re.S | re.M)


def elsewhere(target):
    return re.match(r"[a-z][a-z+.-]*:", target) is not None


def prose(text):
    """A page without its code, on as many lines."""
    return CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def anchors(text):
    """The names of a page's headings, as the web view of the repository and mdbook make them."""
    names = []
    for heading in re.findall(r"^#{1,6} +(.+?) *$", FENCED.sub("", text), re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        names.append("".join(c for c in heading.replace(" ", "-") if c.isalnum() or c in "-_"))
    return {name + (f"-{before}" if before else "") for i, name in enumerate(names) for before in [names[:i].count(name)]}


def broken_in_sources():
    pages = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "packaging/README.md"]
    pages += [*sorted((ROOT / "crates").glob("*/README.md")), *sorted((ROOT / "docs").glob("*.md"))]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for match in LINK.finditer(prose(text)):
            if elsewhere(match[2]):
                continue
            path, _, anchor = unquote(match[2]).partition("#")
            target = page.parent / path if path else page
            line = text.count("\n", 0, match.start()) + 1
            if not target.exists():
                yield f"{page.relative_to(ROOT)}:{line}: {match[2]}: no such file"
            elif anchor and target.suffix == ".md" and anchor not in anchors(target.read_text(encoding="utf-8")):
                yield f"{page.relative_to(ROOT)}:{line}: {match[2]}: no such heading"


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.names = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name in ("id", "name") and value:
                self.names.add(value)
            elif name in ("href", "src") and value and tag != "base":
                self.links.append(value)


def broken_in_book(folder):
    pages = {p.resolve(): Page(p.read_text(encoding="utf-8")) for p in Path(folder).rglob("*.html")}
    if not pages:
        yield f"{folder}: no pages; run mdbook build first"
    for path, page in pages.items():
        # That page stands in for all addresses, so its links are not relative to it.
        for link in page.links if path.name != "404.html" else []:
            if elsewhere(link):
                continue
            file, _, anchor = unquote(link).partition("#")
            target = Path(os.path.normpath(path.parent / file)) if file else path
            if not target.exists():
                yield f"{path.name}: {link}: no such file"
            elif anchor and target in pages and anchor not in pages[target].names:
                yield f"{path.name}: {link}: no such heading"


def outside():
    """Reads [context, book] from stdin and writes the book, as mdbook wants it."""
    if sys.argv[2:3] == ["supports"]:
        return
    context, book = json.load(sys.stdin)
    repository = context["config"]["output"]["html"]["git-repository-url"]
    docs = ROOT / context["config"]["book"]["src"]

    def lead_out(match, page):
        target = match[2]
        if elsewhere(target) or target.startswith("#"):
            return match[0]
        file = os.path.relpath(docs / page / ".." / target, ROOT)
        return match[0] if file.startswith(docs.name + os.sep) else f"{match[1]}{repository}/blob/main/{file}{match[3]}"

    def visit(items):
        for item in items:
            if chapter := isinstance(item, dict) and item.get("Chapter"):
                text, bare = chapter["content"], prose(chapter["content"])
                for match in reversed(list(LINK.finditer(bare))):
                    whole = LINK.match(text, match.start())
                    if whole:
                        text = text[: match.start()] + lead_out(whole, chapter["path"]) + text[whole.end() :]
                chapter["content"] = text
                visit(chapter["sub_items"])

    visit(book.get("items", book.get("sections", [])))
    json.dump(book, sys.stdout)


def main():
    if sys.argv[1:2] == ["outside"]:
        return outside()
    broken = list(broken_in_book(sys.argv[1]) if sys.argv[1:] else broken_in_sources())
    print(*broken, sep="\n", end="\n" if broken else "")
    sys.exit(f"{len(broken)} links lead nowhere" if broken else 0)


if __name__ == "__main__":
    main()
