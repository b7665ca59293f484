"""The result of each frame: a row of the table."""

from __future__ import annotations

import dataclasses
import io
import math
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from .._slcal import PointCloud

#: The name of the table in the output folder.
RESULTS = "results.parquet"


@dataclass
class Row:
    """The result of a frame; fields that a failed one does not have are None."""

    frame: str
    source: str
    #: The cloud's name in the output folder.
    output: str | None = None
    #: Whether an earlier run made it.
    skipped: bool = False
    points: int | None = None
    triangles: int | None = None
    crossings: int | None = None
    decoded: int | None = None
    slits: int | None = None
    #: Median 1σ along the camera's ray, mm, with and without the rig's own uncertainty.
    median_sigma_mm: float | None = None
    median_noise_mm: float | None = None
    #: For reading and reconstructing.
    seconds: float | None = None
    #: How often it was begun: more than once after workers that died.
    attempts: int | None = None
    #: host:pid.
    worker: str | None = None
    #: The exception's class and message.
    error_type: str | None = None
    error: str | None = None

    def tell(self, cloud: PointCloud) -> None:
        """Sets the figures of a cloud."""
        self.points, self.triangles = len(cloud), len(cloud.triangles)
        if (report := cloud.report) is None:
            return
        self.median_sigma_mm = _finite(report.triangulate.median_sigma_mm)
        self.median_noise_mm = _finite(report.triangulate.median_noise_mm)
        if (decode := report.decode) is not None:
            self.crossings, self.decoded, self.slits = decode.crossings, decode.decoded, decode.slits
        if (sequence := report.sequence) is not None:
            self.decoded = sequence.decoded

    def fail(self, error: BaseException) -> None:
        """Sets an error instead of a result."""
        self.error_type, self.error = type(error).__name__, str(error)


#: The columns of the table, the same whatever the frames were.
SCHEMA = pa.schema(
    [
        pa.field("frame", pa.string(), False),
        pa.field("source", pa.string(), False),
        pa.field("output", pa.string()),
        pa.field("skipped", pa.bool_(), False),
        pa.field("points", pa.int64()),
        pa.field("triangles", pa.int64()),
        pa.field("crossings", pa.int64()),
        pa.field("decoded", pa.int64()),
        pa.field("slits", pa.int64()),
        pa.field("median_sigma_mm", pa.float64()),
        pa.field("median_noise_mm", pa.float64()),
        pa.field("seconds", pa.float64()),
        pa.field("attempts", pa.int64()),
        pa.field("worker", pa.string()),
        pa.field("error_type", pa.string()),
        pa.field("error", pa.string()),
    ]
)


def as_table(rows: list[Row]) -> pa.Table:
    """Rows as a table of :data:`SCHEMA`."""
    return pa.Table.from_pylist([dataclasses.asdict(row) for row in rows], schema=SCHEMA)


def row_of(fields: Any) -> Row:
    """From a dictionary of the fields.

    Raises
    ------
    TypeError
        When they are not those of a row.
    """
    return Row(**fields)


def parquet(table: pa.Table) -> bytes:
    """The table as a file."""
    buffer = io.BytesIO()
    pq.write_table(table, buffer)
    return buffer.getvalue()


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
