import subprocess
import sys

import pytest

ONE_POINT = "slcal.PointCloud([[0.0, 0.0, 900.0]])"


def run(script):
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)


def test_importing_imports_no_extra():
    extras = "{'matplotlib', 'mpl_toolkits', 'rerun'}"
    said = run(f"import sys, slcal, slcal.viz; print(sorted({extras} & set(sys.modules)))")
    assert said.stdout.strip() == "[]", said.stderr


@pytest.mark.parametrize(
    ("library", "call"),
    [
        ("matplotlib", f"cloud({ONE_POINT})"),
        ("matplotlib", "rig(slcal.Rig(slcal.Camera.from_fov((640, 480), 50.0)))"),
        ("matplotlib", "overlay(np.zeros((9, 9), np.uint8), slcal.Matches([[1.0, 2.0]], columns=[3.0]))"),
        ("rerun", f"to_rerun(cloud={ONE_POINT})"),
    ],
)
def test_a_missing_library_is_named_with_how_to_get_it(library, call):
    script = f"""
import sys
sys.modules[{library!r}] = None
import numpy as np, slcal, slcal.viz
try:
    slcal.viz.{call}
except ImportError as error:
    print(error)
"""
    said = run(script)
    package = {"rerun": "rerun-sdk"}.get(library, library)
    assert f"pip install {package}" in said.stdout, said.stderr
    assert library in said.stdout
