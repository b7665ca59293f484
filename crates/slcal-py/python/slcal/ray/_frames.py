"""Names of the frames of a job, and the locations of their photographs."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from typing import Any, NamedTuple, TypeAlias
from urllib.parse import urlsplit

import fsspec
import fsspec.core

from .._errors import Error

Path: TypeAlias = str | os.PathLike[str]
#: Options of the file systems of fsspec by protocol: {"s3": {"endpoint_url": ...}}.
StorageOptions: TypeAlias = Mapping[str, Mapping[str, Any]]

#: What photographs' names end in where a whole folder is given.
ENDINGS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp", ".bmp")


class Frame(NamedTuple):
    """A frame's name, which its outputs take, and the path or URI of its photograph."""

    name: str
    path: str


def location(path: Path) -> str:
    """A path or URI that means the same in every process: local paths become absolute."""
    path = os.fspath(path)
    return path if "://" in path or "::" in path else os.path.abspath(path)


def open_location(url: str, options: StorageOptions) -> tuple[fsspec.AbstractFileSystem, str]:
    """The file system that a path or URI is on, and its path there."""
    protocols = {bit.split("://")[0] if "://" in bit else bit for bit in url.split("::")}
    mine = {protocol: dict(options[protocol]) for protocol in protocols & options.keys()}
    fs, path = fsspec.core.url_to_fs(url, **mine)
    return fs, path


def find_photos(place: Path, *, storage_options: StorageOptions | None = None) -> list[str]:
    """The photographs in a folder or of a glob pattern, on any store that fsspec reads.

    Parameters
    ----------
    place : path or URI
        A folder (its PNG, JPEG, TIFF, WebP and BMP files are taken, not those of folders in it), a pattern such as
        ``"s3://bucket/scan/**/*.png"``, or one photograph.
    storage_options : mapping, optional
        Options of the file systems by protocol, e.g. ``{"s3": {"endpoint_url": ...}}``.

    Returns
    -------
    list of str
        Paths or URIs, sorted.

    Raises
    ------
    OSError
        When the folder cannot be read.
    slcal.Error
        When there is no photograph.
    """
    url = location(place)
    fs, path = open_location(url, storage_options or {})
    if any(c in path for c in "*?[") and not fs.exists(path):
        seen = [p for p in fs.glob(path) if not fs.isdir(p)]
    elif fs.isdir(path):
        seen = photos_in(fs, path)
    else:
        return [url]
    found = _shown(seen)
    if not found:
        raise Error(
            f"{url}: expected photographs ({', '.join(ENDINGS)}), found none; give their folder, or a pattern such as "
            "photos/*.png",
            what="photographs",
        )
    return [_again(url, fs, p) for p in found]


def photos_in(fs: fsspec.AbstractFileSystem, folder: str) -> list[str]:
    """The photographs in a folder, not those of folders in it."""
    return _shown(p for p in fs.ls(folder, detail=False) if p.lower().endswith(ENDINGS))


def find_scans(place: Path, *, storage_options: StorageOptions | None = None) -> list[str]:
    """The folders of a glob pattern, or the one folder that is given: each has the photographs of a scan.

    Raises
    ------
    OSError
        When the store cannot be read.
    slcal.Error
        When there is no folder.
    """
    url = location(place)
    fs, path = open_location(url, storage_options or {})
    if any(c in path for c in "*?[") and not fs.exists(path):
        found = _shown(p.rstrip("/") for p in fs.glob(path) if fs.isdir(p))
        if found:
            return [_again(url, fs, p) for p in found]
    elif fs.isdir(path):
        return [url]
    raise Error(
        f"{url}: expected folders, each with the photographs of a scan, found none; give a list of folders, or a pattern such "
        "as scans/*",
        what="photos",
    )


def _shown(paths: Iterable[str]) -> list[str]:
    """Without hidden files, which are what systems leave beside photographs; sorted."""
    return sorted(p for p in paths if not p.rpartition("/")[2].startswith("."))


def _again(url: str, fs: fsspec.AbstractFileSystem, path: str) -> str:
    """The path or URI of what was found on the file system of `url`."""
    if "::" in url:
        # What a file of a chain (zip://*.png::s3://...) is reached through stays behind it.
        first, *rest = url.split("::")
        return "::".join([f"{first.split('://')[0]}://{path.lstrip('/')}", *rest])
    return str(fs.unstrip_protocol(path)) if "://" in url else path


def name_frames(
    photos: Mapping[str, Path] | Iterable[Path], root: Path | None, *, folders: bool = False
) -> list[Frame]:
    """Names the frames of a job: by their keys, or by their paths below `root`, without the extension (which folders have not).

    Without a root it is the deepest folder that holds all photographs, so that a.png and b.png of one folder are frames a
    and b, and equal names in different folders stay apart.

    Raises
    ------
    slcal.Error
        When there are none, when two would have the same name, or when one is not below the root.
    """
    if isinstance(photos, Mapping):
        frames = [Frame(checked_name(name), location(path)) for name, path in photos.items()]
    else:
        paths = [location(path) for path in photos]
        above = _parts(location(root)) if root is not None else _common([_parts(p)[:-1] for p in paths])
        frames = [Frame(_below(_parts(path), above, path, folders), path) for path in paths]
    if not frames:
        raise Error("photos: expected at least one photograph, found none; give paths, URIs or a dataset", what="photos")
    seen: dict[str, str] = {}
    for name, path in frames:
        # Stores that do not tell capitals apart would write one over the other.
        other = seen.setdefault(name.casefold(), path)
        if other is not path:
            raise Error(
                f"photos: expected frames with names of their own, but {other} and {path} would both become {name}.ply; "
                "leave one of them out, or give a mapping from names to paths",
                what="photos",
            )
    return frames


def name_of_row(path: str, root: str | None, *, folders: bool = False) -> str:
    """The name of a frame of a dataset, whose other frames are not known: its path below the root, or made unique by a digest."""
    parts = _parts(path)
    if root is not None:
        return _below(parts, _parts(root), path, folders)
    digest = hashlib.blake2s(path.encode(), digest_size=4).hexdigest()
    return checked_name(f"{_last(parts[-1], folders)}-{digest}")


def checked_name(name: str) -> str:
    """The name itself, when it is one of a file below a folder.

    Raises
    ------
    slcal.Error
        When it is empty, absolute, hidden, or leads out of the folder.
    """
    parts = name.split("/")
    if all(part and not part.startswith(".") and "\\" not in part and "\0" not in part for part in parts):
        return name
    raise Error(
        f"frame name: expected one such as a, or a/b for a folder a, without hidden parts, found {name!r}; rename it, or "
        "give a mapping from names to paths",
        what="frame name",
        found=name,
    )


def _parts(path: str) -> tuple[str, ...]:
    """The parts of a path or URI, its store first."""
    path = path.split("::")[0]
    if path.startswith(("http://", "https://")):
        url = urlsplit(path)
        path = f"{url.scheme}://{url.netloc}{url.path}"
    path = path.replace(os.sep, "/")
    return tuple(part for part in re.sub(r"^file://", "", path).split("/") if part) or ("",)


def _common(folders: list[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(os.path.commonprefix(folders)) if folders else ()


def _last(part: str, folders: bool) -> str:
    """The last part of a frame's name."""
    return part if folders else PurePosixPath(part).stem


def _below(parts: tuple[str, ...], above: tuple[str, ...], path: str, folders: bool) -> str:
    inner = parts[len(above) :]
    if parts[: len(above)] != above or not inner:
        raise Error(
            f"{path}: expected a photograph below the root, found one elsewhere; give a folder that holds all of them",
            what="root",
        )
    # The store's own part, as in s3:, would not do as a folder's name everywhere.
    names = [part.rstrip(":") for part in inner]
    names[-1] = _last(names[-1], folders)
    return checked_name("/".join(names))
