"""What all frames of a job have in common, and a fingerprint that identifies it."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._slcal import Reconstructor, Rig, SequencePattern, StripePattern, __version__
from ._store import Store
from ._table import RESULTS

#: Where the bookkeeping of a job is kept, below the output folder.
HIDDEN = ".slcal"

_MANIFEST = f"{HIDDEN}/job.json"


@dataclass(frozen=True)
class Job:
    """Rig, pattern and options; sent to each worker once."""

    rig: Rig
    pattern: StripePattern | SequencePattern
    options: Mapping[str, Any]
    #: The dark and the white frame, by the names of the arguments that take them.
    frames: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    @functools.cached_property
    def parts(self) -> dict[str, str]:
        """Everything except the photograph that determines a cloud, each as text or as a digest."""
        return {
            "version of slcal": __version__,
            "rig": digest(self.rig.to_json().encode()),
            "pattern": digest(self.pattern.to_json().encode()),
            **{name: _as_text(value) for name, value in self.options.items()},
            **{name: digest_of_image(image) for name, image in self.frames.items()},
        }

    @functools.cached_property
    def fingerprint(self) -> str:
        """Equal for jobs that make the same clouds from the same photographs."""
        return digest(json.dumps(self.parts, sort_keys=True).encode())

    def reconstructor(self) -> Reconstructor:
        """A new reconstructor.

        Raises
        ------
        slcal.Error
            When the rig has no projector, the pattern is for another one, or an option is out of range.
        """
        make: Callable[..., Reconstructor] = Reconstructor
        return make(self.rig, self.pattern, **self.options)


def digest(data: bytes | memoryview) -> str:
    """A digest of 128 bits."""
    return hashlib.blake2b(data, digest_size=16).hexdigest()


def digest_of_image(image: NDArray[Any]) -> str:
    """A digest of an image's samples, shape and type."""
    samples = digest(np.ascontiguousarray(image).data.cast("B"))
    return digest(f"{image.dtype.str} {image.shape} {samples}".encode())


def _as_text(value: Any) -> str:
    """An option as text, the same for equal ones."""
    return repr(value if isinstance(value, (bool, str)) else float(value))


def claim(store: Store, job: Job, overwrite: bool) -> None:
    """Takes the output folder for a job: refuses one that holds the clouds of another job.

    Raises
    ------
    FileExistsError
        When it does, and they may not be overwritten.
    OSError
        When it cannot be written.
    """
    written = store.read(_MANIFEST)
    if written is not None:
        before: dict[str, str] = json.loads(written)["made with"]
        changed = [name for name in {**before, **job.parts} if before.get(name) != job.parts.get(name)]
        if changed and not overwrite:
            raise FileExistsError(
                f"{store.url}: expected a folder without clouds, or with those of the same job, found clouds made with "
                f"another {', '.join(changed)}; give another folder, or overwrite=True to make them again"
            )
        if changed:
            # Its clouds are about to be replaced.
            store.remove(RESULTS)
    elif store.size(RESULTS) is not None and not overwrite:
        raise FileExistsError(
            f"{store.url}: expected a folder without a {RESULTS} of something else; give another folder, or overwrite=True"
        )
    store.put(_MANIFEST, json.dumps({"schema": "slcal-ray/1", "made with": job.parts}, indent=1).encode())
