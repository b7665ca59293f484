from collections.abc import Sequence
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

__all__ = ["CheckerPattern", "StripePattern", "__version__", "run_command"]
__version__: Final[str]

@final
class CheckerPattern:
    """The checkerboard that calibration needs, centred on the projector's panel: 11 columns and 8 rows unless told otherwise.

    Raises ValueError when columns + rows is even (the board would look the same after half a turn) or when the board
    does not fit on the panel.
    """

    def __new__(
        cls,
        projector: tuple[int, int],
        squares: tuple[int, int] = ...,
        square_px: int | None = None,
    ) -> CheckerPattern: ...
    @property
    def projector(self) -> tuple[int, int]:
        """Width and height of the panel, px."""
    @property
    def squares(self) -> tuple[int, int]:
        """Columns and rows of squares."""
    @property
    def square_px(self) -> float:
        """Side of a square, px."""
    @property
    def origin_px(self) -> tuple[float, float]:
        """Outer top-left corner of the top-left square, px, pixel centres at integers."""
    def image(self) -> NDArray[np.uint8]:
        """The picture to project: (height, width, 3), sRGB."""
    def to_json(self) -> str:
        """The pattern file (schema slcal-pattern/1)."""

@final
class StripePattern:
    """Coloured vertical slits in a De Bruijn sequence.

    Raises ValueError when the colours and the order do not allow that many slits, or when they do not fit on the panel.
    """

    def __new__(
        cls,
        projector: tuple[int, int],
        hues: int = 4,
        order: int = 3,
        slits: int | None = None,
    ) -> StripePattern: ...
    @property
    def projector(self) -> tuple[int, int]:
        """Width and height of the panel, px."""
    @property
    def palette(self) -> NDArray[np.uint8]:
        """The colours: (hues, 3), sRGB."""
    @property
    def sequence(self) -> NDArray[np.uint8]:
        """The colour of each slit: indices into the palette."""
    @property
    def centres_px(self) -> NDArray[np.float64]:
        """Projector column of each slit's centre, px."""
    @property
    def width_px(self) -> float:
        """Width of a slit, px."""
    def image(self) -> NDArray[np.uint8]:
        """The picture to project: (height, width, 3), sRGB."""
    def to_json(self) -> str:
        """The pattern file (schema slcal-pattern/1)."""

def run_command(args: Sequence[str], /) -> int:
    """Run a command line, the program's name first, and return its exit code."""
