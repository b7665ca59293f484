"""Many photographs on many machines: reconstruction on a Ray cluster.

:func:`reconstruct` takes photographs from any store that fsspec reads (a folder, a glob pattern, a list of paths or URIs)
or a Ray Data dataset, and makes a PLY per frame and one Parquet table with a row per frame. It needs the extra ``ray`` of
the package.

A frame that fails becomes a row with its error and does not stop the others. A worker that dies is replaced, and its frame is
repeated. Frames that an earlier run has finished stay as they are. A file appears under its name only when it is complete.
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
