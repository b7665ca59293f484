#!/usr/bin/env python3
"""Copies the docstrings of the built extension into its stub, where editors look for them.

    scripts/stub_docs.py            rewrites crates/slcal-py/python/slcal/_slcal.pyi
    scripts/stub_docs.py --check    says what would change, and fails if anything would

The docstrings are written once, beside the Rust code; types are written once, in the stub. Needs the package
that was built from this very source: installed, or on PYTHONPATH.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

STUB = Path(__file__).resolve().parents[1] / "crates/slcal-py/python/slcal/_slcal.pyi"
Documented = ast.ClassDef | ast.FunctionDef


def documented(source: str, module: ModuleType) -> str:
    """The stub `source` with the docstrings of `module` in the place of its own."""
    lines = source.splitlines()
    edits: list[tuple[tuple[int, int], tuple[int, int], str]] = []
    for node in ast.parse(source).body:
        if not isinstance(node, Documented) or not hasattr(module, node.name):
            continue
        found = getattr(module, node.name)
        edits.append(edit(node, found.__doc__))
        members = node.body if isinstance(node, ast.ClassDef) else []
        for member in members:
            # Dunder methods do what Python says that they do; __new__ is described with its class.
            if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                edits.append(edit(member, getattr(getattr(found, member.name, None), "__doc__", None)))
    for (first, start), (last, end), text in sorted(edits, reverse=True):
        lines[first : last + 1] = (lines[first][:start].rstrip() + text + lines[last][end:]).split("\n")
    return "\n".join(line.rstrip() for line in lines) + "\n"


def edit(node: Documented, doc: str | None) -> tuple[tuple[int, int], tuple[int, int], str]:
    """From where to where (line, column) the stub is replaced, and by what."""
    body = node.body
    old = body[0] if ast.get_docstring(node) is not None else None
    rest = [s for s in body if s is not old and not is_dots(s)]
    indent = " " * (node.col_offset + 4)
    after_colon = end_of_signature(node)
    if rest:
        first = min([rest[0].lineno, *(d.lineno for d in getattr(rest[0], "decorator_list", []))])
        end = (first - 1, 0)
        text = f"{quoted(doc, indent)}\n\n" if doc else "\n"
    else:
        end = (body[-1].end_lineno or 1) - 1, body[-1].end_col_offset or 0
        text = quoted(doc, indent) if doc else " ..."
    return after_colon, end, text


def is_dots(statement: ast.stmt) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and statement.value.value is ...
    )


def end_of_signature(node: Documented) -> tuple[int, int]:
    """Line and column of what follows the colon that the body follows."""
    if isinstance(node, ast.ClassDef):
        tokens: list[ast.AST] = [*node.bases, *node.keywords]
        assert not tokens, f"{node.name}: classes of the extension have no bases"
        return node.lineno - 1, node.col_offset + len(f"class {node.name}:")
    assert node.returns is not None, f"{node.name} says what it returns"
    return (node.returns.end_lineno or 1) - 1, (node.returns.end_col_offset or 0) + len(":")


def quoted(doc: str, indent: str) -> str:
    lines = doc.strip().splitlines()
    text = "\n".join((indent + line).rstrip() if i else line for i, line in enumerate(lines))
    raw = "r" if "\\" in text else ""
    end = f"\n{indent}" if len(lines) > 1 else ""
    return f'\n{indent}{raw}"""{text}{end}"""'


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--check", action="store_true", help="change nothing; fail if the stub is not up to date"
    )
    check: bool = parser.parse_args().check

    import slcal._slcal as extension

    module: Any = extension
    old = STUB.read_text(encoding="utf-8")
    new = documented(old, module)
    assert documented(new, module) == new and ast.dump(undocumented(old)) == ast.dump(undocumented(new))
    if old == new:
        return 0
    if check:
        diff = difflib.unified_diff(
            old.splitlines(), new.splitlines(), "the stub", "the docstrings", lineterm=""
        )
        print("\n".join(diff))
        print(
            "The stub does not say what the extension's docstrings say; run scripts/stub_docs.py",
            file=sys.stderr,
        )
        return 1
    STUB.write_text(new, encoding="utf-8")
    return 0


def undocumented(source: str) -> ast.Module:
    """The types alone."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, Documented):
            if ast.get_docstring(node) is not None:
                del node.body[0]
            node.body = [s for s in node.body if not is_dots(s)]
    return tree


if __name__ == "__main__":
    sys.exit(main())
