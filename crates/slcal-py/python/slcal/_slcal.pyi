from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import IO, Any, Final, Literal, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .reports import (
    Advice,
    CalibrationReport,
    CloudReport,
    DecodeReport,
    DeviceSigma,
    NoiseReport,
    PlaneFit,
    Quality,
    SceneReport,
    SphereFit,
    Verification,
    ViewRms,
)

__all__ = [
    "Camera",
    "CheckerPattern",
    "CornerDetection",
    "Covariance",
    "Detection",
    "Matches",
    "Observations",
    "PointCloud",
    "Pose",
    "Reconstructor",
    "Rectification",
    "Rig",
    "Scene",
    "SheetDetection",
    "StripePattern",
    "View",
    "ViewObservation",
    "__version__",
    "advise",
    "calibrate",
    "calibrate_observations",
    "decode",
    "detect",
    "detect_corners",
    "detect_sheet",
    "evaluate",
    "load_pattern",
    "observe",
    "read_image",
    "run_command",
    "simulate_noise",
    "simulate_scene",
    "simulate_views",
]
__version__: Final[str]

#: There in the usual case, None in the cases that the docstring names: it may be used without a check, as in typeshed.
_MaybeNone: TypeAlias = Any
_Image: TypeAlias = NDArray[np.uint8] | NDArray[np.uint16]
#: uint8 or uint16. Wider than that, since OpenCV's functions are typed to return any number.
_ImageLike: TypeAlias = NDArray[np.integer[Any] | np.floating[Any]]
_Size: TypeAlias = tuple[float, float] | str
_Indices: TypeAlias = slice | NDArray[np.bool_] | NDArray[np.integer[Any]] | Sequence[int]
_Path: TypeAlias = str | PathLike[str]
_ExchangeFormat: TypeAlias = Literal["opencv", "ros", "colmap", "kalibr", "blender", "npz"]
_File: TypeAlias = _Path | IO[bytes] | IO[str]
_Gamma: TypeAlias = Literal["srgb", "linear"] | float
_PrincipalPoint: TypeAlias = Literal["prior", "shift", "centre", "free"] | tuple[float, float]
_Distortion: TypeAlias = Literal["auto", "none", "k1", "k1k2", "full"]
_Cull: TypeAlias = Literal["auto", "off"] | float
_Frame: TypeAlias = Literal["camera", "plane"]

# What is projected

@final
class CheckerPattern:
    """The checkerboard that calibration needs, centred on the projector's panel.

    Parameters
    ----------
    projector : (int, int)
        Width and height of the projector's panel, px: its native resolution.
    squares : (int, int), default (11, 8)
        Columns and rows of squares; their sum is odd, so that the board differs from itself after half a turn.
    square_px : int, optional
        Side of a square, px; a sixteenth of the panel's height unless given.
    first_square : {"black", "white"}, default "black"
        The colour of the top-left square.
    background : {"black", "white"}, default "white"
        The colour around the board.

    Raises
    ------
    Error
        When the sum is even or the board does not fit on the panel.

    Examples
    --------
    >>> checker = slcal.CheckerPattern(projector=(1024, 768))
    >>> checker
    CheckerPattern(projector=(1024, 768), squares=(11, 8), square_px=48)
    >>> checker.image().shape
    (768, 1024, 3)
    """

    def __new__(
        cls,
        projector: tuple[int, int],
        squares: tuple[int, int] = (11, 8),
        square_px: int | None = None,
        *,
        first_square: Literal["black", "white"] = "black",
        background: Literal["black", "white"] = "white",
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
    @property
    def first_square(self) -> Literal["black", "white"]:
        """The colour of the top-left square."""
    @property
    def background(self) -> Literal["black", "white"]:
        """The colour around the board."""
    def corners(self) -> NDArray[np.float64]:
        """The corners between four squares, row by row.

        Returns
        -------
        ndarray
            (N, 2) float64, projector px.
        """
    def image(self) -> NDArray[np.uint8]:
        """The picture to project, to be shown full screen without scaling.

        Returns
        -------
        ndarray
            (H, W, 3) uint8, sRGB.
        """
    def save(self, file: _File) -> None:
        """Writes the pattern file (schema slcal-pattern/1).

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _File) -> CheckerPattern:
        """Reads a pattern file; see `slcal.load_pattern` for files of either kind."""
    def to_json(self) -> str:
        """The content of the pattern file."""
    @staticmethod
    def from_json(text: str) -> CheckerPattern:
        """The pattern that `to_json` wrote."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class StripePattern:
    """Coloured slits in a De Bruijn sequence: any `order` of them in a row occur once.

    Parameters
    ----------
    projector : (int, int)
        Width and height of the projector's panel, px: its native resolution.
    hues : int, default 4
        Colours.
    order : int, default 3
        Length of the windows that are unique.
    slits : int, optional
        Slits; hues to the power of order unless given.
    axis : {"columns", "rows"}, default "columns"
        Whether slits are counted along the panel's columns (they stand upright) or rows.

    Raises
    ------
    Error
        When the colours and the order do not allow that many slits, or when they do not fit on the panel.

    Examples
    --------
    >>> stripes = slcal.StripePattern(projector=(1024, 768))
    >>> stripes
    StripePattern(projector=(1024, 768), hues=4, order=3, slits=64)
    >>> stripes.palette.shape, stripes.centres_px.shape
    ((4, 3), (64,))
    """

    def __new__(
        cls,
        projector: tuple[int, int],
        hues: int = 4,
        order: int = 3,
        slits: int | None = None,
        *,
        axis: Literal["columns", "rows"] = "columns",
    ) -> StripePattern: ...
    @staticmethod
    def from_slits(
        projector: tuple[int, int],
        palette: ArrayLike,
        sequence: ArrayLike,
        centres_px: ArrayLike,
        width_px: float,
        *,
        axis: Literal["columns", "rows"] = "columns",
        order: int = 3,
    ) -> StripePattern:
        """Any slits, as other programs draw them.

        Parameters
        ----------
        projector : (int, int)
            Width and height of the panel, px.
        palette : array_like
            (hues, 3), sRGB from 0 to 255.
        sequence : array_like
            (slits,), the colour of each slit: indices into the palette.
        centres_px : array_like
            (slits,), ascending: projector column (or row) of each slit's centre, px.
        width_px : float
            Width of a slit, px.
        axis : {"columns", "rows"}, default "columns"
            Whether `centres_px` are columns or rows.
        order : int, default 3
            Length of the windows of the sequence that are unique.

        Raises
        ------
        Error
            When the slits overlap, leave the panel, or no window of them is unique.
        """
    @property
    def projector(self) -> tuple[int, int]:
        """Width and height of the panel, px."""
    @property
    def axis(self) -> Literal["columns", "rows"]:
        """Whether slits are counted along the panel's columns (they stand upright) or rows."""
    @property
    def palette(self) -> NDArray[np.uint8]:
        """The colours: (hues, 3) uint8, sRGB."""
    @property
    def sequence(self) -> NDArray[np.uint8]:
        """The colour of each slit: (slits,) uint8, indices into the palette."""
    @property
    def centres_px(self) -> NDArray[np.float64]:
        """Projector column (or row) of each slit's centre: (slits,) float64, px."""
    @property
    def width_px(self) -> float:
        """Width of a slit, px."""
    @property
    def order(self) -> int:
        """Length of the windows of the sequence that are unique."""
    def image(self) -> NDArray[np.uint8]:
        """The picture to project, to be shown full screen without scaling.

        Returns
        -------
        ndarray
            (H, W, 3) uint8, sRGB.
        """
    def save(self, file: _File) -> None:
        """Writes the pattern file (schema slcal-pattern/1).

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _File) -> StripePattern:
        """Reads a pattern file; see `slcal.load_pattern` for files of either kind."""
    def to_json(self) -> str:
        """The content of the pattern file."""
    @staticmethod
    def from_json(text: str) -> StripePattern:
        """The pattern that `to_json` wrote."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

def load_pattern(file: _File) -> CheckerPattern | StripePattern:
    """Reads a pattern file of either kind.

    Parameters
    ----------
    file : path or file object
        The JSON file (schema slcal-pattern/1) that `save` or ``slcal pattern`` wrote.

    Returns
    -------
    CheckerPattern or StripePattern

    Raises
    ------
    OSError
        When the file cannot be read.
    FormatError
        When it does not follow its schema; the message names the field.
    """
def read_image(file: _Path | IO[bytes]) -> _Image:
    """Reads a photograph: PNG, JPEG or TIFF, 8 or 16 bit, turned upright as its EXIF orientation asks.

    Parameters
    ----------
    file : path or binary file object
        The photograph.

    Returns
    -------
    ndarray
        (H, W, 3) in RGB order, or (H, W) for a grey one; uint8 or uint16. An alpha channel is left out.

    Raises
    ------
    OSError
        When the file cannot be read.
    FormatError
        When it is no such picture, or not a whole one; the message says how to convert it.
    """

# What a photograph of the sheet shows

@final
class SheetDetection:
    """The sheet as found in a photograph: points on its sides, and the corners in which these meet."""

    @property
    def corners(self) -> NDArray[np.float64] | _MaybeNone:
        """Corners TL, TR, BR, BL: (4, 2) float64, px; lines through the sides meet there, in a distorted photograph to within the
        sides' bend. None where neighbouring sides are parallel.
        """
    @property
    def edges(self) -> dict[str, NDArray[np.float64]]:
        """Points on "top", "right", "bottom" and "left": (N, 2) float64, px; empty where corners given by hand are used as they
        are.
        """
    @property
    def edge_sigma_px(self) -> dict[str, NDArray[np.float64]]:
        """1σ of these points across their sides, (N,) float64, px, such that they may be treated as independent."""
    @property
    def corner_sigma_px(self) -> float | None:
        """1σ of corners given by hand that are used as they are, px; None where the sides were measured."""
    @property
    def notes(self) -> list[str]:
        """Things worth telling: corners taken from the user."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class CornerDetection:
    """The corners of the pattern that were seen."""

    @property
    def camera_px(self) -> NDArray[np.float64]:
        """Where the camera sees them: (N, 2) float64, px, row by row of the pattern."""
    @property
    def projector_px(self) -> NDArray[np.float64]:
        """Where the projector shows them: (N, 2) float64, px, exact."""
    @property
    def sigma_px(self) -> NDArray[np.float64]:
        """1σ of each camera coordinate: (N,) float64, px."""
    @property
    def expected(self) -> int:
        """Corners of the whole pattern."""
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Detection:
    """Sheet and corners of one photograph."""

    @property
    def sheet(self) -> SheetDetection:
        """The sheet."""
    @property
    def corners(self) -> CornerDetection:
        """The corners of the pattern that were seen on the sheet; none without a pattern."""
    @property
    def view(self) -> ViewObservation:
        """Both as calibration takes them."""
    @property
    def notes(self) -> list[str]:
        """Things worth telling: corners that were not seen or lie beside the sheet, corners taken from the user."""
    def __eq__(self, other: object, /) -> bool: ...

def detect(
    photo: _ImageLike,
    size_mm: _Size,
    pattern: CheckerPattern | None = None,
    *,
    plain: _ImageLike | None = None,
    corners: ArrayLike | None = None,
    gamma: _Gamma = "srgb",
    screen: _ImageLike | None = None,
) -> Detection:
    """Finds the sheet, and the pattern when there is one, in a photograph.

    Parameters
    ----------
    photo : ndarray
        (H, W, 3) RGB or (H, W), uint8 or uint16: the sheet with the pattern projected on it.
    size_mm : (float, float)
        Width and height of the sheet, mm; the width belongs to the sides that run most nearly along the image's x axis.
    pattern : CheckerPattern, optional
        What is projected; without it the sheet is the brightest large quadrilateral with straight sides.
    screen : ndarray, optional
        The same pose with a dark or plain projector, in the same size; the sheet's sides are then measured there.
    corners : array_like, optional
        (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when it is not found. They may lie outside the frame; the sides
        are still measured in the photograph where they are seen.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photograph.

    Returns
    -------
    Detection
        `sheet`, `corners`, and both as the `view` that calibration takes.

    Raises
    ------
    DetectionError
        When sheet or pattern is not found; `seen` says what was seen instead and `advice` what to do.
    Error
        For photographs of different sizes and corners that are no convex quadrilateral in this order.
    TypeError
        When a photograph is no such array.

    See Also
    --------
    observe : the same for photographs of several poses.

    Examples
    --------
    A drawing of a sheet before a dark wall:

    >>> photo = np.full((480, 640), 30, np.uint8)
    >>> photo[100:380, 120:520] = 220
    >>> found = slcal.detect(photo, size_mm=(400, 280))
    >>> found
    Detection(sheet found, no pattern)
    >>> found.sheet.corners.round(1)
    array([[119.5,  99.5],
           [519.5,  99.5],
           [519.5, 379.5],
           [119.5, 379.5]])
    """
def detect_sheet(photo: _ImageLike, *, corners: ArrayLike | None = None, gamma: _Gamma = "srgb") -> SheetDetection:
    """Finds the sheet alone, of whatever size: the brightest large quadrilateral with straight sides.

    Parameters
    ----------
    photo : ndarray
        (H, W, 3) RGB or (H, W), uint8 or uint16: the sheet, with a dark or plain projector; `detect` knows the pattern's edges
        from the sheet's.
    corners : array_like, optional
        (4, 2), px: its corners TL, TR, BR, BL by hand, when it is not found. They may lie outside the frame; the sides are
        still measured in the photograph where they are seen.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photograph.

    Returns
    -------
    SheetDetection

    Raises
    ------
    DetectionError
        When no sheet is found; `seen` says what was seen instead and `advice` what to do.
    Error
        For corners that are no convex quadrilateral in this order.
    TypeError
        When the photograph is no such array.

    Examples
    --------
    >>> photo = np.full((480, 640), 30, np.uint8)
    >>> photo[100:380, 120:520] = 220
    >>> sheet = slcal.detect_sheet(photo)
    >>> float(sheet.edges["top"][:, 1].mean().round(1))
    99.5
    """
def detect_corners(photo: _ImageLike, pattern: CheckerPattern, *, gamma: _Gamma = "srgb") -> CornerDetection:
    """Finds the corners of the projected checkerboard alone, on the sheet or beside it.

    Parameters
    ----------
    photo : ndarray
        (H, W, 3) RGB or (H, W), uint8 or uint16.
    pattern : CheckerPattern
        What is projected.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photograph.

    Returns
    -------
    CornerDetection

    Raises
    ------
    DetectionError
        When the checkerboard is not found; `seen` says what was seen instead and `advice` what to do.
    TypeError
        When the photograph is no such array.

    Examples
    --------
    What the projector is to show, seen by a camera that is the projector:

    >>> checker = slcal.CheckerPattern(projector=(1024, 768))
    >>> corners = slcal.detect_corners(checker.image(), checker)
    >>> len(corners), corners.expected
    (70, 70)
    >>> bool(np.abs(corners.camera_px - corners.projector_px).max() < 0.01)
    True
    """

@final
class ViewObservation:
    """What was seen of one pose of the sheet, by any detector: its corners or points on its sides, and the projected points.

    Parameters
    ----------
    size_mm : (float, float)
        Width and height of the sheet, mm; the width belongs to the sides that run most nearly along the image's x axis.
    sheet_corners : array_like, optional
        (4, 2), px: the corners TL, TR, BR, BL as the camera sees them. They may lie outside the frame.
    sheet_edges : mapping, optional
        Points on the sides instead: (N, 2), px, for each of "top", "right", "bottom" and "left"; or (N, 3) with the 1σ of each
        point across its side, px.
    pairs : array_like, optional
        (N, 4), px: camera x, camera y, projector x, projector y of each point of the pattern; or (N, 5) with the 1σ of the
        camera's coordinates. None when nothing is projected.
    sheet_sigma_px : float or mapping, optional
        1σ of the corners or of the points on the sides, px; a mapping gives it side by side, (N,) or one for all. Unless
        it is given, calibration works it out from the residuals.
    pair_sigma_px : array_like, optional
        1σ of the camera's coordinates of the pairs, px: (N,) or one for all. Unless it is given, calibration works it out
        from the residuals.
    photo : str, optional
        Name of the photograph.

    Raises
    ------
    Error
        When neither or both of corners and edges are given, for other shapes, for numbers that are not finite, for a σ that
        is not positive.
    TypeError
        When something is no array of real numbers.

    Examples
    --------
    >>> corners = [[100, 90], [1100, 110], [1050, 800], [80, 780]]
    >>> view = slcal.ViewObservation((594, 420), sheet_corners=corners, sheet_sigma_px=0.1)
    >>> view
    ViewObservation(size_mm=(594, 420), sheet by its corners, 0 pairs)
    >>> view.sheet_corners.shape, view.pairs.shape
    ((4, 2), (0, 4))
    """

    def __new__(
        cls,
        size_mm: _Size,
        *,
        sheet_corners: ArrayLike | None = None,
        sheet_edges: Mapping[str, ArrayLike] | None = None,
        pairs: ArrayLike | None = None,
        sheet_sigma_px: float | Mapping[str, ArrayLike] | None = None,
        pair_sigma_px: ArrayLike | None = None,
        photo: str | None = None,
    ) -> ViewObservation: ...
    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the sheet, mm."""
    @property
    def sheet_corners(self) -> NDArray[np.float64] | None:
        """Its corners TL, TR, BR, BL: (4, 2) float64, px; None when points on its sides are known instead."""
    @property
    def sheet_edges(self) -> dict[str, NDArray[np.float64]] | None:
        """Points on its sides: (N, 2) float64, px, for "top", "right", "bottom", "left"; None when its corners are known instead."""
    @property
    def sheet_sigma_px(self) -> float | dict[str, NDArray[np.float64]] | None:
        """1σ of the corners, px, or of the points on each side, (N,) float64; None where it was not stated."""
    @property
    def pairs(self) -> NDArray[np.float64]:
        """Camera x, camera y, projector x, projector y of each point of the pattern: (N, 4) float64, px."""
    @property
    def pair_sigma_px(self) -> NDArray[np.float64] | None:
        """1σ of the camera's coordinates of the pairs: (N,) float64, px; None where it was not stated."""
    @property
    def photo(self) -> str | None:
        """Name of the photograph, where it has one."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Observations:
    """Everything that a calibration is computed from.

    Parameters
    ----------
    camera : (int, int)
        Width and height of the camera's image, px.
    projector : (int, int) or None
        Width and height of the projector's panel, px; None to calibrate the camera alone.
    views : iterable of ViewObservation or Detection
        One for each pose of the sheet.

    Raises
    ------
    Error
        When a size is not two whole numbers above zero.
    TypeError
        When a view is neither of these.

    Examples
    --------
    >>> corners = [[100, 90], [1100, 110], [1050, 800], [80, 780]]
    >>> view = slcal.ViewObservation((594, 420), sheet_corners=corners)
    >>> seen = slcal.Observations((1280, 960), None, [view])
    >>> seen
    Observations(camera=(1280, 960), projector=None, views=1, pairs=0)
    >>> slcal.Observations.from_json(seen.to_json()) == seen
    True
    """

    def __new__(
        cls,
        camera: tuple[int, int],
        projector: tuple[int, int] | None,
        views: Iterable[ViewObservation | Detection],
    ) -> Observations: ...
    @property
    def camera(self) -> tuple[int, int]:
        """Width and height of the camera's image, px."""
    @property
    def projector(self) -> tuple[int, int] | None:
        """Width and height of the projector's panel, px; None for the camera alone."""
    @property
    def views(self) -> list[ViewObservation]:
        """One for each pose of the sheet."""
    def save(self, file: _File) -> None:
        """Writes the file (schema slcal-observations/1), which ``slcal calibrate --observations`` reads.

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _File) -> Observations:
        """Reads a file of observations.

        Parameters
        ----------
        file : path or file object
            The JSON file (schema slcal-observations/1).

        Returns
        -------
        Observations

        Raises
        ------
        OSError
            When the file cannot be read.
        FormatError
            When it does not follow its schema; the message names the view, the field and the point.
        """
    def to_json(self) -> str:
        """The content of the file."""
    @staticmethod
    def from_json(text: str) -> Observations:
        """The observations that `to_json` wrote."""
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

def observe(
    photos: Sequence[_ImageLike] | _ImageLike,
    size_mm: _Size,
    pattern: CheckerPattern | None = None,
    *,
    plain: Sequence[_ImageLike] | None = None,
    corners: Sequence[ArrayLike | None] | ArrayLike | None = None,
    gamma: _Gamma = "srgb",
    names: Sequence[str] | None = None,
    screen: Sequence[_ImageLike] | None = None,
) -> Observations:
    """Finds sheet and pattern in photographs of several poses: what `calibrate` does first.

    Parameters
    ----------
    photos : sequence of ndarray, or ndarray
        (H, W, 3) RGB or (H, W), uint8 or uint16, all of one size: the sheet with the pattern projected on it, one for each
        pose.
    size_mm : (float, float)
        Width and height of the sheet, mm; the width belongs to the sides that run most nearly along the image's x axis.
    pattern : CheckerPattern, optional
        What is projected; without it the camera alone is calibrated.
    screen : sequence of ndarray, optional
        The same poses with a dark or plain projector, in the same order; the sheet's sides are then measured there.
    corners : array_like or sequence of array_like, optional
        (4, 2), px, for one photograph, or one such array or None for each: the sheet's corners TL, TR, BR, BL by hand, where
        it is not found. They may lie outside the frame.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photographs.
    names : sequence of str, optional
        Names of the photographs.

    Returns
    -------
    Observations

    Raises
    ------
    DetectionError
        When sheet or pattern is not found; the message says in which photograph, what was seen instead and what to do.
    Error
        When photographs differ in size, or lists in length.
    TypeError
        When a photograph is no such array.
    """

# Calibration

def calibrate(
    photos: Sequence[_ImageLike] | _ImageLike,
    size_mm: _Size,
    pattern: CheckerPattern | None = None,
    *,
    plain: Sequence[_ImageLike] | None = None,
    corners: Sequence[ArrayLike | None] | ArrayLike | None = None,
    camera: Camera | None = None,
    camera_pp: _PrincipalPoint = "prior",
    projector_pp: _PrincipalPoint = "shift",
    distortion: _Distortion = "auto",
    projector_distortion: _Distortion = "auto",
    method: Literal["ml", "two-vp"] = "ml",
    focal_35mm: float | None = None,
    gamma: _Gamma = "srgb",
    allow_degenerate: bool = False,
    names: Sequence[str] | None = None,
    screen: Sequence[_ImageLike] | None = None,
) -> Rig:
    """Calibrates a camera and a projector from photographs of one white sheet with a checkerboard projected on it.

    Parameters
    ----------
    photos : sequence of ndarray, or ndarray
        One photograph per pose of the sheet: (H, W, 3) in RGB order or (H, W), uint8 or uint16, all of one size. One
        photograph of a tilted sheet is enough; two with opposite tilts are far better.
    size_mm : (float, float)
        Width and height of the sheet, mm. Width is the side that runs most nearly along the image's x axis.
    pattern : CheckerPattern, optional
        What was projected; without it the camera alone is calibrated.
    screen : sequence of ndarray, optional
        The same poses with a dark or plain projector, in the same order; the sheet's sides are then measured there.
    corners : array_like, optional
        The sheet's corners TL, TR, BR, BL by hand where it is not found: (4, 2), px, for one photograph, or one of these for
        each. They may lie outside the frame.
    camera : Camera, optional
        Known intrinsics, held fixed; the rest is solved for.
    camera_pp, projector_pp : {"prior", "shift", "centre", "free"} or (float, float)
        What is known of the principal points: the centre as a prior; its column as a prior and its row free (lens shift);
        exactly the centre; nothing; exactly this pixel.
    distortion, projector_distortion : {"auto", "none", "k1", "k1k2", "full"}
        Which coefficients are estimated. "auto" estimates k1 and k2 when the photographs show them. Those of the projector
        need three photographs.
    method : {"ml", "two-vp"}
        Maximum likelihood, or the two vanishing points of R. Orghidan et al., "Structured light self-calibration with
        vanishing points", Machine Vision and Applications 25:489-500 (2014).
    focal_35mm : float, optional
        The camera's focal length as its 35 mm equivalent, as EXIF tags state it: expected, with a σ of some 5 %.
    gamma : {"srgb", "linear"} or float
        The transfer curve of the photographs.
    allow_degenerate : bool
        Give a rig with the verdict "degenerate" rather than an error.
    names : sequence of str, optional
        Names of the photographs, for the rig's views and for messages.

    Returns
    -------
    Rig
        With σ, covariance and verdict; `rig.report` says how the calibration went.

    Raises
    ------
    DetectionError
        When the checkerboard or the sheet is not found in a photograph.
    CalibrationError
        When the photographs do not determine the focal lengths, as with a sheet seen face-on.
    Error
        When values or shapes are not what they should be.
    TypeError
        When a photograph is no array of uint8 or uint16.

    Examples
    --------
    >>> checker = slcal.CheckerPattern(projector=(1024, 768))
    >>> scene = slcal.simulate.scene("sheet", pattern=checker)
    >>> rig = slcal.calibrate([scene.photo], size_mm=(594, 420), pattern=checker)
    >>> rig.quality.verdict
    'good'
    """
def calibrate_observations(
    observations: Observations | Mapping[str, Any],
    *,
    camera: Camera | None = None,
    camera_pp: _PrincipalPoint = "prior",
    projector_pp: _PrincipalPoint = "shift",
    distortion: _Distortion = "auto",
    projector_distortion: _Distortion = "auto",
    method: Literal["ml", "two-vp"] = "ml",
    focal_35mm: float | None = None,
    allow_degenerate: bool = False,
) -> Rig:
    """Calibrates from the observations of any detector: `slcal.observe`, or one's own.

    Parameters
    ----------
    observations : Observations or mapping
        What was seen; a mapping has the fields of the file (schema slcal-observations/1), with arrays or lists in it. A σ that
        is not stated is measured by the residuals, or assumed where there are too few.
    camera, camera_pp, projector_pp, distortion, projector_distortion, method, focal_35mm, allow_degenerate
        As for `calibrate`.

    Returns
    -------
    Rig

    Raises
    ------
    CalibrationError
        When the observations do not determine the focal lengths.
    FormatError
        When a mapping does not follow the schema; the message names the field.
    Error
        When numbers are not finite, corners are collinear, or anything else contradicts itself.
    """

@final
class Camera:
    """A camera or a projector: how it maps what stands before it onto its pixels, as OpenCV does.

    Parameters
    ----------
    K : array_like
        (3, 3), upper triangular, px: the camera matrix.
    size : (int, int)
        Width and height of the image or panel, px.
    distortion : array_like, optional
        Up to five of k1, k2, p1, p2, k3 in this order (OpenCV's "plumb bob"); none unless given.

    Raises
    ------
    Error
        When K is no camera matrix, or a number is not finite.

    Examples
    --------
    >>> camera = slcal.Camera([[1500, 0, 639.5], [0, 1500, 479.5], [0, 0, 1]], size=(1280, 960))
    >>> camera.project([[0, 0, 1000], [100, 0, 1000]])
    array([[639.5, 479.5],
           [789.5, 479.5]])
    """

    def __new__(cls, K: ArrayLike, size: tuple[int, int], distortion: ArrayLike | None = None) -> Camera: ...
    @staticmethod
    def load(file: _File) -> Camera:
        """Reads a camera's intrinsics.

        Parameters
        ----------
        file : path or file object
            A YAML or XML file of OpenCV, a camera_info of ROS, or a rig's JSON file, whose camera is taken. It must say how large
            the image is.

        Returns
        -------
        Camera
        """
    @staticmethod
    def from_fov(size: tuple[int, int], fov_deg: float) -> Camera:
        """A camera without distortion by its horizontal angle of view.

        Parameters
        ----------
        size : (int, int)
            Width and height of the image, px.
        fov_deg : float
            Angle of view across the width, degrees.

        Returns
        -------
        Camera
        """
    @staticmethod
    def from_35mm(size: tuple[int, int], focal_35mm: float) -> Camera:
        """A camera without distortion by the 35 mm equivalent of its focal length, as EXIF tags state it."""
    @staticmethod
    def from_throw(size: tuple[int, int], throw: float) -> Camera:
        """A projector by its throw ratio (distance over width of the picture), its axis through the lower edge of the panel as
        with most lens shifts.
        """
    @property
    def K(self) -> NDArray[np.float64]:
        """The camera matrix: (3, 3) float64, px."""
    @property
    def distortion(self) -> NDArray[np.float64]:
        """k1, k2, p1, p2, k3: (5,) float64."""
    @property
    def width(self) -> int:
        """Width of the image, px."""
    @property
    def height(self) -> int:
        """Height of the image, px."""
    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the image, px."""
    @property
    def sigma(self) -> DeviceSigma | _MaybeNone:
        """1σ of the parameters, zero for what was held fixed; None where nothing is known of them."""
    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """The pixels in which points are seen, as ``cv2.projectPoints`` with neither rotation nor translation.

        Parameters
        ----------
        points : array_like
            (N, 3), mm, in the camera's frame.

        Returns
        -------
        ndarray
            (N, 2) float64, px.

        Raises
        ------
        Error
            When a point does not lie before the camera, or where the distortion has no pixel for it.
        """
    def undistort(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """The directions in which pixels look, at distance 1 along the axis: ``cv2.undistortPoints`` to the end.

        Parameters
        ----------
        pixels : array_like
            (N, 2), px.

        Returns
        -------
        ndarray
            (N, 2) float64: x/z and y/z.

        Raises
        ------
        Error
            When the distortion's model does not reach a pixel.
        """
    def rays(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """The directions in which pixels look: (N, 3) float64 of length 1 from (N, 2) px."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Pose:
    """A rotation and a translation: X_a = R · X_b + t.

    Parameters
    ----------
    R : array_like
        (3, 3) rotation matrix, or (3,) rotation vector (axis times angle in rad, as of ``cv2.Rodrigues``).
    t : array_like
        (3,), mm.

    Raises
    ------
    Error
        When R is no rotation, or a number is not finite.

    Examples
    --------
    >>> pose = slcal.Pose(R=np.eye(3), t=[200, 10, -5])
    >>> pose.inverse().t
    array([-200.,  -10.,    5.])
    >>> (pose @ pose).t
    array([400.,  20., -10.])
    """

    def __new__(cls, R: ArrayLike, t: ArrayLike) -> Pose: ...
    @property
    def R(self) -> NDArray[np.float64]:
        """The rotation matrix: (3, 3) float64."""
    @property
    def t(self) -> NDArray[np.float64]:
        """The translation: (3,) float64, mm."""
    @property
    def rvec(self) -> NDArray[np.float64]:
        """The rotation as axis times angle: (3,) float64, rad, as of ``cv2.Rodrigues``."""
    @property
    def matrix(self) -> NDArray[np.float64]:
        """Both as one homogeneous matrix: (4, 4) float64."""
    @property
    def sigma_t_mm(self) -> NDArray[np.float64] | _MaybeNone:
        """1σ of t: (3,) float64, mm; None where it is not known."""
    @property
    def sigma_r_rad(self) -> NDArray[np.float64] | _MaybeNone:
        """1σ of a small rotation about the axes of frame a: (3,) float64, rad; None where it is not known."""
    def inverse(self) -> Pose:
        """The way back: X_b = Rᵀ · X_a − Rᵀ · t. It has no σ."""
    def transform(self, points: ArrayLike) -> NDArray[np.float64]:
        """R · X + t for each point: (N, 3) float64 from (N, 3), mm."""
    def __matmul__(self, other: Pose, /) -> Pose: ...
    def __rmatmul__(self, other: Pose, /) -> Pose: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class View:
    """One pose of the sheet that a rig was calibrated from."""

    @property
    def photo(self) -> str | None:
        """Name of the photograph, where it has one."""
    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the sheet, mm."""
    @property
    def camera_from_sheet(self) -> Pose:
        """X_camera = R · X_sheet + t, mm; the sheet's origin is its top-left corner, x along its top side."""
    @property
    def projector_from_sheet(self) -> Pose | _MaybeNone:
        """X_projector = R · X_sheet + t, mm; None without a projector."""
    @property
    def camera_vanishing_points(self) -> NDArray[np.float64]:
        """Vanishing points of the sheet's sides in the camera: (2, 3) float64, homogeneous px."""
    @property
    def projector_vanishing_points(self) -> NDArray[np.float64] | _MaybeNone:
        """The same in the projector; None without one."""
    @property
    def corners_px(self) -> NDArray[np.float64]:
        """Corners of the sheet TL, TR, BR, BL in the camera's image: (4, 2) float64, px."""
    @property
    def rms_px(self) -> ViewRms | _MaybeNone:
        """Root mean square residuals; None in rigs that do not state them."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Covariance:
    """Covariance of all estimated parameters."""

    @property
    def parameters(self) -> list[str]:
        """Names of rows and columns."""
    @property
    def matrix(self) -> NDArray[np.float64]:
        """(P, P) float64, symmetric, in the units of the parameters (px, mm, rad)."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Rectification:
    """Where a picture is drawn on the projector's panel so that it appears upright on the sheet."""

    @property
    def panel_from_source(self) -> NDArray[np.float64]:
        """(3, 3) float64: pixels of the source, homogeneous, onto those of a panel whose lens does not distort; `map` goes through
        the lens as well.
        """
    @property
    def corners_px(self) -> NDArray[np.float64]:
        """Corners TL, TR, BR, BL of the picture on the panel: (4, 2) float64, px."""
    def map(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Pixels of the panel that show pixels of the source.

        Parameters
        ----------
        pixels : array_like
            (N, 2), px of the source.

        Returns
        -------
        ndarray
            (N, 2) float64, px of the panel.

        Raises
        ------
        Error
            For a point that lies at infinity on the panel.
        """
    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the picture on the sheet, mm."""
    @property
    def origin_mm(self) -> tuple[float, float]:
        """Its top-left corner on the sheet, mm from the sheet's own."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Rig:
    """A calibrated camera, and projector if a pattern was seen; with how sure it is.

    `slcal.calibrate` makes rigs; this makes one of devices that are known from elsewhere.

    Parameters
    ----------
    camera : Camera
        The camera.
    projector : Camera, optional
        The projector, as if it were a camera.
    projector_from_camera : Pose, optional
        X_projector = R · X_camera + t, mm; given exactly when the projector is.
    method : str, default "external"
        How the rig was made, in a word.

    Raises
    ------
    Error
        When only one of projector and projector_from_camera is given.

    Examples
    --------
    >>> camera = slcal.Camera.from_fov((1280, 960), 45)
    >>> projector = slcal.Camera.from_throw((1024, 768), 1.6)
    >>> rig = slcal.Rig(camera, projector, slcal.Pose(np.eye(3), [-200, 0, 0]))
    >>> rig.baseline_mm
    200.0
    >>> slcal.Rig.from_json(rig.to_json()) == rig
    True
    """

    def __new__(
        cls,
        camera: Camera,
        projector: Camera | None = None,
        projector_from_camera: Pose | None = None,
        *,
        method: str = "external",
    ) -> Rig: ...
    @property
    def camera(self) -> Camera:
        """The camera."""
    @property
    def projector(self) -> Camera | _MaybeNone:
        """The projector; None when the camera alone was calibrated."""
    @property
    def projector_from_camera(self) -> Pose | _MaybeNone:
        """X_projector = R · X_camera + t, mm; None without a projector."""
    @property
    def views(self) -> list[View]:
        """The poses of the sheet that it was calibrated from."""
    @property
    def method(self) -> str:
        """How it was made: "ml", "two-vp", or anything else for rigs from elsewhere."""
    @property
    def quality(self) -> Quality | _MaybeNone:
        """How far it can be trusted; None for rigs from elsewhere that do not say."""
    @property
    def covariance(self) -> Covariance | _MaybeNone:
        """Covariance of all estimated parameters; None for rigs from elsewhere."""
    @property
    def report(self) -> CalibrationReport | _MaybeNone:
        """How the calibration went; None for a rig that was not calibrated in this program."""
    @property
    def baseline_mm(self) -> float | _MaybeNone:
        """Distance between the optical centres, mm; None without a projector."""
    @property
    def baseline_sigma_mm(self) -> float | _MaybeNone:
        """1σ of it, mm; None without a covariance."""
    def save(self, file: _File) -> None:
        """Writes the rig file (schema slcal-rig/1), which the command line and other programs read.

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _File) -> Rig:
        """Reads a rig file, however it was made.

        Parameters
        ----------
        file : path or file object
            The JSON file (schema slcal-rig/1).

        Returns
        -------
        Rig

        Raises
        ------
        OSError
            When the file cannot be read.
        FormatError
            When it does not follow its schema; the message names the field.
        """
    def to_json(self) -> str:
        """The content of the rig file."""
    @staticmethod
    def from_json(text: str) -> Rig:
        """The rig that `to_json` wrote."""
    def to_opencv(self) -> dict[str, NDArray[Any]]:
        """The rig as OpenCV's functions take it.

        Returns
        -------
        dict
            `camera_K` (3, 3), `camera_dist` (5,), `camera_size` (2,), the same of the projector, and `R` (3, 3) and `t` (3, 1) with
            X_projector = R · X_camera + t, mm: what ``cv2.stereoRectify`` calls R and T. Without a projector its entries are
            left out.

        Examples
        --------
        >>> camera = slcal.Camera.from_fov((1280, 960), 45)
        >>> sorted(slcal.Rig(camera).to_opencv())
        ['camera_K', 'camera_dist', 'camera_size']
        """
    @staticmethod
    def from_opencv(
        parameters: Mapping[str, ArrayLike] | None = None,
        /,
        *,
        camera_K: ArrayLike | None = None,
        camera_dist: ArrayLike | None = None,
        camera_size: ArrayLike | None = None,
        projector_K: ArrayLike | None = None,
        projector_dist: ArrayLike | None = None,
        projector_size: ArrayLike | None = None,
        R: ArrayLike | None = None,
        t: ArrayLike | None = None,
    ) -> Rig:
        """A rig from what OpenCV's functions give.

        Parameters
        ----------
        parameters : mapping, optional
            What `to_opencv` gives; or the same as keyword arguments.
        camera_K, projector_K : array_like
            (3, 3), px.
        camera_dist, projector_dist : array_like, optional
            Up to five of k1, k2, p1, p2, k3; none unless given.
        camera_size, projector_size : (int, int)
            Width and height, px.
        R : array_like
            (3, 3), or (3,) as of ``cv2.Rodrigues``.
        t : array_like
            (3,) or (3, 1), mm: X_projector = R · X_camera + t.

        Returns
        -------
        Rig

        Raises
        ------
        Error
            When something is missing or is not what its name says.
        """
    def save_report(
        self,
        file: _File,
        *,
        photos: Sequence[_ImageLike] | _ImageLike | None = None,
        observations: Observations | Mapping[str, Any] | None = None,
        cloud: PointCloud | None = None,
    ) -> None:
        """Writes a page that shows the calibration: how good, why, what next. Any browser opens it, without a network.

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        photos : sequence of ndarray, or ndarray, optional
            The photographs that the rig was calibrated from, one for each of its views.
        observations : Observations or mapping, optional
            What was measured in them (`slcal.observe`): sides, corners and residuals are drawn. A σ that is not stated is taken
            from the residuals themselves.
        cloud : PointCloud, optional
            Points to show beside the devices.

        Raises
        ------
        Error
            When photographs or observations are not those of the rig: another number of views, other sizes.
        OSError
            When the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> rig = slcal.Rig(slcal.Camera.from_fov((1280, 960), 45))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     rig.save_report(f"{folder}/report.html")
        """
    def export(self, path: _Path, to: _ExchangeFormat, *, lossy: bool = False) -> list[str]:
        """Writes files that another program reads.

        Parameters
        ----------
        path : path
            Where to; files there are replaced. For "opencv" it ends in .yml, .yaml, .xml or .json; for "ros" it is the camera's .yaml, the
            projector's goes beside it as NAME_projector.yaml, or a folder; for "colmap" a folder; for "kalibr" a .yaml, for
            "blender" a .py, for "npz" an .npz.
        to : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}
            The format.
        lossy : bool, default False
            Whether terms of a lens that the format does not have are left out; otherwise they are an error.

        Returns
        -------
        list of str
            What the format has no place for, a line each.

        Raises
        ------
        Error
            When the format cannot hold a lens (the message says how far pixels would move), or the path is not for it.
        OSError
            When a file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> rig = slcal.Rig(slcal.Camera.from_fov((1280, 960), 45))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     left_out = rig.export(f"{folder}/rig.yml", "opencv")
        ...     slcal.Rig.import_from(f"{folder}/rig.yml") == rig
        True
        """
    @staticmethod
    def import_from(
        paths: _Path | Iterable[_Path],
        format: _ExchangeFormat | None = None,
        *,
        camera_size: ArrayLike | None = None,
        projector_size: ArrayLike | None = None,
    ) -> Rig:
        """Reads files of another program: those that `export` wrote, or calibrations made elsewhere.

        Parameters
        ----------
        paths : path or list of paths
            The file; for "ros" the camera's and the projector's, or their folder; for "colmap" the folder.
        format : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}, optional
            Whose files they are; told by their content unless given.
        camera_size, projector_size : (int, int), optional
            Width and height, px, for files that do not say them.

        Returns
        -------
        Rig

        Raises
        ------
        FormatError
            When the files are of another format, or something is missing in them.
        Error
            When the size of an image is nowhere to be found.
        OSError
            When a file cannot be read.
        """
    def reconstruct(
        self,
        image: _ImageLike,
        pattern: StripePattern,
        *,
        black: _ImageLike | None = None,
        white: _ImageLike | None = None,
        gamma: _Gamma = "srgb",
        frame: _Frame = "camera",
        mesh: bool = False,
        cull: _Cull = "auto",
        min_confidence: float = 0.4,
        near: float | None = None,
        far: float | None = None,
    ) -> PointCloud:
        """The cloud of one photograph of the stripes on whatever stands before the rig. `Reconstructor` is for many.

        Parameters
        ----------
        image : ndarray
            (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected.
        pattern : StripePattern
            The stripes, drawn for the rig's projector.
        black, white : ndarray, optional
            The same scene with a dark projector (the room's light is taken off) and with plain white (the surface's own
            colours are divided out).
        gamma : {"srgb", "linear"} or float, default "srgb"
            How the image's values follow the light.
        frame : {"camera", "plane"}, default "camera"
            Whose coordinates the cloud has: the camera's, or those of the sheet of the rig's first view.
        mesh : bool, default False
            Whether the cloud keeps the triangles between its points.
        cull : {"auto", "off"} or float, default "auto"
            Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left
            out.
        min_confidence : float, default 0.4
            Matches below it are left out, 0 to 1.

        Returns
        -------
        PointCloud
            Its `report` says what was seen and what became of it.

        Raises
        ------
        TypeError
            When the image is no array of uint8 or uint16.
        Error
            When its shape or size is another one, the rig has no projector (or, for "plane", no view), the pattern is for
            another panel, or an option is out of range.
        DecodeError
            When the stripes are not in it, or cannot be those of this rig. The message says so when they are found as soon
            as red and blue change places.

        Examples
        --------
        >>> from slcal import simulate
        >>> scene = simulate.scene("sphere")
        >>> cloud = scene.rig.reconstruct(scene.photo, scene.pattern)
        >>> cloud.points.shape == (len(cloud), 3)
        True
        """
    def triangulate(
        self,
        pixels: Matches | ArrayLike,
        columns: ArrayLike | None = None,
        rows: ArrayLike | None = None,
        *,
        sigma_px: ArrayLike | None = None,
        frame: _Frame = "camera",
        mesh: bool = False,
        cull: _Cull = "off",
        near: float | None = None,
        far: float | None = None,
    ) -> PointCloud:
        """Points from camera pixels and the projector columns (or rows) that light them, of whatever decoder.

        Parameters
        ----------
        pixels : Matches or array_like
            Matches, or (N, 2) camera px.
        columns, rows : array_like, optional
            (N,), projector px, NaN where one is not known; at least one of the two beside an array of pixels.
        sigma_px : array_like, optional
            (N,) or one for all: 1σ of the camera position across the stripe, px. Unless given, that of the matches, or 0.1.
        frame : {"camera", "plane"}, default "camera"
            Whose coordinates the cloud has: the camera's, or those of the sheet of the rig's first view.
        mesh : bool, default False
            Whether the cloud keeps the triangles between its points.
        cull : {"auto", "off"} or float, default "off"
            Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left
            out. With "off" every match that can be a point becomes one, in the order given.

        Returns
        -------
        PointCloud
            Its `report` counts the matches that are no points: without coordinates ("invalid"), behind the devices, lit from
            outside the panel, and so on.

        Raises
        ------
        TypeError
            When something is no array of numbers.
        Error
            When the shapes do not fit each other, pixels are not finite, or the rig has no projector (or, for "plane", no
            view).
        DecodeError
            When no match is a point.

        Examples
        --------
        >>> camera = slcal.Camera.from_fov((1280, 960), 45)
        >>> projector = slcal.Camera([[1600, 0, 511.5], [0, 1600, 383.5], [0, 0, 1]], size=(1024, 768))
        >>> rig = slcal.Rig(camera, projector, slcal.Pose(np.eye(3), [-200, 0, 0]))
        >>> pixel = camera.project([[20, 30, 1000]])
        >>> column = projector.project([[20 - 200, 30, 1000]])[:, 0]
        >>> rig.triangulate(pixel, column).points.round(6)
        array([[  20.,   30., 1000.]])
        """
    def rectify(self, source: CheckerPattern | _ImageLike, *, view: int = 0) -> NDArray[np.uint8]:
        """The picture to project so that a picture appears upright and as large as possible on the sheet.

        Parameters
        ----------
        source : CheckerPattern or ndarray
            A checkerboard, drawn with sharp edges and half a square of its background around it, or any picture: (H, W, 3)
            RGB or (H, W), uint8 (uint16 is brought to 8 bits).
        view : int, default 0
            Which of the rig's views tells where the sheet is.

        Returns
        -------
        ndarray
            (H, W, 3) uint8, as large as the projector's panel.

        Raises
        ------
        Error
            For a rig without a projector or such a view, and for a pattern for another panel.
        CalibrationError
            When the projector does not light the sheet.
        TypeError
            When the source is neither of these.
        """
    def rectification(self, source: CheckerPattern | _ImageLike, *, view: int = 0) -> Rectification:
        """Where `rectify` draws a picture: on the panel, and on the sheet in millimetres.

        Parameters
        ----------
        source : CheckerPattern or ndarray
            As for `rectify`.
        view : int, default 0
            As for `rectify`.

        Returns
        -------
        Rectification
        """
    def verify(
        self,
        photo: _ImageLike,
        pattern: CheckerPattern,
        *,
        size_mm: _Size | None = None,
        as_drawn: bool = False,
        corners: ArrayLike | None = None,
        gamma: _Gamma = "srgb",
        significance: float = 0.001,
    ) -> Verification:
        """How square a projected checkerboard is on the sheet now, and whether projector, camera or sheet have moved.

        Parameters
        ----------
        photo : ndarray
            (H, W, 3) RGB or (H, W), uint8 or uint16, by the rig's camera: the sheet with the pattern projected on it.
        pattern : CheckerPattern
            What is projected, by default as `rectify` draws it for the rig's first view.
        size_mm : (float, float), optional
            Width and height of the sheet, mm, when it is not that of the rig's first view.
        as_drawn : bool, default False
            The pattern is projected as it was drawn, not rectified; the sheet may then stand anywhere.
        corners : array_like, optional
            (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when it is not found.
        gamma : {"srgb", "linear"} or float, default "srgb"
            The transfer curve of the photograph.
        significance : float, default 0.001
            How often a rig that has not moved may be said to have.

        Returns
        -------
        Verification
            `keystone` with its σ, `rig.moved` and what has changed, `sheet.moved`.

        Raises
        ------
        DetectionError
            When sheet or pattern is not found.
        CalibrationError
            When photograph and rig do not go together at all.
        Error
            For a photograph of another size, a pattern for another panel, a rig without a projector, a rig without views unless
            `as_drawn` and `size_mm` are given.
        TypeError
            When the photograph is no such array.
        """
    def advise(self, pattern: CheckerPattern | None = None) -> Advice:
        """What one more photograph would bring, and which to take.

        Parameters
        ----------
        pattern : CheckerPattern, optional
            What will be projected; the default checkerboard for the rig's panel unless given.

        Returns
        -------
        Advice
            σ now and after a photograph with each of several tilts, and the `next` photograph in numbers and in words.

        Raises
        ------
        Error
            For a rig without views or covariance (see `slcal.advise` for these), or a pattern for another panel.
        """
    def _repr_html_(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...

def advise(
    camera: Camera,
    size_mm: _Size,
    *,
    projector: Camera | None = None,
    distance_mm: float | None = None,
    noise_px: float = 0.05,
    camera_pp: _PrincipalPoint = "prior",
    projector_pp: _PrincipalPoint = "shift",
    distortion: _Distortion = "auto",
) -> Advice:
    """How to hold the sheet for the first photographs, and what they will bring: σ of the focal lengths against tilt.

    Parameters
    ----------
    camera : Camera
        Roughly: see `Camera.from_fov` and `Camera.from_35mm`.
    size_mm : (float, float)
        Width and height of the sheet, mm.
    projector : Camera, optional
        Roughly: see `Camera.from_throw`; without it, the camera alone. It is taken to stand a quarter of the distance to the
        camera's right.
    distance_mm : float, optional
        From the camera to the sheet's middle; so that the sheet fills 60 % of the frame unless given.
    noise_px : float, default 0.05
        1σ of a corner of the sheet and of the pattern in the photograph, px.
    camera_pp : {"prior", "centre", "free", "shift"} or (float, float), default "prior"
        What will be known of the camera's principal point.
    projector_pp : {"shift", "prior", "centre", "free"} or (float, float), default "shift"
        What will be known of the projector's.
    distortion : {"auto", "none", "k1", "k1k2", "full"}, default "auto"
        Which distortion of the camera will be estimated; "auto" plans with none.

    Returns
    -------
    Advice
        A `table` over tilts, and the `next` photograph in numbers and in words.

    Raises
    ------
    Error
        For numbers that are not finite and positive.

    Examples
    --------
    >>> camera = slcal.Camera.from_fov((1280, 960), 50)
    >>> advice = slcal.advise(camera, size_mm=(594, 420))
    >>> advice.next.then_reversed
    True
    >>> advice.next.in_words.startswith("hold the sheet with its")
    True
    """

# From stripes to points

@final
class Matches:
    """Which projector column or row lights which camera pixel.

    `slcal.decode` makes them; those of another decoder are made from its arrays. Two of them are equal when their numbers
    are; the report is not compared.

    Parameters
    ----------
    pixels : array_like
        (N, 2), camera px: x right, y down, the middle of the first pixel at (0, 0).
    columns, rows : array_like, optional
        (N,), projector px; NaN where one is not known. At least one of the two.
    slits : array_like, optional
        (N,), numbers of the slits from 0 on, -1 where there is none (the default).
    confidence : array_like, optional
        (N,) or one for all, 0 to 1; 1 unless given.
    sigma_px : array_like, optional
        (N,) or one for all: 1σ of the camera position across the stripe, px; 0.1 unless given.
    colors : array_like, optional
        (N, 3), sRGB from 0 to 255; white unless given.

    Raises
    ------
    Error
        When the shapes do not fit each other, pixels are not finite, or a number is out of its range.
    TypeError
        When something is no array of numbers.

    Examples
    --------
    >>> matches = slcal.Matches([[320.5, 240], [330.25, 240]], columns=[400, 416], sigma_px=0.05)
    >>> matches
    Matches(2 with columns)
    >>> matches.pixels[1]
    array([330.25, 240.  ])
    >>> matches.rows is None
    True
    """

    def __new__(
        cls,
        pixels: ArrayLike,
        columns: ArrayLike | None = None,
        rows: ArrayLike | None = None,
        *,
        slits: ArrayLike | None = None,
        confidence: ArrayLike | None = None,
        sigma_px: ArrayLike | None = None,
        colors: ArrayLike | None = None,
    ) -> Matches: ...
    @property
    def pixels(self) -> NDArray[np.float64]:
        """Camera pixels (x, y): (N, 2) float64. Of stripes, sub-pixel across them and integer along them."""
    @property
    def columns(self) -> NDArray[np.float64] | _MaybeNone:
        """Projector columns: (N,) float64, px, NaN where one is not known; None when the matches have rows alone."""
    @property
    def rows(self) -> NDArray[np.float64] | _MaybeNone:
        """Projector rows: (N,) float64, px, NaN where one is not known; None when the matches have columns alone."""
    @property
    def slits(self) -> NDArray[np.int32]:
        """Numbers of the slits: (N,) int32, -1 where there is none."""
    @property
    def confidence(self) -> NDArray[np.float64]:
        """How sure the matches are: (N,) float64, 0 to 1."""
    @property
    def sigma_px(self) -> NDArray[np.float64]:
        """1σ of the camera positions across the stripe: (N,) float64, px."""
    @property
    def colors(self) -> NDArray[np.uint8]:
        """Colours of the photograph there: (N, 3) uint8, sRGB."""
    @property
    def report(self) -> DecodeReport | _MaybeNone:
        """What decoding saw; None for matches that were constructed or loaded."""
    def save(self, file: _File) -> None:
        """Writes the matches as CSV: u, v, projector_column and/or projector_row, slit, confidence, sigma_px.

        Positions, confidences and σ are rounded to 1e-5; colours are not part of the file.

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _File) -> Matches:
        """Reads matches that `save`, ``slcal decode`` or any other decoder wrote.

        Parameters
        ----------
        file : path or file object
            CSV with a header. The columns u, v and at least one of projector_column and projector_row are needed; slit,
            confidence and sigma_px are taken when they are there.

        Returns
        -------
        Matches

        Raises
        ------
        OSError
            When the file cannot be read.
        FormatError
            When it is not what is described above; the message names the line.
        """
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

def decode(
    image: _ImageLike,
    pattern: StripePattern,
    *,
    black: _ImageLike | None = None,
    white: _ImageLike | None = None,
    gamma: _Gamma = "srgb",
    min_confidence: float = 0.4,
) -> Matches:
    """Finds the stripes of a photograph and says which slit each is.

    Parameters
    ----------
    image : ndarray
        (H, W, 3), uint8 or uint16, RGB order: what stands before the rig, with the stripes projected.
    pattern : StripePattern
        The stripes.
    black, white : ndarray, optional
        The same view with a dark projector (the room's light is taken off) and with plain white (the surface's own colours
        are divided out).
    gamma : {"srgb", "linear"} or float, default "srgb"
        How the image's values follow the light.
    min_confidence : float, default 0.4
        Matches below it are left out and counted, 0 to 1.

    Returns
    -------
    Matches
        One per slit and image row (column, where the stripes lie across); its `report` says what was seen and why some
        of it was left out.

    Raises
    ------
    TypeError
        When the image is no array of uint8 or uint16.
    Error
        When its shape is another one, it is grey, frames differ in size, or an option is out of range.
    DecodeError
        When there are no stripes in it, or not those of the pattern. The message says so when they are found as soon as red
        and blue change places.

    Examples
    --------
    >>> stripes = slcal.StripePattern(projector=(1024, 768))
    >>> matches = slcal.decode(stripes.image(), stripes)  # The projector's own picture: what it lights is itself.
    >>> bool(np.abs(matches.pixels[:, 0] - matches.columns).max() < 0.05)
    True
    >>> matches.report.slits
    64
    """

@final
class PointCloud:
    """Points in space, with what is known of each, and the triangles between them where a mesh was asked for.

    `Rig.reconstruct` and `Rig.triangulate` make clouds; they can also be made of arrays. Two of them are equal when their
    numbers are (NaN equals NaN); the report is not compared. ``np.asarray(cloud)`` gives the points.

    Parameters
    ----------
    points : array_like
        (N, 3), mm.
    colors : array_like, optional
        (N, 3), sRGB from 0 to 255; black unless given.
    sigma : array_like, optional
        (N,) or one for all: 1σ along the camera's ray, mm; 0 unless given.
    noise : array_like, optional
        (N,) or one for all: the part of `sigma` that differs from point to point, mm; 0 unless given.
    pixels : array_like, optional
        (N, 2): the camera pixels in which the points are seen; NaN unless given.
    slits : array_like, optional
        (N,): numbers of the slits; 0 unless given.
    confidence : array_like, optional
        (N,) or one for all, 0 to 1; 1 unless given.
    triangles : array_like, optional
        (M, 3): indices into the points, counter-clockwise as the camera sees them.
    frame : {"camera", "plane"}, default "camera"
        Whose coordinates these are: the camera's, or those of the sheet of the rig's first view.
    camera_centre : array_like, optional
        (3,): where the camera stands in these coordinates, mm; the origin unless given.

    Raises
    ------
    Error
        When the shapes do not fit each other, points are not finite, or a number is out of its range.
    TypeError
        When something is no array of numbers.

    Examples
    --------
    >>> cloud = slcal.PointCloud([[0, 0, 1000], [3, 4, 1000]], sigma=0.2)
    >>> cloud
    PointCloud(2 points, 1000.0 to 1000.0 mm from the camera, median σ 0.200 mm)
    >>> np.asarray(cloud).shape
    (2, 3)
    """

    def __new__(
        cls,
        points: ArrayLike,
        *,
        colors: ArrayLike | None = None,
        sigma: ArrayLike | None = None,
        noise: ArrayLike | None = None,
        pixels: ArrayLike | None = None,
        slits: ArrayLike | None = None,
        confidence: ArrayLike | None = None,
        triangles: ArrayLike | None = None,
        frame: _Frame = "camera",
        camera_centre: ArrayLike | None = None,
    ) -> PointCloud: ...
    @property
    def points(self) -> NDArray[np.float64]:
        """Positions: (N, 3) float64, mm."""
    @property
    def colors(self) -> NDArray[np.uint8]:
        """Colours: (N, 3) uint8, sRGB."""
    @property
    def sigma(self) -> NDArray[np.float64]:
        """1σ along the camera's ray: (N,) float64, mm; of the match and of the rig together."""
    @property
    def noise(self) -> NDArray[np.float64]:
        """The part of `sigma` that differs from point to point: (N,) float64, mm. The rest is common to the whole cloud."""
    @property
    def pixels(self) -> NDArray[np.float64]:
        """Camera pixels (x, y) in which the points were seen: (N, 2) float64, NaN in clouds from files."""
    @property
    def slits(self) -> NDArray[np.uint16]:
        """Numbers of the slits: (N,) uint16, 0 where the matches were not of stripes."""
    @property
    def confidence(self) -> NDArray[np.float64]:
        """How sure the matches were: (N,) float64, 0 to 1."""
    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Indices into the points: (M, 3) uint32, counter-clockwise as the camera sees them; (0, 3) without a mesh."""
    @property
    def frame(self) -> _Frame:
        """Whose coordinates these are: "camera", or "plane" for the sheet of the rig's first view."""
    @property
    def camera_centre(self) -> NDArray[np.float64]:
        """Where the camera stands in these coordinates: (3,) float64, mm."""
    @property
    def report(self) -> CloudReport | _MaybeNone:
        """How the cloud came about; None for one that was constructed or loaded."""
    def save(self, file: _File, *, format: Literal["ply", "pcd", "xyz", "obj", "glb"] | None = None) -> None:
        """Writes the cloud.

        PLY holds all but pixels, in single precision; OBJ and GLB hold points, colours and triangles (GLB in metres, y up); PCD and
        XYZ have no triangles.

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        format : {"ply", "pcd", "xyz", "obj", "glb"}, optional
            By the extension of the path unless given; "ply" for file objects.

        Raises
        ------
        Error
            When neither the extension nor `format` is one of these.
        OSError
            When the file cannot be written.
        """
    @staticmethod
    def load(file: _File) -> PointCloud:
        """Reads a cloud from a PLY file, text or binary.

        Parameters
        ----------
        file : path or file object
            Positions are needed; colours, sigma, noise, slit, confidence and faces are taken when they are there.

        Returns
        -------
        PointCloud

        Raises
        ------
        OSError
            When the file cannot be read.
        FormatError
            When it is no PLY, or not a whole one.
        Error
            When its name is that of another format, which are written only.
        """
    def to_bytes(self, format: Literal["ply", "pcd", "xyz", "obj", "glb"] = "ply") -> bytes:
        """The content of the file that `save` would write."""
    def fit_plane(self) -> PlaneFit:
        """Fits a plane to the points, which may hold other things as well.

        Returns
        -------
        PlaneFit
            The plane, and how far its inliers lie from it.

        Raises
        ------
        Error
            When there are fewer than three points, or no plane has points on it.
        """
    def fit_sphere(self) -> SphereFit:
        """Fits a sphere to the points, which may hold a wall as well.

        Returns
        -------
        SphereFit
            The sphere, and how far its inliers lie from it.

        Raises
        ------
        Error
            When there are fewer than four points, or no sphere that the camera could see has points on it.
        """
    def crop(self, min: ArrayLike, max: ArrayLike) -> PointCloud: ...
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: _Indices, /) -> PointCloud: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def __eq__(self, other: object, /) -> bool: ...

@overload
def evaluate(cloud: PointCloud | ArrayLike, shape: Literal["plane"]) -> PlaneFit:
    """Fits a plane or a sphere to a cloud and says how far its points lie from it, as ``slcal evaluate`` does.

    The fit is robust: the cloud may hold other things as well. Points count as inliers within four times their robust σ,
    and the figures are those of the inliers.

    Parameters
    ----------
    cloud : PointCloud or array_like
        The points; of an array (N, 3), mm, in the camera's frame.
    shape : {"plane", "sphere"}
        What to fit.

    Returns
    -------
    PlaneFit or SphereFit

    Raises
    ------
    Error
        When there are too few points, they are not finite, or no such shape has points on it.

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
    >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
    (400, True)
    """
@overload
def evaluate(cloud: PointCloud | ArrayLike, shape: Literal["sphere"]) -> SphereFit:
    """Fits a plane or a sphere to a cloud and says how far its points lie from it, as ``slcal evaluate`` does.

    The fit is robust: the cloud may hold other things as well. Points count as inliers within four times their robust σ,
    and the figures are those of the inliers.

    Parameters
    ----------
    cloud : PointCloud or array_like
        The points; of an array (N, 3), mm, in the camera's frame.
    shape : {"plane", "sphere"}
        What to fit.

    Returns
    -------
    PlaneFit or SphereFit

    Raises
    ------
    Error
        When there are too few points, they are not finite, or no such shape has points on it.

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
    >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
    (400, True)
    """
@overload
def evaluate(cloud: PointCloud | ArrayLike, shape: Literal["plane", "sphere"]) -> PlaneFit | SphereFit:
    """Fits a plane or a sphere to a cloud and says how far its points lie from it, as ``slcal evaluate`` does.

    The fit is robust: the cloud may hold other things as well. Points count as inliers within four times their robust σ,
    and the figures are those of the inliers.

    Parameters
    ----------
    cloud : PointCloud or array_like
        The points; of an array (N, 3), mm, in the camera's frame.
    shape : {"plane", "sphere"}
        What to fit.

    Returns
    -------
    PlaneFit or SphereFit

    Raises
    ------
    Error
        When there are too few points, they are not finite, or no such shape has points on it.

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
    >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
    (400, True)
    """

@final
class Reconstructor:
    """One photograph after another with the same rig and pattern, as of a video: what `Rig.reconstruct` does, with buffers that
    are kept from frame to frame.

    Several threads may use one, but they wait for each other; for two at a time take two.

    Parameters
    ----------
    rig : Rig
        With a projector.
    pattern : StripePattern
        The stripes, drawn for that projector.
    gamma : {"srgb", "linear"} or float, default "srgb"
        How the values of the images follow the light.
    frame : {"camera", "plane"}, default "camera"
        Whose coordinates the clouds have: the camera's, or those of the sheet of the rig's first view.
    mesh : bool, default False
        Whether the clouds keep the triangles between their points.
    cull : {"auto", "off"} or float, default "auto"
        Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left out.
    min_confidence : float, default 0.4
        Matches below it are left out, 0 to 1.

    Raises
    ------
    Error
        When the rig has no projector (or, for "plane", no view), the pattern is for another panel, or an option is out of
        range.

    Examples
    --------
    >>> from slcal import simulate
    >>> scene = simulate.scene("plane")
    >>> scanner = slcal.Reconstructor(scene.rig, scene.pattern)
    >>> cloud = scanner.reconstruct(scene.photo)
    >>> bool(cloud.fit_plane().report.rms_mm < 1)
    True
    """

    def __new__(
        cls,
        rig: Rig,
        pattern: StripePattern,
        *,
        gamma: _Gamma = "srgb",
        frame: _Frame = "camera",
        mesh: bool = False,
        cull: _Cull = "auto",
        min_confidence: float = 0.4,
        near: float | None = None,
        far: float | None = None,
    ) -> Reconstructor: ...
    def reconstruct(
        self, image: _ImageLike, *, black: _ImageLike | None = None, white: _ImageLike | None = None
    ) -> PointCloud:
        """The cloud of one photograph.

        Parameters
        ----------
        image : ndarray
            (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected.
        black, white : ndarray, optional
            The same scene with a dark projector and with plain white.

        Returns
        -------
        PointCloud
            Its own, whatever comes next.

        Raises
        ------
        TypeError
            When the image is no array of uint8 or uint16.
        Error
            When its shape or size is another one.
        DecodeError
            When the stripes are not in it, or cannot be those of this rig.
        """

# Photographs and observations with known truth: see slcal.simulate for what the functions take

@final
class Scene:
    """Photographs of a simulated scene, and what is true of every pixel. `slcal.simulate.scene` makes them.

    Examples
    --------
    >>> from slcal import simulate
    >>> scene = simulate.scene("sphere", camera=(320, 240), focal=375)
    >>> scene
    Scene(320x240, 2 surfaces, 10134 matches)
    >>> scene.photo.shape, scene.depth.shape
    ((240, 320, 3), (240, 320))
    """

    @property
    def rig(self) -> Rig:
        """The true rig; one that was simulated and looks at a sheet has it as its view."""
    @property
    def pattern(self) -> CheckerPattern | StripePattern:
        """What was projected."""
    @property
    def photo(self) -> _Image:
        """The photograph under the pattern: (H, W, 3) uint8, or uint16 with 16 bits."""
    @property
    def white(self) -> _Image:
        """The photograph under a white projector."""
    @property
    def black(self) -> _Image:
        """The photograph under a dark projector."""
    @property
    def matches(self) -> Matches:
        """Where slits or corners of the pattern are seen, without error."""
    @property
    def cloud(self) -> PointCloud:
        """The points that the matches see, in the camera's frame."""
    @property
    def column(self) -> NDArray[np.float32]:
        """The projector column that lights what each pixel sees: (H, W) float32, px; NaN in shadow and beside the light."""
    @property
    def row(self) -> NDArray[np.float32]:
        """The projector row that lights what each pixel sees: (H, W) float32, px; NaN in shadow and beside the light."""
    @property
    def depth(self) -> NDArray[np.float32]:
        """Depth of what each pixel sees along the camera's axis: (H, W) float32, mm; NaN where it sees nothing."""
    @property
    def surface(self) -> NDArray[np.uint8]:
        """Which surface each pixel sees: (H, W) uint8, counted from 1; 0 for none."""
    @property
    def report(self) -> SceneReport:
        """What the photograph shows, in numbers."""

def simulate_scene(options: dict[str, Any], /) -> Scene:
    """Photographs of a rig before a surface, with the truth of every pixel; see `slcal.simulate.scene`."""
def simulate_views(options: dict[str, Any], /) -> tuple[Observations, Rig]:
    """Observations of a sheet in several poses and the rig behind them; see `slcal.simulate.views`."""
def simulate_noise(options: dict[str, Any], /) -> NoiseReport:
    """Both methods of calibration under rising noise; see `slcal.simulate.noise`."""
def run_command(args: Sequence[str], /) -> int:
    """Runs a command line, the program's name first, and returns its exit code."""
