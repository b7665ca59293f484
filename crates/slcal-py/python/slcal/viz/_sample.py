"""The same few points of a big cloud every time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def spread(count: int, most: int) -> NDArray[np.intp]:
    """Indices of at most `most` of `count` things, ascending: all, or a random choice, always the same.

    An even step through points that are ordered by rows would draw a pattern of its own.
    """
    if count <= most:
        return np.arange(count)
    # RandomState's stream is frozen: the same choice with every version of NumPy.
    return np.sort(np.random.RandomState(0).permutation(count)[:most])
