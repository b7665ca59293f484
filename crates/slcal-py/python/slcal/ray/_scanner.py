"""What reconstructs scans by sequences with one rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from .._errors import Error
from .._slcal import PointCloud, Rig, SequencePattern


class SequenceScanner:
    """Reconstructs one scan after another, as :class:`slcal.Reconstructor` does photographs of stripes."""

    def __init__(self, rig: Rig, pattern: SequencePattern, options: Mapping[str, Any]) -> None:
        self._rig, self._pattern, self._options = rig, pattern, options
        try:
            # Rig, pattern and options are looked at before the frames, of which there are none yet.
            self.reconstruct(())
        except Error as error:
            if error.what != "frames":
                raise

    def reconstruct(self, frames: Sequence[NDArray[Any]]) -> PointCloud:
        """The cloud of a scan."""
        return self._rig.reconstruct(frames, self._pattern, **self._options)
