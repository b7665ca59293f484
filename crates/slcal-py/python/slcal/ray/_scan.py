"""Scans by sequences: a folder of photographs each."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import Any, overload

from numpy.typing import NDArray

from .._errors import Error
from .._slcal import SequencePattern
from ._frames import StorageOptions, open_location, photos_in
from ._job import digest
from ._read import read


class Scan(Sequence[NDArray[Any]]):
    """The photographs of a folder in the order of the pattern; each is read when it is asked for."""

    def __init__(self, folder: str, pattern: SequencePattern, options: StorageOptions) -> None:
        self._fs, path = open_location(folder, options)
        self._paths = in_order(folder, photos_in(self._fs, path), pattern)

    def __len__(self) -> int:
        return len(self._paths)

    @overload
    def __getitem__(self, index: int) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[NDArray[Any]]: ...
    def __getitem__(self, index: int | slice) -> NDArray[Any] | Sequence[NDArray[Any]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        path = self._paths[index]
        return read(self._fs.cat_file(path), path)


def identity_of(folder: str, options: StorageOptions) -> str:
    """Changes with any of the photographs in a folder, by the metadata of the store (size, time, tag)."""
    fs, path = open_location(folder, options)
    return digest("\n".join(f"{photo} {fs.ukey(photo)}" for photo in photos_in(fs, path)).encode())


def in_order(folder: str, paths: Sequence[str], pattern: SequencePattern) -> list[str]:
    """The photographs that the pattern names, whatever their format; if it names none of them, all in natural order.

    Raises
    ------
    slcal.Error
        When there are not as many as the pattern has frames, or one that it names is missing.
    """
    by_stem = {_stem(path): path for path in paths}
    files = [frame.get("file") for frame in pattern.frames]
    stems = [_stem(file) for file in files if file is not None]
    if len(stems) == len(files) and any(stem in by_stem for stem in stems):
        missing = [file for file, stem in zip(files, stems, strict=True) if stem not in by_stem]
        if missing:
            more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
            raise Error(
                f"{folder}: expected a photograph for each of the {len(files)} frames that the pattern names, found none for "
                f"{missing[0]}{more}; add it, or give a pattern without names of files",
                what="frames",
            )
        return [by_stem[stem] for stem in stems]
    if len(paths) != len(files):
        raise Error(
            f"{folder}: expected {len(files)} photographs, one for each frame of the pattern, found {len(paths)}; leave others "
            "out, or give the pattern of these photographs",
            what="frames",
            expected=str(len(files)),
            found=str(len(paths)),
        )
    return sorted(paths, key=_natural)


def _stem(path: str) -> str:
    return PurePosixPath(path).stem.lower()


def _natural(path: str) -> list[tuple[bool, int, str]]:
    """Numbers within a name by their value: 2 before 10."""
    name = path.rpartition("/")[2]
    parts = re.split(r"(\d+)", name, flags=re.ASCII)
    return [(i % 2 == 0, int(part) if i % 2 else 0, part) for i, part in enumerate(parts) if part]
