"""A whole job, from the machine that starts it."""

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
from .._slcal import Rig, StripePattern
from ._frames import Frame, Path, StorageOptions, find_photos, location, name_frames
from ._job import Job, claim
from ._ledger import new_ledger
from ._store import Store
from ._table import RESULTS, SCHEMA, parquet
from ._work import Task, work

#: A list of paths is cut into pieces, one task of Ray each, since a task costs about as much as a small frame (0.1 s): so many
#: for each core that all cores end at about the same time, and ...
_PIECES_PER_CORE = 16
#: ... none so large that machines which join a growing cluster would find no work, or much is begun again after a death.
_MAX_PIECE = 16


def reconstruct(
    photos: Path | Iterable[Path] | Mapping[str, Path] | ray.data.Dataset,
    rig: Rig | Path,
    pattern: StripePattern | Path,
    output: Path,
    *,
    black: NDArray[Any] | None = None,
    white: NDArray[Any] | None = None,
    gamma: Literal["srgb", "linear"] | float = "srgb",
    frame: Literal["camera", "plane"] = "camera",
    mesh: bool = False,
    cull: Literal["auto", "off"] | float = "auto",
    min_confidence: float = 0.4,
    root: Path | None = None,
    overwrite: bool = False,
    workers: int | None = None,
    attempts: int = 3,
    storage_options: StorageOptions | None = None,
) -> pa.Table:
    """Reconstructs many photographs on a Ray cluster: a PLY per frame, and one table of results.

    A frame that cannot be reconstructed becomes a row with its error. Run again, with the same arguments, it leaves finished
    frames as they are and does the others: those that failed, those whose photograph has changed, those that an
    interrupted run did not come to. One job at a time may use an output folder.

    Without a cluster at hand (``ray start --head``, then ``ray.init()`` or ``RAY_ADDRESS``), the cores of this machine are
    used. Machines of a cluster must see the same stores: local paths only work on what all of them mount.

    Parameters
    ----------
    photos : path, list of paths, mapping or ray.data.Dataset
        A folder, a glob pattern or a photograph (see :func:`find_photos`); or paths and URIs; or those by the names
        that the frames shall have; or a dataset with a column ``path`` and, where it holds the photographs themselves, a
        column ``image`` of (H, W, 3) or (H, W) uint8 or uint16 arrays in RGB order, or ``bytes`` of files. Its column
        ``frame``, where it has one, names the frames.
    rig : Rig or path
        The calibrated rig.
    pattern : StripePattern or path
        The stripes that were projected.
    output : path or URI
        The folder for ``NAME.ply`` of each frame, ``results.parquet``, and a hidden folder ``.slcal`` that tells which frames
        are finished; made when it does not exist.
    black, white : (H, W, 3) or (H, W) array, optional
        The view with the projector dark, and under its full white; the same for all frames.
    gamma, frame, mesh, cull, min_confidence
        As for :class:`slcal.Reconstructor`.
    root : path, optional
        Frames are called after their photographs' paths below this folder, less the ending. Without one it is the deepest
        folder that holds all of a list; frames of a dataset, of which the others are not known, are then called after
        the file and a digest of its path, as in ``a-1f0c2b9d``.
    overwrite : bool
        Replace clouds of another rig, pattern, set of options or version of slcal in the output folder, and files of the
        same names from elsewhere.
    workers : int, optional
        How many frames are worked on at a time, at most. One per core of the cluster when not given.
    attempts : int
        A frame is given up, as a row with an error, when the process that works on it died this often.
    storage_options : mapping, optional
        Options of the file systems of fsspec by protocol, e.g. ``{"s3": {"endpoint_url": ...}}``.

    Returns
    -------
    pyarrow.Table
        The table that ``results.parquet`` holds, of :data:`SCHEMA`, by frame: frame, source, output (in the output folder),
        skipped (left as an earlier run made it), points, triangles, crossings, decoded, slits, median_sigma_mm,
        median_noise_mm, seconds, attempts, worker (host:pid), error_type and error (None where all went well).

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
    job = Job(
        rig if isinstance(rig, Rig) else Rig.load(rig),
        pattern if isinstance(pattern, StripePattern) else StripePattern.load(pattern),
        {"gamma": gamma, "frame": frame, "mesh": mesh, "cull": cull, "min_confidence": min_confidence},
        {name: image for name, image in (("black", black), ("white", white)) if image is not None},
    )
    job.reconstructor()  # Refuses what no worker could use.
    _check_counts(workers, attempts)
    options = storage_options or {}
    frames = _frames(photos, root, options) if not isinstance(photos, ray.data.Dataset) else _checked(photos)
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
    )
    table = _run(dataset, task, workers)
    store.put(RESULTS, parquet(table))
    store.tidy()
    return table


def _check_counts(workers: int | None, attempts: int) -> None:
    for name, count in (("workers", workers), ("attempts", attempts)):
        if count is not None and count < 1:
            raise Error(f"{name}: expected at least 1, found {count}", what=name, found=str(count))


def _frames(photos: Path | Iterable[Path] | Mapping[str, Path], root: Path | None, options: StorageOptions) -> list[Frame]:
    if isinstance(photos, (str, os.PathLike)):
        photos = find_photos(photos, storage_options=options)
    return name_frames(photos, root)


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
