"""A whole job, as seen from the machine that starts it."""

from __future__ import annotations

import functools
import os
import secrets
from collections.abc import Iterable, Mapping
from typing import Any, Literal

import pyarrow as pa
import ray
import ray.data
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import CheckerPattern, Rig, SequencePattern, StripePattern, load_pattern
from ._frames import Frame, Path, StorageOptions, find_photos, find_scans, location, name_frames
from ._job import Job, claim
from ._ledger import new_ledger
from ._store import Store
from ._table import RESULTS, SCHEMA, parquet
from ._work import Task, work

#: A list of paths is split into chunks, one Ray task each, since a task costs about as much as a small frame (0.1 s). There are
#: enough chunks per core that all cores finish at about the same time, and ...
_PIECES_PER_CORE = 16
#: ... each is small enough that machines which join later find work, and that little is repeated after a process dies.
_MAX_PIECE = 16


def reconstruct(
    photos: Path | Iterable[Path] | Mapping[str, Path] | ray.data.Dataset,
    rig: Rig | Path,
    pattern: StripePattern | SequencePattern | Path,
    output: Path,
    *,
    black: NDArray[Any] | None = None,
    white: NDArray[Any] | None = None,
    gamma: Literal["srgb", "linear"] | float = "srgb",
    frame: Literal["camera", "plane"] = "camera",
    mesh: bool = False,
    cull: Literal["auto", "off"] | float = "auto",
    min_confidence: float = 0.4,
    near: float | None = None,
    far: float | None = None,
    root: Path | None = None,
    overwrite: bool = False,
    workers: int | None = None,
    attempts: int = 3,
    storage_options: StorageOptions | None = None,
) -> pa.Table:
    """Reconstructs many photographs on a Ray cluster: a PLY per frame, and one table of results.

    A frame that cannot be reconstructed becomes a row with its error. A second run with the same arguments keeps finished
    frames and does only the others: those that failed, those whose photograph has changed, those that an interrupted run
    did not reach. Only one job at a time may use an output folder.

    Without a cluster (``ray start --head``, then ``ray.init()`` or ``RAY_ADDRESS``), the cores of this machine are used. All
    machines of a cluster must see the same stores: use local paths only on a shared mount.

    Parameters
    ----------
    photos : path, list of paths, mapping or ray.data.Dataset
        A folder, a glob pattern or a photograph (see :func:`find_photos`); or paths and URIs; or a mapping from frame names
        to them; or a dataset with a column ``path`` and, optionally, the photographs themselves: a
        column ``image`` of (H, W, 3) or (H, W) uint8 or uint16 arrays in RGB order, or ``bytes`` of files. A column
        ``frame`` names the frames. With a sequence each frame is a scan: a folder of photographs, in the order of the pattern
        (by the names of files that it has, else by their own). `photos` are then a folder, a glob pattern that matches
        folders, a list of folders, a mapping from names to them, or a dataset with a column ``path`` of them.
    rig : Rig or path
        The calibrated rig.
    pattern : StripePattern, SequencePattern or path
        What was projected.
    output : path or URI
        The folder for ``NAME.ply`` of each frame, ``results.parquet``, and a hidden folder ``.slcal`` that records which
        frames are finished. It is created if it does not exist.
    black, white : (H, W, 3) or (H, W) array, optional
        The view with the projector dark, and under its full white; the same for all frames.
    gamma, frame, mesh, cull, min_confidence, near, far
        As for :class:`slcal.Reconstructor`. With a sequence, `gamma` and `min_confidence` are not allowed, nor are `black` and
        `white`.
    root : path, optional
        Frames are named after the paths of their photographs below this folder, without the extension. By default it is the
        deepest common folder of a list. Frames of a dataset are then named after the file and a digest of its path, as in
        ``a-1f0c2b9d``, since the other frames are not known in advance.
    overwrite : bool
        Replace clouds of another rig, pattern, set of options or version of slcal in the output folder, and files of the
        same names from elsewhere.
    workers : int, optional
        Maximum number of frames at a time; by default one per core of the cluster.
    attempts : int
        Number of times that a process may die with a frame before the frame becomes a row with an error.
    storage_options : mapping, optional
        Options of the file systems of fsspec by protocol, e.g. ``{"s3": {"endpoint_url": ...}}``.

    Returns
    -------
    pyarrow.Table
        The table that ``results.parquet`` holds, of :data:`SCHEMA`, by frame: frame, source, output (in the output folder),
        skipped (from an earlier run), points, triangles, crossings, decoded, slits, median_sigma_mm,
        median_noise_mm, seconds, attempts, worker (host:pid), error_type and error (None on success).

    Raises
    ------
    slcal.Error
        Before any work: no photographs, two with one name, a rig without a projector, a pattern for another one, an option
        out of range.
    FileExistsError
        When the output folder holds clouds of another rig, pattern or set of options.
    OSError
        When rig or pattern cannot be read, or the output folder cannot be written.

    Examples
    --------
    >>> import slcal.ray  # doctest: +SKIP
    >>> table = slcal.ray.reconstruct("photos/*.png", "rig.json", "stripes.json", "clouds")  # doctest: +SKIP
    >>> table.filter(pc.is_valid(table["error"])).to_pandas()[["frame", "error"]]  # doctest: +SKIP
    """
    drawn = _pattern(pattern)
    scans = isinstance(drawn, SequencePattern)
    of_stripes = {"gamma": gamma, "min_confidence": min_confidence}
    images = {name: image for name, image in (("black", black), ("white", white)) if image is not None}
    if scans:
        _check_of_stripes(of_stripes, images)
    job = Job(
        rig if isinstance(rig, Rig) else Rig.load(rig),
        drawn,
        {
            **{"frame": frame, "mesh": mesh, "cull": cull},
            **({} if scans else of_stripes),
            **{name: limit for name, limit in (("near", near), ("far", far)) if limit is not None},
        },
        images,
    )
    job.reconstructor()  # Refuses arguments that no worker could use.
    _check_counts(workers, attempts)
    options = storage_options or {}
    frames = _checked(photos) if isinstance(photos, ray.data.Dataset) else _frames(photos, root, options, scans)
    store = Store(location(output), options)
    claim(store, job, overwrite)
    store.tidy()
    if not ray.is_initialized():
        ray.init()
    dataset = frames if isinstance(frames, ray.data.Dataset) else _dataset(frames)
    task = Task(
        job=ray.put(job),
        fingerprint=job.fingerprint,
        store=store,
        run=secrets.token_hex(8),
        ledger=new_ledger(),
        root=os.fspath(root) if root is not None else None,
        overwrite=overwrite,
        attempts=attempts,
        options=options,
        scans=scans,
    )
    table = _run(dataset, task, workers)
    store.put(RESULTS, parquet(table))
    store.tidy()
    return table


def _check_counts(workers: int | None, attempts: int) -> None:
    for name, count in (("workers", workers), ("attempts", attempts)):
        if count is not None and count < 1:
            raise Error(f"{name}: expected at least 1, found {count}", what=name, found=str(count))


def _pattern(pattern: StripePattern | SequencePattern | Path) -> StripePattern | SequencePattern:
    if isinstance(pattern, (str, os.PathLike)):
        loaded = load_pattern(pattern)
        # Says what it is instead.
        return StripePattern.load(pattern) if isinstance(loaded, CheckerPattern) else loaded
    return pattern


def _check_of_stripes(options: Mapping[str, Any], images: Mapping[str, Any]) -> None:
    """Refuses options of stripes beside a sequence."""
    usual = {"gamma": "srgb", "min_confidence": 0.4}
    for name in [*(name for name, value in options.items() if value != usual[name]), *images]:
        raise Error(f"{name}: expected none with a SequencePattern: its frames are all that is needed, found one", what=name)


def _frames(
    photos: Path | Iterable[Path] | Mapping[str, Path], root: Path | None, options: StorageOptions, scans: bool
) -> list[Frame]:
    if isinstance(photos, (str, os.PathLike)):
        find = find_scans if scans else find_photos
        photos = find(photos, storage_options=options)
    return name_frames(photos, root, folders=scans)


def _checked(dataset: ray.data.Dataset) -> ray.data.Dataset:
    """Refuses a dataset without paths; may read its first row."""
    columns = dataset.columns()
    if columns is not None and "path" not in columns:
        raise Error(
            f"photos: expected a dataset with a column 'path', found columns {', '.join(columns)}; read photographs with "
            "include_paths=True",
            what="photos",
            found=", ".join(columns),
        )
    return dataset


def _dataset(frames: list[Frame]) -> ray.data.Dataset:
    rows = [{"frame": frame.name, "path": frame.path} for frame in frames]
    resources: Any = ray.cluster_resources  # Without types.
    cores = max(1, int(resources().get("CPU", 1)))
    pieces = max(_PIECES_PER_CORE * cores, -(-len(rows) // _MAX_PIECE))
    return ray.data.from_items(rows, override_num_blocks=min(len(rows), pieces))


def _run(dataset: ray.data.Dataset, task: Task, workers: int | None) -> pa.Table:
    """The rows of all frames.

    Tasks rather than actors: Ray begins them again when their process or their machine dies, without end, and they need no
    place of their own beside those that read the dataset. A worker process serves many tasks and keeps its
    reconstructor.
    """
    rows = dataset.map_batches(
        functools.partial(work, task=task),
        batch_size=1,
        batch_format="numpy",
        compute=ray.data.TaskPoolStrategy(size=workers),
        num_cpus=1,
    )
    batches: Iterable[Any] = rows.iter_batches(batch_size=None, batch_format="pyarrow")
    tables = [SCHEMA.empty_table(), *(batch.select(SCHEMA.names).cast(SCHEMA) for batch in batches)]
    return pa.concat_tables(tables).sort_by([("frame", "ascending"), ("source", "ascending")])
