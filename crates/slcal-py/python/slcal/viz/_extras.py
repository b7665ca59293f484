"""The optional libraries, imported on first use."""

from __future__ import annotations

import importlib
from typing import Any


def need(module: str) -> Any:
    """A module of matplotlib or of rerun.

    Raises
    ------
    ImportError
        When it is not installed; the message says how to install it.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as missing:
        library = module.partition(".")[0]
        if (missing.name or "").partition(".")[0] not in (library, "matplotlib", "mpl_toolkits"):
            raise  # The library is there, but one of its own dependencies is missing.
        library = {"rerun": "rerun-sdk", "mpl_toolkits": "matplotlib"}.get(library, library)
        raise ImportError(
            f"this function of slcal.viz needs {library}, which is not installed: pip install {library}",
            name=module,
        ) from missing
