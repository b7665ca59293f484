"""Reproducible samples of large clouds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def spread(count: int, most: int) -> NDArray[np.intp]:
    """Ascending indices of at most `most` of `count` items: all, or a reproducible random choice.

    An even step through points that are ordered by rows would draw a pattern of its own.
    """
    if count <= most:
        return np.arange(count)
    # RandomState's stream is frozen: the same choice with every version of NumPy.
    return np.sort(np.random.RandomState(0).permutation(count)[:most])
