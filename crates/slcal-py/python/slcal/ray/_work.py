"""The work of a worker: from each photograph to its cloud and its row."""

from __future__ import annotations

import dataclasses
import json
import os
import platform
import time
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import ray
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import PointCloud, Reconstructor, SequencePattern
from ._frames import StorageOptions, checked_name, name_of_row, open_location
from ._job import HIDDEN, Job, digest, digest_of_image
from ._read import read
from ._scan import Scan, identity_of
from ._store import Store
from ._table import Row, as_table, row_of


@dataclass(frozen=True)
class Task:
    """What a worker needs to process a frame; small, since it is sent to each."""

    #: Refers to the :class:`Job`, which a worker fetches once.
    job: Any
    fingerprint: str
    store: Store
    #: Which run of the job this is.
    run: str
    ledger: Any
    root: str | None
    overwrite: bool
    attempts: int
    options: StorageOptions
    #: Whether the paths are folders, each with the photographs of a sequence.
    scans: bool = False


class Photo(NamedTuple):
    """A row of the dataset: the path of a photograph, and its content where the dataset has it."""

    path: str
    content: bytes | NDArray[Any] | None

    def identity(self, options: StorageOptions) -> str:
        """Changes with the photograph: the metadata of its store (size, time, tag), or a digest of the content."""
        if isinstance(self.content, bytes):
            return digest(self.content)
        if self.content is not None:
            return digest_of_image(self.content)
        fs, path = open_location(self.path, options)
        return str(fs.ukey(path))

    def image(self, options: StorageOptions, *, as_stored: bool = False) -> NDArray[Any]:
        """The pixels, by the reader of the command line: upright, 8 or 16 bit."""
        if isinstance(self.content, np.ndarray):
            return self.content
        content = self.content
        if content is None:
            fs, path = open_location(self.path, options)
            content = fs.cat_file(path)
        return read(content, self.path, as_stored=as_stored)


def work(batch: Any, task: Task) -> pa.Table:
    """The rows of a batch (columns as arrays), one frame at a time; the clouds go only to the store."""
    columns = {name: list(values) for name, values in batch.items()}
    rows = []
    for i, path in enumerate(columns["path"]):
        content = next((columns[name][i] for name in ("bytes", "image") if name in columns), None)
        rows.append(_row(Photo(str(path), content), str(columns["frame"][i]) if "frame" in columns else None, task))
    return as_table(rows)


def _row(photo: Photo, name: str | None, task: Task) -> Row:
    """The row of a frame, with its error if there is one."""
    row = Row(frame=name if name is not None else photo.path, source=photo.path)
    begin = time.perf_counter()
    try:
        row.frame = checked_name(name) if name is not None else name_of_row(photo.path, task.root, folders=task.scans)
        return _FrameWork(photo, row, task).do()
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # A panic of the extension is not an Exception, and must not lose the other frames.
        row.fail(error)
        row.seconds = time.perf_counter() - begin
        return row


class _FrameWork:
    """The work on a frame.

    A frame is finished when its record, a small JSON file, fits the job and the photograph, and its cloud is there in the
    length that the record states. The older cloud goes first, then comes the record and then the cloud: at no time
    is there a cloud beside the record of another one, or without a record.
    """

    def __init__(self, photo: Photo, row: Row, task: Task) -> None:
        self.photo, self.row, self.task = photo, row, task
        self.output = f"{row.frame}.ply"
        self.record = f"{HIDDEN}/frames/{row.frame}.json"

    def do(self) -> Row:
        started = time.perf_counter()
        identity = self.identity()
        if (finished := self.finished(identity)) is not None:
            return finished
        self.row.attempts, source = ray.get(self.task.ledger.begin.remote(self.row.frame, self.row.source))
        self.row.worker = f"{platform.node()}:{os.getpid()}"
        try:
            self.check_attempts(source)
            self.task.store.remove(self.output)
            job, reconstructor = _kept(self.task)
            cloud = self.cloud(job, reconstructor)
            self.write(cloud, identity, started)
        finally:
            self.task.ledger.end.remote(self.row.frame)
        return self.row

    def identity(self) -> str:
        if not self.task.scans:
            return self.photo.identity(self.task.options)
        if self.photo.content is not None:
            raise Error(
                f"{self.row.source}: expected the folder of a scan, found the content of a photograph; leave the columns 'image' "
                "and 'bytes' out",
                what="photos",
            )
        return identity_of(self.photo.path, self.task.options)

    def cloud(self, job: Job, reconstructor: Reconstructor) -> PointCloud:
        if isinstance(job.pattern, SequencePattern):
            return reconstructor.reconstruct(Scan(self.photo.path, job.pattern, self.task.options))
        # A gamma that was asked for is that of the samples in the file.
        as_stored = job.options.get("gamma", "srgb") != "srgb"
        image = self.photo.image(self.task.options, as_stored=as_stored)
        return reconstructor.reconstruct(image, **job.frames)

    def finished(self, identity: str) -> Row | None:
        """The row as it was, when this run or an earlier one has finished the frame.

        Raises
        ------
        FileExistsError
            When there is a cloud of the name that no run has made.
        """
        size = self.task.store.size(self.output)
        if size is None:
            return None
        written = self.task.store.read(self.record)
        if written is None:
            if self.task.overwrite:
                return None
            raise FileExistsError(
                f"{self.output}: expected no such file, or one of an earlier run, found another one; move it away, or give "
                "overwrite=True"
            )
        record = json.loads(written)
        if record["fits"] != self.fits(identity) or record["bytes"] != size:
            return None
        row = row_of(record["row"])
        row.skipped = record["run"] != self.task.run
        return row

    def fits(self, identity: str) -> list[str]:
        return [self.task.fingerprint, self.row.source, identity]

    def check_attempts(self, source: str) -> None:
        if source != self.row.source:
            raise Error(
                f"{self.row.source}: expected a frame with a name of its own, but {source} is {self.row.frame}, too; give the "
                "dataset a column 'frame' with names",
                what="frame",
            )
        if self.row.attempts is not None and self.row.attempts > self.task.attempts:
            raise RuntimeError(
                f"the worker process died each of the {self.task.attempts} times that this frame was begun; it may need more "
                "memory than there is (see Ray's log), or its machine was lost"
            )

    def write(self, cloud: PointCloud, identity: str, started: float) -> None:
        ply = cloud.to_bytes("ply")
        self.row.tell(cloud)
        self.row.output = self.output
        self.row.seconds = time.perf_counter() - started
        record = {
            "fits": self.fits(identity),
            "bytes": len(ply),
            "run": self.task.run,
            "row": dataclasses.asdict(self.row),
        }
        self.task.store.put(self.record, json.dumps(record).encode())
        self.task.store.put(self.output, ply)


#: What a worker process keeps from frame to frame: the run that it is of, and its buffers.
_keeping: tuple[str, Job, Reconstructor] | None = None


def _kept(task: Task) -> tuple[Job, Reconstructor]:
    """The job, and the reconstructor of this process."""
    global _keeping
    if _keeping is None or _keeping[0] != task.run:
        job: Job = ray.get(task.job)
        _keeping = task.run, job, job.reconstructor()
    return _keeping[1:]
