"""Many photographs on many machines: reconstruction on a Ray cluster.

:func:`reconstruct` takes photographs from any store that fsspec reads (a folder, a glob pattern, a list of paths or URIs)
or a Ray Data dataset, and makes a PLY per frame and one Parquet table that tells what became of each of them. It needs the
extra: ``pip install slcal[ray]``.

A bad frame is a row with its error and fails nothing else; a worker that dies is replaced and its frame done again; frames
that an earlier run has finished are left as they are; and a file is there under its name only when it is complete.
"""

from __future__ import annotations

try:
    import fsspec  # noqa: F401
    import pyarrow  # noqa: F401
    import ray.data  # noqa: F401
except ImportError as error:
    raise ImportError(
        f"slcal.ray needs Ray Data, PyArrow and fsspec ({error}); install them with: pip install 'ray[data]' pyarrow fsspec",
        name=error.name,
    ) from error

from ._frames import find_photos
from ._run import reconstruct
from ._table import RESULTS, SCHEMA

__all__ = ["RESULTS", "SCHEMA", "find_photos", "reconstruct"]
