"""Every public name is documented: examples run, parameters are those of the signature, editors show it."""

from __future__ import annotations

import doctest
import inspect
import re
import subprocess
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from common import REPOSITORY

import slcal
import slcal.reports
import slcal.simulate
import slcal.viz

MODULES = [slcal, slcal.reports, slcal.simulate, slcal.viz]
#: Names that a class has from NumPy's or Python's protocols, and that are described there.
PROTOCOLS = re.compile(r"__\w+__|_\w+")


def public_names() -> Iterator[tuple[str, Any]]:
    """Everything that users reach by a name without underscore, extension types' members included: doctest's
    own finder does not look into those."""
    seen: set[int] = set()
    for module in MODULES:
        yield module.__name__, module
        for name in getattr(module, "__all__", [n for n in vars(module) if not n.startswith("_")]):
            found = getattr(module, name)
            own = str(getattr(found, "__module__", "")).startswith("slcal")
            if not own or id(found) in seen or isinstance(found, types.ModuleType):
                continue
            seen.add(id(found))
            yield f"{module.__name__}.{name}", found
            if inspect.isclass(found):
                for member in vars(found):
                    if not PROTOCOLS.fullmatch(member):
                        yield f"{module.__name__}.{name}.{member}", inspect.getattr_static(found, member)


NAMES = dict(public_names())


def docstring(found: Any) -> str:
    """Staticmethods and classmethods carry that of their function."""
    return inspect.cleandoc(getattr(found, "__func__", found).__doc__ or "")


def is_field(name: str) -> bool:
    """The default of a class's attribute, which the class describes."""
    owner, _, field = name.rpartition(".")
    if field in getattr(NAMES.get(owner), "_fields", ()):  # Of a named tuple.
        return True
    return inspect.isclass(NAMES.get(owner)) and isinstance(NAMES[name], (str, type(None), tuple, float, int))


@pytest.mark.parametrize("name", [n for n in NAMES if not is_field(n)])
def test_is_documented(name: str) -> None:
    doc = docstring(NAMES[name])
    assert doc, f"{name} has no docstring"
    first = doc.splitlines()[0]
    assert first.endswith((".", ":", ";")) or len(doc.splitlines()) > 1, (
        f"{name}: the first line is a sentence: {first!r}"
    )


def parameters_described(doc: str) -> list[str]:
    """The names in the section Parameters: lines without indentation, "a, b : type" or "a, b"."""
    section = re.search(r"^Parameters\n-{3,}\n(.*?)(?=^\w[^\n]*\n-{3,}$|\Z)", doc, re.M | re.S)
    if section is None:
        return []
    heads = re.findall(r"^(\*{0,2}\w[^:\n]*?)(?: ?:.*)?$", section[1], re.M)
    return [name.strip().lstrip("*") for head in heads for name in head.split(",")]


def with_parameters() -> list[str]:
    return [n for n, found in NAMES.items() if parameters_described(docstring(found))]


@pytest.mark.parametrize("name", with_parameters())
def test_parameters_are_those_of_the_signature(name: str) -> None:
    found = NAMES[name]
    signature = inspect.signature(getattr(found, "__func__", found))
    taken = [p for p in signature.parameters if p not in ("self", "cls")]
    assert sorted(parameters_described(docstring(found))) == sorted(taken), f"{name}{signature}"


def test_functions_of_many_parameters_describe_them() -> None:
    """Two or fewer a sentence can describe."""
    for name, found in NAMES.items():
        if not callable(found) or hasattr(found, "__dataclass_fields__"):
            continue
        if inspect.isclass(found) and issubclass(found, Exception):
            continue
        try:
            taken = [p for p in inspect.signature(found).parameters if p not in ("self", "cls")]
        except ValueError:  # A class without constructor.
            continue
        assert len(taken) <= 2 or parameters_described(docstring(found)), f"{name} does not describe {taken}"


def with_examples() -> list[str]:
    return [n for n, found in NAMES.items() if ">>>" in docstring(found)]


@pytest.mark.parametrize("name", with_examples())
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if name.startswith("slcal.viz"):
        pytest.importorskip("matplotlib", reason="matplotlib is not installed: pip install matplotlib")
        if "rerun" in name:
            pytest.importorskip("rerun", reason="rerun is not installed: pip install rerun-sdk")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    example = doctest.DocTestParser().get_doctest(
        docstring(NAMES[name]), {"slcal": slcal, "np": np}, name, name, 0
    )
    said: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE).run(
        example, out=said.append
    )
    assert not said, "".join(said)


def test_there_are_examples() -> None:
    """Else the ones above would pass for want of any."""
    assert {"slcal.CheckerPattern", "slcal.Camera", "slcal.Rig", "slcal.Rig.to_opencv"} <= set(
        with_examples()
    )
    assert {"slcal.Camera", "slcal.Rig.from_opencv", "slcal.CheckerPattern"} <= set(with_parameters())


def test_editors_show_the_docstrings() -> None:
    """They read the stub, into which scripts/stub_docs.py copies them."""
    script = REPOSITORY / "scripts/stub_docs.py"
    if not script.exists():
        pytest.skip("scripts/stub_docs.py is not at hand: these tests run outside the repository")
    done = subprocess.run([sys.executable, script, "--check"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
