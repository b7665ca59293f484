"""Scans by sequences: a folder of photographs each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, overload

from numpy.typing import NDArray

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
        When there are not as many as the pattern has frames, or one that it names is missing or there twice.
    """
    names = [path.rpartition("/")[2] for path in paths]
    return [paths[i] for i in pattern._frame_order(names, folder)]
