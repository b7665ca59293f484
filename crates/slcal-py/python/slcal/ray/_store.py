"""Files of a job, on any store that fsspec writes. They appear under their names only when they are complete."""

from __future__ import annotations

import functools
import os
import secrets
from dataclasses import dataclass, field

import fsspec
from fsspec.implementations.local import LocalFileSystem

from ._frames import StorageOptions, open_location

#: Stores that show an object only when all of it has arrived.
_ATOMIC = {"s3", "s3a", "gs", "gcs", "abfs", "abfss", "az", "oss", "r2", "memory"}

_PART = ".slcal-part-"


@dataclass(frozen=True)
class Store:
    """A folder for outputs; pickled as its address."""

    url: str
    options: StorageOptions = field(default_factory=dict)

    @functools.cached_property
    def _place(self) -> tuple[fsspec.AbstractFileSystem, str]:
        fs, root = open_location(self.url, self.options)
        return fs, root.rstrip("/") or "/"

    @property
    def _is_atomic(self) -> bool:
        protocol = self._place[0].protocol
        return not _ATOMIC.isdisjoint({protocol} if isinstance(protocol, str) else protocol)

    def __getstate__(self) -> dict[str, object]:
        return {"url": self.url, "options": self.options}

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)

    def _path(self, name: str) -> str:
        return f"{self._place[1].rstrip('/')}/{name}"

    def size(self, name: str) -> int | None:
        """The size of a file in bytes; None when it is not there."""
        fs = self._place[0]
        try:
            info = fs.info(self._path(name))
        except FileNotFoundError:
            return None
        return int(info["size"] or 0)

    def read(self, name: str) -> bytes | None:
        """The content of a file; None when it is not there."""
        try:
            return bytes(self._place[0].cat_file(self._path(name)))
        except FileNotFoundError:
            return None

    def remove(self, name: str) -> None:
        """Removes a file where it exists."""
        try:
            self._place[0].rm_file(self._path(name))
        except FileNotFoundError:
            pass

    def put(self, name: str, data: bytes) -> None:
        """Writes or replaces a file, atomically for readers.

        Local files are written beside their place under a name of their own, brought to the disk and renamed. Object stores
        show an object when all of it has arrived. Elsewhere the file is written under another name and moved.
        """
        fs, path = self._place[0], self._path(name)
        folder = path.rpartition("/")[0]
        part = f"{folder}/{_PART}{secrets.token_hex(8)}"
        if isinstance(fs, LocalFileSystem):
            _put_local(part, path, data)
        elif self._is_atomic:
            fs.pipe_file(path, data)
        else:
            fs.makedirs(folder, exist_ok=True)
            fs.pipe_file(part, data)
            fs.mv(part, path)

    def tidy(self) -> None:
        """Removes temporary files of workers that died; no other job may be writing here."""
        fs, root = self._place
        if self._is_atomic:
            return
        for path in fs.find(root):
            if path.rpartition("/")[2].startswith(_PART):
                fs.rm_file(path)


def _put_local(part: str, path: str, data: bytes) -> None:
    folder = os.path.dirname(path)
    os.makedirs(folder, exist_ok=True)
    try:
        with open(part, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        if os.path.exists(part):
            os.remove(part)
        raise
    if os.name == "posix":
        # The name is part of the folder, which is brought to the disk on its own.
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
