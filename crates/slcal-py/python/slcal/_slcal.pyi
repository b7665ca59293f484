from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import IO, Any, Final, Literal, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .reports import (
    Advice,
    CalibrationReport,
    ChannelRegistration,
    CloudReport,
    DecodeReport,
    DeviceSigma,
    NoiseReport,
    PlaneFit,
    Quality,
    SceneReport,
    SequenceDecodeReport,
    SphereFit,
    Verification,
    ViewBend,
    ViewRms,
)

__all__ = [
    "Camera",
    "CheckerPattern",
    "CornerDetection",
    "Covariance",
    "DenseMatches",
    "Detection",
    "Matches",
    "Observations",
    "PhotoTags",
    "PointCloud",
    "Pose",
    "Reconstructor",
    "Rectification",
    "Rig",
    "Scene",
    "SceneFrames",
    "SequencePattern",
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
    "read_tags",
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
#: The photographs of a sequence, in its order.
_Frames: TypeAlias = _ImageLike | Iterable[_ImageLike | _Path]
_ExchangeFormat: TypeAlias = Literal["opencv", "ros", "colmap", "kalibr", "blender", "npz"]
_File: TypeAlias = _Path | IO[bytes] | IO[str]
_Gamma: TypeAlias = Literal["srgb", "linear"] | float
_PrincipalPoint: TypeAlias = Literal["prior", "shift", "centre", "free"] | tuple[float, float]
_Distortion: TypeAlias = Literal["auto", "none", "k1", "k1k2", "full"]
#: A length such as "0.5mm" is any text to a type checker; a number is millimetres.
_Flatness: TypeAlias = Literal["paper", "board", "flat"] | str | float
_Cull: TypeAlias = Literal["auto", "off"] | float
_Frame: TypeAlias = Literal["camera", "plane"]

# What is projected

@final
class CheckerPattern:
    """The checkerboard for calibration, centred on the projector's panel.

    Parameters
    ----------
    projector : (int, int)
        Width and height of the projector's panel, px: its native resolution.
    squares : (int, int), default (11, 8)
        Columns and rows of squares. Their sum must be odd, so that the board turned by 180° differs from itself.
    square_px : int, optional
        Side of a square, px; by default a sixteenth of the panel's height.
    first_square : {"black", "white"}, default "black"
        The colour of the top-left square.
    background : {"black", "white"}, default "white"
        The colour around the board.
    marks : bool, default False
        Whether to draw small marks at the corners of the panel and at the middles of its sides. Where they or the border of
        the light are seen on the sheet, `calibrate` tests whether the picture was shown full screen, unscaled and not mirrored.

    Raises
    ------
    Error
        When the sum is even, the board does not fit on the panel, or it leaves no room for marks.

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
        marks: bool = False,
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
    @property
    def marks(self) -> NDArray[np.float64] | None:
        """Middles of the marks at the border of the panel: (N, 2) float64, projector px; None without marks."""
    def corners(self) -> NDArray[np.float64]:
        """The corners between four squares, row by row.

        Returns
        -------
        ndarray
            (N, 2) float64, projector px.
        """
    def mirrored(self) -> CheckerPattern:
        """The same picture with left and right exchanged, as a pattern of its own: where it lies on the panel of a projector that shows
        pictures mirrored.

        Returns
        -------
        CheckerPattern
        """
    def image(self) -> NDArray[np.uint8]:
        """The picture to project. Show it full screen, without scaling.

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
        """Reads a pattern file; see `slcal.load_pattern` for files of any kind."""
    def to_json(self) -> str:
        """The content of the pattern file."""
    @staticmethod
    def from_json(text: str) -> CheckerPattern:
        """The pattern that `to_json` wrote."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class StripePattern:
    """Coloured slits in a De Bruijn sequence: every window of `order` neighbouring slits is unique.

    Parameters
    ----------
    projector : (int, int)
        Width and height of the projector's panel, px: its native resolution.
    hues : int, default 4
        Colours.
    order : int, default 3
        Length of the unique windows.
    slits : int, optional
        Number of slits; by default hues to the power of order.
    axis : {"columns", "rows"}, default "columns"
        "columns" for vertical slits, whose positions are columns of the panel; "rows" for horizontal ones.

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
        """A pattern of slits that another program draws.

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
            Length of the unique windows of the sequence.

        Raises
        ------
        Error
            When slits overlap or leave the panel, or no window is unique.
        """
    @property
    def projector(self) -> tuple[int, int]:
        """Width and height of the panel, px."""
    @property
    def axis(self) -> Literal["columns", "rows"]:
        """"columns" for vertical slits, whose positions are columns of the panel; "rows" for horizontal ones."""
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
        """Length of the unique windows of the sequence."""
    def mirrored(self) -> StripePattern:
        """The same picture with left and right exchanged, as a pattern of its own: where it lies on the panel of a projector that shows
        pictures mirrored.

        Returns
        -------
        StripePattern
        """
    def image(self) -> NDArray[np.uint8]:
        """The picture to project. Show it full screen, without scaling.

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
        """Reads a pattern file; see `slcal.load_pattern` for files of any kind."""
    def to_json(self) -> str:
        """The content of the pattern file."""
    @staticmethod
    def from_json(text: str) -> StripePattern:
        """The pattern that `to_json` wrote."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class SequencePattern:
    """Pictures that are shown one after another: Gray code, or Gray code and shifted sinusoids.

    Parameters
    ----------
    projector : (int, int)
        Width and height of the projector's panel, px: its native resolution.
    kind : {"gray", "phase"}, default "gray"
        "gray" for Gray code alone; "phase" for as much of it as tells the periods of a sinusoid apart, and the sinusoid's shifts.
    axis : {"columns", "rows", "both"}, default "columns"
        What is coded.
    period : float, default 16
        Period of the sinusoid, px; only with "phase".
    steps : int, default 8
        Shifts of the sinusoid within its period; only with "phase". From 5 on an unknown gamma does not matter.
    bits : int, optional
        Bits of the Gray code, the most significant ones; by default all, or with a sinusoid one more than tell its periods apart.
    preset : {"opencv-gray", "slstudio-gray"}, optional
        The pictures of OpenCV's GrayCodePattern or of SLStudio in their order, instead; only with "gray" and without `axis`.

    Raises
    ------
    Error
        When an option is out of range, or options contradict each other.

    Examples
    --------
    >>> sequence = slcal.SequencePattern(projector=(1024, 768), kind="phase")
    >>> sequence
    SequencePattern(projector=(1024, 768), frames=24)
    >>> sequence.frames[2]
    {'axis': 'columns', 'bit': 6, 'file': 'frame_002.png', 'inverted': False, 'is': 'bit'}
    >>> sequence.image(2).shape
    (768, 1024)
    """

    def __new__(
        cls,
        projector: tuple[int, int],
        kind: Literal["gray", "phase"] = "gray",
        axis: Literal["columns", "rows", "both"] = "columns",
        period: float = 16.0,
        steps: int = 8,
        bits: int | None = None,
        preset: Literal["opencv-gray", "slstudio-gray"] | None = None,
    ) -> SequencePattern: ...
    @property
    def projector(self) -> tuple[int, int]:
        """Width and height of the panel, px."""
    @property
    def frames(self) -> list[dict[str, Any]]:
        """What each picture shows, in the order in which they are shown, as the pattern file has it: a dictionary with "is", which is
        "white", "black", "bit" (with "axis", "bit" and "inverted") or "sinusoid" (with "axis", "period_px", "step" and "of"), and
        "file" where it is known.
        """
    def image(self, frame: int) -> NDArray[np.uint8]:
        """A picture to project. Show it full screen, without scaling.

        Parameters
        ----------
        frame : int
            Which picture, from 0.

        Returns
        -------
        ndarray
            (H, W) uint8.
        """
    def save(self, file: _File) -> None:
        """Writes the pattern file (schema slcal-pattern/1).

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _File) -> SequencePattern:
        """Reads a pattern file; see `slcal.load_pattern` for files of any kind."""
    def to_json(self) -> str:
        """The content of the pattern file."""
    @staticmethod
    def from_json(text: str) -> SequencePattern:
        """The pattern that `to_json` wrote, or another program."""
    def _frame_order(self, names: Sequence[str], folder: str) -> list[int]: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

def load_pattern(file: _File) -> CheckerPattern | StripePattern | SequencePattern:
    """Reads a pattern file of any kind.

    Parameters
    ----------
    file : path or file object
        The JSON file (schema slcal-pattern/1) that `save` or ``slcal pattern`` wrote.

    Returns
    -------
    CheckerPattern, StripePattern or SequencePattern

    Raises
    ------
    OSError
        When the file cannot be read.
    FormatError
        When it does not follow its schema; the message names the field.
    """
def read_image(file: _Path | IO[bytes], *, as_stored: bool = False) -> _Image:
    """Reads a photograph: PNG, JPEG, TIFF, WebP or BMP, 8 or 16 bit, turned upright as its EXIF orientation asks.

    HEIC and AVIF are read, too, where pillow-heif is installed: ``pip install slcal[heif]``.

    Parameters
    ----------
    file : path or binary file object
        The photograph.
    as_stored : bool, default False
        Take the samples as they are in the file, for `gamma` of what follows. By default samples that the file says to be
        coded otherwise than sRGB (gAMA or cICP of a PNG, the curve of a colour profile) are converted to sRGB with 16
        bit, with a UserWarning.

    Returns
    -------
    ndarray
        (H, W, 3) in RGB order, or (H, W) for a grey one; uint8 or uint16. An alpha channel is left out.

    Raises
    ------
    OSError
        When the file cannot be read.
    FormatError
        When it is not such a picture, or is incomplete; the message says how to convert it.
    """

def read_tags(file: _Path | IO[bytes]) -> PhotoTags | None:
    """Reads the EXIF tags of a photograph, for `calibrate(tags=...)`.

    Parameters
    ----------
    file : path or binary file object
        The photograph: JPEG, PNG, TIFF, WebP or HEIC.

    Returns
    -------
    PhotoTags or None
        None where it has no tags that can be read.

    Raises
    ------
    OSError
        When the file cannot be read.
    """

@final
class PhotoTags:
    """What a camera wrote into a photograph (EXIF), for `calibrate`. Nothing is checked: programs that edit photographs leave
    tags that are no longer true.

    Parameters
    ----------
    make, model : str, optional
        The camera.
    focal_mm : float, optional
        FocalLength: the lens's own focal length, mm.
    focal_35mm : float, optional
        FocalLengthIn35mmFilm, mm.
    focal_plane_x_resolution : float, optional
        FocalPlaneXResolution: pixels of the whole picture per unit.
    focal_plane_unit : int, optional
        FocalPlaneResolutionUnit: 2 inches (default), 3 centimetres, 4 millimetres, 5 micrometres.
    pixels : (int, int), optional
        PixelXDimension and PixelYDimension: the size of the picture as the camera stored it.
    digital_zoom : float, optional
        DigitalZoomRatio; 0 and 1 stand for none.
    orientation : int
        Orientation, 1 to 8, by which the pixels were turned upright.

    Examples
    --------
    >>> tags = slcal.PhotoTags(model="Canon PowerShot G10", focal_mm=6.1)
    >>> tags.focal((4416, 3312))["source"]
    'sensor-table'
    """

    def __new__(
        cls,
        *,
        make: str | None = None,
        model: str | None = None,
        focal_mm: float | None = None,
        focal_35mm: float | None = None,
        focal_plane_x_resolution: float | None = None,
        focal_plane_unit: int | None = None,
        pixels: tuple[int, int] | None = None,
        digital_zoom: float | None = None,
        orientation: int = 1,
    ) -> PhotoTags: ...
    @property
    def make(self) -> str | _MaybeNone:
        """The maker of the camera."""
    @property
    def model(self) -> str | _MaybeNone:
        """The camera."""
    @property
    def focal_mm(self) -> float | _MaybeNone:
        """The lens's own focal length, mm."""
    @property
    def focal_35mm(self) -> float | _MaybeNone:
        """Its equivalent on 35 mm film, mm."""
    @property
    def focal_plane_x_resolution(self) -> float | _MaybeNone:
        """Pixels of the whole picture per unit of the focal plane."""
    @property
    def focal_plane_unit(self) -> int | _MaybeNone:
        """That unit: 2 inches, 3 centimetres, 4 millimetres, 5 micrometres."""
    @property
    def pixels(self) -> tuple[int, int] | _MaybeNone:
        """Width and height of the picture as the camera stored it."""
    @property
    def digital_zoom(self) -> float | _MaybeNone:
        """The digital zoom; 0 and 1 stand for none."""
    @property
    def orientation(self) -> int:
        """How the pixels were turned upright, 1 to 8."""
    def focal(self, size: tuple[int, int]) -> dict[str, Any]:
        """The focal length that the tags state for an uncropped photograph.

        Parameters
        ----------
        size : (int, int)
            Width and height of the photograph, px.

        Returns
        -------
        dict
            "focal_px"; "sigma_share", its relative 1σ; "mm", the focal length of the tag that was used; "source":
            "equivalent", "focal-plane" or "sensor-table".

        Raises
        ------
        Error
            When the tags state none that is plausible, or the photograph was cropped or zoomed digitally.
        """
    def __eq__(self, other: object, /) -> bool: ...

# What a photograph of the sheet shows

@final
class SheetDetection:
    """The sheet in a photograph: points on its sides, and the corners where the sides meet."""

    @property
    def corners(self) -> NDArray[np.float64] | _MaybeNone:
        """Corners TL, TR, BR, BL: (4, 2) float64, px; intersections of straight lines through the sides, in a distorted
        photograph as accurate as the sides are straight. None where neighbouring sides are parallel.
        """
    @property
    def edges(self) -> dict[str, NDArray[np.float64]]:
        """Points on "top", "right", "bottom" and "left": (N, 2) float64, px; empty where corners given by hand are used
        unchanged.
        """
    @property
    def edge_sigma_px(self) -> dict[str, NDArray[np.float64]]:
        """1σ of these points across their sides: (N,) float64, px. With it they may be treated as independent."""
    @property
    def corner_sigma_px(self) -> float | None:
        """1σ of corners given by hand that are used unchanged, px; None where the sides were measured."""
    @property
    def notes(self) -> list[str]:
        """Notes for the user, such as corners that were given by hand or parts of a side that are covered."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class CornerDetection:
    """The corners of the pattern that were found."""

    @property
    def camera_px(self) -> NDArray[np.float64]:
        """Their positions in the photograph: (N, 2) float64, px, row by row of the pattern."""
    @property
    def projector_px(self) -> NDArray[np.float64]:
        """Their positions on the projector's panel: (N, 2) float64, px, exact."""
    @property
    def sigma_px(self) -> NDArray[np.float64]:
        """1σ of each camera coordinate: (N,) float64, px."""
    @property
    def expected(self) -> int:
        """Number of corners of the whole pattern."""
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
        """The corners of the pattern that were found on the sheet; none without a pattern."""
    @property
    def view(self) -> ViewObservation:
        """Sheet and corners as an observation for calibration."""
    @property
    def notes(self) -> list[str]:
        """Notes for the user: corners that were not found or lie outside the sheet, corners that were given by hand, sides of
        the sheet that are covered in part, or that show the side face of a board.
        """
    @property
    def clipped_percent(self) -> float:
        """How much of the lit sheet is overexposed, per cent."""
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
    size_mm : (float, float) or str
        Width and height of the sheet, mm, or a text such as "A4", "A2-landscape" or "594x420mm". The width is that of the sides
        closest to the image's x axis. The name of a paper alone is tried both ways round, and the one that fits is taken.
    pattern : CheckerPattern, optional
        The projected pattern. Without it the brightest large quadrilateral with straight sides is taken for the sheet.
    plain : ndarray, optional
        A photograph of the same pose and size without the pattern: projector dark or plain white. The sheet's sides are then
        measured in it.
    corners : array_like, optional
        (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when the sheet is not found. They may lie outside the image;
        where the sides are visible they are still measured.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photograph.
    screen : ndarray, optional
        The older name of `plain`.

    Returns
    -------
    Detection
        `sheet`, `corners`, and both as the `view` that calibration takes.

    Raises
    ------
    DetectionError
        When sheet or pattern is not found; `seen` says what was found instead and `advice` what to do.
    Error
        When photographs differ in size, or the corners are not a convex quadrilateral in this order.
    TypeError
        When a photograph is not such an array.

    See Also
    --------
    observe : the same for photographs of several poses.

    Examples
    --------
    A drawing of a sheet in front of a dark wall:

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
    """Finds only the sheet, of any size: the brightest large quadrilateral with straight sides.

    Parameters
    ----------
    photo : ndarray
        (H, W, 3) RGB or (H, W), uint8 or uint16: the sheet, with the projector dark or plain white. `detect` can tell the
        pattern's edges from those of the sheet.
    corners : array_like, optional
        (4, 2), px: its corners TL, TR, BR, BL by hand, when the sheet is not found. They may lie outside the image; where
        the sides are visible they are still measured.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photograph.

    Returns
    -------
    SheetDetection

    Raises
    ------
    DetectionError
        When no sheet is found; `seen` says what was found instead and `advice` what to do.
    Error
        When the corners are not a convex quadrilateral in this order.
    TypeError
        When the photograph is not such an array.

    Examples
    --------
    >>> photo = np.full((480, 640), 30, np.uint8)
    >>> photo[100:380, 120:520] = 220
    >>> sheet = slcal.detect_sheet(photo)
    >>> float(sheet.edges["top"][:, 1].mean().round(1))
    99.5
    """
def detect_corners(photo: _ImageLike, pattern: CheckerPattern, *, gamma: _Gamma = "srgb") -> CornerDetection:
    """Finds only the corners of the projected checkerboard, on the sheet or outside it.

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
        When the checkerboard is not found; `seen` says what was found instead and `advice` what to do.
    TypeError
        When the photograph is not such an array.

    Examples
    --------
    The projected picture itself, as a photograph:

    >>> checker = slcal.CheckerPattern(projector=(1024, 768))
    >>> corners = slcal.detect_corners(checker.image(), checker)
    >>> len(corners), corners.expected
    (70, 70)
    >>> bool(np.abs(corners.camera_px - corners.projector_px).max() < 0.01)
    True
    """

@final
class ViewObservation:
    """The observations of one pose of the sheet, by any detector: its corners or points on its sides, and the projected
    points.

    Parameters
    ----------
    size_mm : (float, float) or str
        Width and height of the sheet, mm, or a text such as "A2-landscape" or "594x420mm". The width is that of the sides
        closest to the image's x axis; the name of a paper alone is upright.
    sheet_corners : array_like, optional
        (4, 2), px: the corners TL, TR, BR, BL in the photograph. They may lie outside the image.
    sheet_edges : mapping, optional
        Points on the sides instead: (N, 2), px, for each of "top", "right", "bottom" and "left"; or (N, 3) with the 1σ of each
        point across its side, px.
    pairs : array_like, optional
        (N, 4), px: camera x, camera y, projector x, projector y of each point of the pattern; or (N, 5) with the 1σ of the
        camera's coordinates. None without a pattern.
    sheet_sigma_px : float or mapping, optional
        1σ of the corners or of the points on the sides, px. A mapping has it for each side, (N,) or one for all. By default
        it is estimated from the residuals.
    pair_sigma_px : array_like, optional
        1σ of the camera's coordinates of the pairs, px: (N,) or one for all. By default it is estimated from the residuals.
    panel_points : array_like, optional
        (N, 5), px: camera x, camera y, panel x, panel y and 1σ of points whose place on the panel is known, as the property
        `panel_points` has them.
    channel_offsets : array_like, optional
        (N, 10), px: how red and blue are displaced against green at corners of the pattern, as the property `channel_offsets` has
        them.
    photo : str, optional
        Name of the photograph.

    Raises
    ------
    Error
        When neither or both of corners and edges are given, when a shape is wrong, a number is not finite, or a σ is not
        positive.
    TypeError
        When something is not an array of real numbers.

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
        panel_points: ArrayLike | None = None,
        channel_offsets: ArrayLike | None = None,
        photo: str | None = None,
    ) -> ViewObservation: ...
    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the sheet, mm."""
    @property
    def sheet_corners(self) -> NDArray[np.float64] | None:
        """Its corners TL, TR, BR, BL: (4, 2) float64, px; None when there are points on its sides instead."""
    @property
    def sheet_edges(self) -> dict[str, NDArray[np.float64]] | None:
        """Points on its sides: (N, 2) float64, px, for "top", "right", "bottom", "left"; None when there are corners instead."""
    @property
    def sheet_sigma_px(self) -> float | dict[str, NDArray[np.float64]] | None:
        """1σ of the corners, px, or of the points on each side, (N,) float64; None where it was not given."""
    @property
    def pairs(self) -> NDArray[np.float64]:
        """Camera x, camera y, projector x, projector y of each point of the pattern: (N, 4) float64, px."""
    @property
    def pair_sigma_px(self) -> NDArray[np.float64] | None:
        """1σ of the camera's coordinates of the pairs: (N,) float64, px; None where it was not given."""
    @property
    def panel_points(self) -> NDArray[np.float64]:
        """Camera x, camera y, panel x, panel y and 1σ of points on the border of the projector's light and of marks: (N, 5)
        float64, px. NaN stands for the coordinate along a border, and for a σ that was not given. They test whether the picture was shown pixel for pixel.
        """
    @property
    def channel_offsets(self) -> NDArray[np.float64]:
        """How red and blue are displaced against green at corners of the pattern: (N, 10) float64, px. Camera x and y, projector x and
        y, red x and y, blue x and y, 1σ of red and of blue. None are found in grey photographs.
        """
    @property
    def photo(self) -> str | None:
        """Name of the photograph, where it has one."""
    def __eq__(self, other: object, /) -> bool: ...

@final
class Observations:
    """The input of a calibration.

    Parameters
    ----------
    camera : (int, int)
        Width and height of the camera's image, px.
    projector : (int, int) or None
        Width and height of the projector's panel, px; None to calibrate the camera alone.
    views : iterable of ViewObservation or Detection
        One for each pose of the sheet.
    mirrored : bool, default False
        Whether the projector's pictures appear mirrored. The projector px of the views are then those of the panel, as
        `pattern.mirrored()` has them.

    Raises
    ------
    Error
        When a size is not two whole numbers above zero.
    TypeError
        When a view is not one of these.

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
        *,
        mirrored: bool = False,
    ) -> Observations: ...
    @property
    def camera(self) -> tuple[int, int]:
        """Width and height of the camera's image, px."""
    @property
    def projector(self) -> tuple[int, int] | None:
        """Width and height of the projector's panel, px; None for the camera alone."""
    @property
    def mirrored(self) -> bool:
        """Whether the projector's pictures appear mirrored: see `Rig.mirrored`."""
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
    tags: Sequence[PhotoTags | None] | None = None,
    mirror: bool = False,
    screen: Sequence[_ImageLike] | None = None,
) -> Observations:
    """Finds sheet and pattern in photographs of several poses: the first step of `calibrate`.

    Parameters
    ----------
    photos : sequence of ndarray, or ndarray
        (H, W, 3) RGB or (H, W), uint8 or uint16, all of one size: the sheet with the pattern projected on it, one for each
        pose.
    size_mm : (float, float) or str
        Width and height of the sheet, mm, or a text such as "A4", "A2-landscape" or "594x420mm". The width is that of the sides
        closest to the image's x axis. The name of a paper alone is tried both ways round, and the one that fits is taken.
    pattern : CheckerPattern, optional
        The projected pattern. Without it only the camera is calibrated.
    plain : sequence of ndarray, optional
        Photographs of the same poses without the pattern, in the same order: projector dark or plain white. The sheet's sides
        are then measured in them.
    corners : array_like or sequence of array_like, optional
        (4, 2), px, for one photograph, or one such array or None for each: the sheet's corners TL, TR, BR, BL by hand,
        where the sheet is not found. They may lie outside the image.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the photographs.
    mirror : bool, default False
        Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
        counts as width - 1 - c.
    names : sequence of str, optional
        Names of the photographs.
    tags : sequence of PhotoTags or None, optional
        What the camera wrote into each photograph: see `calibrate`.
    screen : sequence of ndarray, optional
        The older name of `plain`.

    Returns
    -------
    Observations

    Raises
    ------
    DetectionError
        When sheet or pattern is not found; the message says in which photograph, what was found instead and what to do.
    Error
        When photographs differ in size, or lists in length.
    TypeError
        When a photograph is not such an array.
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
    projector_pixel_aspect: Literal["auto", "square"] | float = "auto",
    flatness: _Flatness = "paper",
    method: Literal["ml", "two-vp"] = "ml",
    focal_35mm: float | None = None,
    gamma: _Gamma = "srgb",
    allow_degenerate: bool = False,
    names: Sequence[str] | None = None,
    tags: Sequence[PhotoTags | None] | None = None,
    exif: bool = False,
    mirror: bool = False,
    screen: Sequence[_ImageLike] | None = None,
) -> Rig:
    """Calibrates a camera and a projector from photographs of one white sheet with a checkerboard projected on it.

    Parameters
    ----------
    photos : sequence of ndarray, or ndarray
        One photograph per pose of the sheet: (H, W, 3) in RGB order or (H, W), uint8 or uint16, all of one size. One
        photograph of a tilted sheet is enough; two with opposite tilts are far better.
    size_mm : (float, float) or str
        Width and height of the sheet, mm, or a text such as "A4", "A2-landscape" or "594x420mm". The width is that of the sides
        closest to the image's x axis. The name of a paper alone is tried both ways round, and the one that fits is taken.
    pattern : CheckerPattern, optional
        The projected pattern. Without it only the camera is calibrated.
    plain : sequence of ndarray, optional
        Photographs of the same poses without the pattern, in the same order: projector dark or plain white. The sheet's sides
        are then measured in them.
    corners : array_like, optional
        The sheet's corners TL, TR, BR, BL by hand, where the sheet is not found: (4, 2), px, for one photograph, or one
        such array for each. They may lie outside the image.
    camera : Camera, optional
        Known intrinsics: they are held fixed, and the rest is estimated.
    camera_pp, projector_pp : {"prior", "shift", "centre", "free"} or (float, float)
        What is known of the principal points. "prior": near the centre. "shift": its column near the centre, its row free
        (lens shift). "centre": exactly the centre. "free": nothing. Two numbers: exactly this pixel.
    distortion, projector_distortion : {"auto", "none", "k1", "k1k2", "full"}
        Which coefficients are estimated. "auto" estimates all five, and the ratio of fy to fx, near what ordinary lenses have.
        The others take square pixels; those of the projector need three photographs.
    projector_pixel_aspect : {"auto", "square"} or float
        Width of a pixel of the projector over its height. "auto": 2 for the diamond pixels of 912×1140 and 608×684, else 1.
    flatness : {"paper", "board", "flat"}, str or float
        How flat the sheet is. "paper" bends out of its plane by 0.2 % of its diagonal (1σ), "board" by 0.02 %, "flat" not at
        all. A length such as "0.5mm", or a number of millimetres, is 1σ itself. The bend is estimated: see `View.bend`.
    method : {"ml", "two-vp"}
        Maximum likelihood, or the method of two vanishing points of R. Orghidan et al., "Structured light self-calibration
        with vanishing points", Machine Vision and Applications 25:489-500 (2014).
    focal_35mm : float, optional
        The camera's focal length as its 35 mm equivalent, as EXIF tags state it. It is a prior with a σ of about 5 %.
    gamma : {"srgb", "linear"} or float
        The transfer curve of the photographs.
    mirror : bool, default False
        Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
        counts as width - 1 - c.
    allow_degenerate : bool
        Return a rig with the verdict "degenerate" instead of raising an error.
    names : sequence of str, optional
        Names of the photographs, for the rig's views and for messages.
    tags : sequence of PhotoTags or None, optional
        What the camera wrote into each photograph: `slcal.read_tags(file)`. The pixels are expected upright, as `read_image`
        gives them. A crop and a focal length that contradicts the result are warned of; photographs whose orientation differs
        are turned alike where they fit together only so.
    exif : bool
        Use the focal length in `tags` as a prior, as `focal_35mm` is one.
    screen : sequence of ndarray, optional
        The older name of `plain`.

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
        When a value or a shape is invalid.
    TypeError
        When a photograph is not an array of uint8 or uint16.

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
    projector_pixel_aspect: Literal["auto", "square"] | float = "auto",
    flatness: _Flatness = "paper",
    method: Literal["ml", "two-vp"] = "ml",
    focal_35mm: float | None = None,
    allow_degenerate: bool = False,
) -> Rig:
    """Calibrates from observations: those of `slcal.observe`, or of any other detector.

    Parameters
    ----------
    observations : Observations or mapping
        A mapping has the fields of the file (schema slcal-observations/1), with arrays or lists. A σ that is not given is
        estimated from the residuals, or assumed where there are too few.
    camera, camera_pp, projector_pp, distortion, projector_distortion, projector_pixel_aspect, flatness, method, focal_35mm, allow_degenerate
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
        When numbers are not finite, corners are collinear, or values contradict each other.
    """

@final
class Camera:
    """A camera or a projector: a pinhole model with distortion that maps points onto pixels, as in OpenCV.

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
        When K is not a camera matrix, or a number is not finite.

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
            A YAML or XML file of OpenCV, a camera_info of ROS, or a rig's JSON file, whose camera is taken. It must state
            the size of the image.

        Returns
        -------
        Camera
        """
    @staticmethod
    def from_fov(size: tuple[int, int], fov_deg: float) -> Camera:
        """A camera without distortion, from its horizontal angle of view.

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
        """A camera without distortion, from the 35 mm equivalent of its focal length, as EXIF tags state it."""
    @staticmethod
    def from_throw(size: tuple[int, int], throw: float) -> Camera:
        """A projector, from its throw ratio (distance over width of the picture). Its principal point is on the lower edge of
        the panel, as with most lens shifts.
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
        """1σ of the parameters, zero for those that were held fixed; None where it is not known."""
    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Projects points onto pixels, as ``cv2.projectPoints`` without rotation and translation.

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
            When a point lies behind the camera, or outside the range of the distortion model.
        """
    def undistort(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Normalised image coordinates of pixels, without distortion: ``cv2.undistortPoints``, iterated until it converges.

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
            When a pixel lies outside the range of the distortion model.
        """
    def rays(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Viewing directions of pixels: unit vectors (N, 3) float64, from (N, 2) px."""
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
        When R is not a rotation, or a number is not finite.

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
        """The inverse: X_b = Rᵀ · X_a − Rᵀ · t. It has no σ."""
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
    def bend(self) -> ViewBend | _MaybeNone:
        """How the sheet bends out of its mean plane; None where it was taken for flat."""
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
    @property
    def clipped_percent(self) -> float | _MaybeNone:
        """How much of the lit sheet is overexposed in the photograph, per cent; None where nothing is, or it was not measured."""
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
    """The position of a picture on the projector's panel and on the sheet, where it appears without keystone distortion."""

    @property
    def panel_from_source(self) -> NDArray[np.float64]:
        """(3, 3) float64: the homography from pixels of the source to pixels of the panel, without lens distortion; `map`
        includes the distortion.
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
            When a point lies at infinity on the panel.
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
    """A calibrated camera, and a projector if there was a pattern, with their uncertainty.

    `slcal.calibrate` returns rigs. The constructor makes one from devices that are known otherwise.

    Parameters
    ----------
    camera : Camera
        The camera.
    projector : Camera, optional
        The projector, modelled as a camera.
    projector_from_camera : Pose, optional
        X_projector = R · X_camera + t, mm; given exactly when the projector is.
    method : str, default "external"
        How the rig was made, in one word.
    mirrored : bool, default False
        Whether the projector's pictures appear mirrored, left and right exchanged.

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
        mirrored: bool = False,
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
        """How it was made: "ml", "two-vp", or another word for rigs from other programs."""
    @property
    def quality(self) -> Quality | _MaybeNone:
        """Verdict, expected accuracy and warnings; None for rigs from other programs that have none."""
    @property
    def covariance(self) -> Covariance | _MaybeNone:
        """Covariance of all estimated parameters; None for rigs from other programs."""
    @property
    def channel_registration(self) -> ChannelRegistration | _MaybeNone:
        """How red and blue are displaced against green in projector and camera; None where it is not known, as in rigs that
        were calibrated from grey photographs.
        """
    @property
    def report(self) -> CalibrationReport | _MaybeNone:
        """Iterations and inliers of the calibration; None for a rig that was not calibrated in this program."""
    @property
    def mirrored(self) -> bool:
        """Whether the projector's pictures appear mirrored, left and right exchanged, as in rear projection: column c of a picture counts
        as column width - 1 - c of the panel.
        """
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
        """Reads a rig file.

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
        """The rig as parameters of OpenCV's functions.

        Returns
        -------
        dict
            `camera_K` (3, 3), `camera_dist` (5,), `camera_size` (2,), the same of the projector, and `R` (3, 3) and `t` (3, 1) with
            X_projector = R · X_camera + t, mm: what ``cv2.stereoRectify`` calls R and T. The entries of a projector are
            there only if there is one.

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
        """A rig from parameters of OpenCV's functions.

        Parameters
        ----------
        parameters : mapping, optional
            What `to_opencv` returns; or the same as keyword arguments.
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
            When something is missing or invalid.
        """
    def save_report(
        self,
        file: _File,
        *,
        photos: Sequence[_ImageLike] | _ImageLike | None = None,
        observations: Observations | Mapping[str, Any] | None = None,
        cloud: PointCloud | None = None,
    ) -> None:
        """Writes an HTML page about the calibration: how good it is, why, and what to do next. It needs no network.

        Parameters
        ----------
        file : path or file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        photos : sequence of ndarray, or ndarray, optional
            The photographs that the rig was calibrated from, one for each of its views.
        observations : Observations or mapping, optional
            The observations in them (`slcal.observe`): sides, corners and residuals are drawn. A σ that is not given is
            estimated from the residuals.
        cloud : PointCloud, optional
            Points to show together with the devices.

        Raises
        ------
        Error
            When photographs or observations do not fit the rig: a different number of views, or other sizes.
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
            The output; existing files are replaced. For "opencv" it ends in .yml, .yaml, .xml or .json; for "ros" it is the
            camera's .yaml, the projector's goes beside it as NAME_projector.yaml, or a folder; for "colmap" a folder; for
            "kalibr" a .yaml, for "blender" a .py, for "npz" an .npz.
        to : {"opencv", "ros", "colmap", "kalibr", "blender", "npz"}
            The format.
        lossy : bool, default False
            Whether distortion terms that the format does not have are left out; otherwise they are an error.

        Returns
        -------
        list of str
            What the format cannot hold, one line each.

        Raises
        ------
        Error
            When the format cannot hold a lens (the message says how far pixels would move), or the path does not suit it.
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
            The format; by default it is recognised by the content.
        camera_size, projector_size : (int, int), optional
            Width and height, px, for files that do not state them.

        Returns
        -------
        Rig

        Raises
        ------
        FormatError
            When the files are of another format, or something is missing in them.
        Error
            When the size of an image is not known.
        OSError
            When a file cannot be read.
        """
    @overload
    def reconstruct(
        self,
        image: _Frames,
        pattern: SequencePattern,
        *,
        frame: _Frame = "camera",
        mesh: bool = False,
        cull: _Cull = "auto",
        near: float | None = None,
        far: float | None = None,
        mirror: bool = False,
    ) -> PointCloud:
        """Reconstructs the cloud of one photograph of a scene under the stripes, or of the photographs of a sequence. For many photographs
        of stripes use `Reconstructor`.

        Parameters
        ----------
        image : ndarray, or iterable of ndarrays and paths
            (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected. Of a sequence
            its photographs in the order of the pattern, as `slcal.decode` takes them.
        pattern : StripePattern or SequencePattern
            What was projected, drawn for the rig's projector. With a sequence, `black`, `white`, `gamma` and `min_confidence` are
            not allowed.
        black, white : ndarray, optional
            The same scene with the projector dark (ambient light is subtracted) and plain white (surface colours are
            divided out).
        gamma : {"srgb", "linear"} or float, default "srgb"
            The transfer curve of the image.
        frame : {"camera", "plane"}, default "camera"
            The coordinate frame of the cloud: the camera's, or that of the sheet in the rig's first view.
        mesh : bool, default False
            Whether the cloud keeps the triangles between its points.
        cull : {"auto", "off"} or float, default "auto"
            Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
            removed.
        min_confidence : float, default 0.4
            Matches with a lower confidence are rejected, 0 to 1.
        near, far : float, optional
            Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.
        mirror : bool, default False
            Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
            counts as width - 1 - c.
            A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.

        Returns
        -------
        PointCloud
            Its `report` counts what was found, rejected and removed. A cloud of a sequence has a point per pixel, and `normals`.

        Raises
        ------
        TypeError
            When the image is not an array of uint8 or uint16.
        Error
            When its shape or size is wrong, a sequence has another number of frames than its pattern, the rig has no projector (or, for "plane", no view), the pattern is for another
            panel, or an option is out of range.
        DecodeError
            When the stripes are not found, or cannot be those of this rig. The message says so when they are found with red
            and blue swapped.

        Examples
        --------
        >>> from slcal import simulate
        >>> scene = simulate.scene("sphere")
        >>> cloud = scene.rig.reconstruct(scene.photo, scene.pattern)
        >>> cloud.points.shape == (len(cloud), 3)
        True
        """
    @overload
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
        mirror: bool = False,
    ) -> PointCloud:
        """Reconstructs the cloud of one photograph of a scene under the stripes, or of the photographs of a sequence. For many photographs
        of stripes use `Reconstructor`.

        Parameters
        ----------
        image : ndarray, or iterable of ndarrays and paths
            (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected. Of a sequence
            its photographs in the order of the pattern, as `slcal.decode` takes them.
        pattern : StripePattern or SequencePattern
            What was projected, drawn for the rig's projector. With a sequence, `black`, `white`, `gamma` and `min_confidence` are
            not allowed.
        black, white : ndarray, optional
            The same scene with the projector dark (ambient light is subtracted) and plain white (surface colours are
            divided out).
        gamma : {"srgb", "linear"} or float, default "srgb"
            The transfer curve of the image.
        frame : {"camera", "plane"}, default "camera"
            The coordinate frame of the cloud: the camera's, or that of the sheet in the rig's first view.
        mesh : bool, default False
            Whether the cloud keeps the triangles between its points.
        cull : {"auto", "off"} or float, default "auto"
            Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
            removed.
        min_confidence : float, default 0.4
            Matches with a lower confidence are rejected, 0 to 1.
        near, far : float, optional
            Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.
        mirror : bool, default False
            Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
            counts as width - 1 - c.
            A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.

        Returns
        -------
        PointCloud
            Its `report` counts what was found, rejected and removed. A cloud of a sequence has a point per pixel, and `normals`.

        Raises
        ------
        TypeError
            When the image is not an array of uint8 or uint16.
        Error
            When its shape or size is wrong, a sequence has another number of frames than its pattern, the rig has no projector (or, for "plane", no view), the pattern is for another
            panel, or an option is out of range.
        DecodeError
            When the stripes are not found, or cannot be those of this rig. The message says so when they are found with red
            and blue swapped.

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
        pixels: Matches | DenseMatches | ArrayLike,
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
        """Triangulates points from camera pixels and their projector columns or rows, of any decoder.

        Parameters
        ----------
        pixels : Matches, DenseMatches or array_like
            Matches, those of every pixel, or (N, 2) camera px.
        columns, rows : array_like, optional
            (N,), projector px, NaN where it is not known. With an array of pixels, at least one of the two is needed.
        sigma_px : array_like, optional
            (N,) or one for all: 1σ of the camera position across the stripe, px. By default that of the matches, or 0.1. Dense
            matches have their own.
        frame : {"camera", "plane"}, default "camera"
            The coordinate frame of the cloud: the camera's, or that of the sheet in the rig's first view.
        mesh : bool, default False
            Whether the cloud keeps the triangles between its points.
        cull : {"auto", "off"} or float, default "off"
            Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
            removed. With "off" every valid match becomes a point, in the given order.
        near, far : float, optional
            Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.

        Returns
        -------
        PointCloud
            Its `report` counts the matches that gave no point: without coordinates ("invalid"), behind the devices, with a
            projector coordinate outside the panel, and so on.

        Raises
        ------
        TypeError
            When something is not an array of numbers.
        Error
            When shapes do not match, pixels are not finite, or the rig has no projector (or, for "plane", no view).
        DecodeError
            When no match gives a point.

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
        """Returns the picture to project so that `source` appears without keystone distortion and as large as possible on the
        sheet.

        Parameters
        ----------
        source : CheckerPattern or ndarray
            A checkerboard, drawn with sharp edges and half a square of its background around it, or any picture: (H, W, 3)
            RGB or (H, W), uint8 (uint16 is brought to 8 bits).
        view : int, default 0
            Which of the rig's views has the pose of the sheet.

        Returns
        -------
        ndarray
            (H, W, 3) uint8, as large as the projector's panel.

        Raises
        ------
        Error
            When the rig has no projector or no such view, or the pattern is for another panel.
        CalibrationError
            When the projector does not light the sheet.
        TypeError
            When the source is not one of these.
        """
    def rectification(self, source: CheckerPattern | _ImageLike, *, view: int = 0) -> Rectification:
        """The position of the picture that `rectify` draws: on the panel, and on the sheet in millimetres.

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
        mirror: bool = False,
        significance: float = 0.001,
    ) -> Verification:
        """Measures the keystone of a projected checkerboard on the sheet, and tests whether projector, camera or sheet have
        moved.

        Parameters
        ----------
        photo : ndarray
            (H, W, 3) RGB or (H, W), uint8 or uint16, by the rig's camera: the sheet with the pattern projected on it.
        pattern : CheckerPattern
            The projected pattern, as `rectify` draws it for the rig's first view unless `as_drawn`.
        size_mm : (float, float) or str, optional
            Size of the sheet, when it is not that of the rig's first view. The name of a paper alone is tried both ways round.
        as_drawn : bool, default False
            Whether the pattern is projected as it was drawn, not rectified. The sheet may then be anywhere.
        corners : array_like, optional
            (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when it is not found.
        gamma : {"srgb", "linear"} or float, default "srgb"
            The transfer curve of the photograph.
        mirror : bool, default False
            Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
            counts as width - 1 - c.
            A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.
        significance : float, default 0.001
            The false-alarm rate: the probability that an unmoved rig is reported as moved.

        Returns
        -------
        Verification
            `keystone` with its σ, `rig.moved` and what has changed, `sheet.moved`.

        Raises
        ------
        DetectionError
            When sheet or pattern is not found.
        CalibrationError
            When photograph and rig do not fit each other at all.
        Error
            When the photograph has another size, the pattern is for another panel, the rig has no projector, or it has no
            views and `as_drawn` and `size_mm` are not given.
        TypeError
            When the photograph is not such an array.
        """
    def advise(self, pattern: CheckerPattern | None = None) -> Advice:
        """Predicts what one more photograph would improve, and says which one to take.

        Parameters
        ----------
        pattern : CheckerPattern, optional
            The pattern that will be projected; by default the standard checkerboard for the rig's panel.

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
    flatness: _Flatness = "paper",
) -> Advice:
    """Plans the first photographs: how to hold the sheet, and the expected σ of the focal lengths against its tilt.

    Parameters
    ----------
    camera : Camera
        Approximate intrinsics: see `Camera.from_fov` and `Camera.from_35mm`.
    size_mm : (float, float) or str
        Width and height of the sheet, mm, or a text such as "A2-landscape" or "594x420mm".
    projector : Camera, optional
        Approximate intrinsics: see `Camera.from_throw`. Without a projector the plan is for the camera alone. The projector
        is assumed to stand to the right of the camera, at a quarter of the distance.
    distance_mm : float, optional
        Distance from the camera to the sheet's centre. By default the sheet fills 60 % of the image.
    noise_px : float, default 0.05
        1σ of a corner of the sheet and of the pattern in the photograph, px.
    camera_pp : {"prior", "centre", "free", "shift"} or (float, float), default "prior"
        What will be known of the camera's principal point.
    projector_pp : {"shift", "prior", "centre", "free"} or (float, float), default "shift"
        What will be known of the projector's.
    distortion : {"auto", "none", "k1", "k1k2", "full"}, default "auto"
        Which distortion of the camera will be estimated, as for `calibrate`.
    flatness : {"paper", "board", "flat"}, str or float, default "paper"
        How flat the sheet is, as for `calibrate`.

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
    """Correspondences: which projector column or row illuminates which camera pixel.

    `slcal.decode` returns them; they can also be made from the arrays of another decoder. Two of them are equal when their
    numbers are; the report is not compared.

    Parameters
    ----------
    pixels : array_like
        (N, 2), camera px: x right, y down, the centre of the first pixel at (0, 0).
    columns, rows : array_like, optional
        (N,), projector px; NaN where it is not known. At least one of the two is needed.
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
        When shapes do not match, pixels are not finite, or a number is out of range.
    TypeError
        When something is not an array of numbers.

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
        """Confidence of the matches: (N,) float64, 0 to 1."""
    @property
    def sigma_px(self) -> NDArray[np.float64]:
        """1σ of the camera positions across the stripe: (N,) float64, px."""
    @property
    def colors(self) -> NDArray[np.uint8]:
        """Colours of the photograph there: (N, 3) uint8, sRGB."""
    @property
    def report(self) -> DecodeReport | _MaybeNone:
        """Counts and measurements of decoding; None for matches that were constructed or loaded."""
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
        """Reads matches from `save`, ``slcal decode`` or any other decoder.

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
            When it does not have this format; the message names the line.
        """
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class DenseMatches:
    """Which projector column and row illuminate each camera pixel.

    `slcal.decode` returns them for a sequence; they can also be made from the arrays of another decoder. The arrays are those of the
    object itself: they are not copied, and cannot be written to. Two of them are equal when their numbers are (NaN equals NaN); the
    report is not compared. The length is the number of pixels with a column, a row, or both.

    Parameters
    ----------
    column, row : array_like, optional
        (H, W), projector px; NaN where it is not known. At least one of the two is needed.
    sigma_column, sigma_row : array_like, optional
        (H, W) or one for all: 1σ of them, projector px; 0.1 unless given.
    confidence : array_like, optional
        (H, W) or one for all, 0 to 1; 1 unless given.
    color : ndarray, optional
        (H, W, 3) uint8, sRGB: the colour of each pixel under white light.

    Raises
    ------
    Error
        When shapes do not match, or a number is out of range.
    TypeError
        When something is not an array of numbers.

    Examples
    --------
    >>> matches = slcal.DenseMatches([[400, 401.5], [np.nan, 402]], sigma_column=0.02)
    >>> matches
    DenseMatches(2x2 px, 3 with columns)
    >>> len(matches), matches.row is None
    (3, True)
    >>> matches.column.dtype, matches.column.flags.writeable
    (dtype('float32'), False)
    """

    def __new__(
        cls,
        column: ArrayLike | None = None,
        row: ArrayLike | None = None,
        *,
        sigma_column: ArrayLike | None = None,
        sigma_row: ArrayLike | None = None,
        confidence: ArrayLike | None = None,
        color: NDArray[np.uint8] | None = None,
    ) -> DenseMatches: ...
    @property
    def column(self) -> NDArray[np.float32] | _MaybeNone:
        """Projector column of each pixel: (H, W) float32, px, NaN where there is none; None when columns are not coded."""
    @property
    def sigma_column(self) -> NDArray[np.float32] | _MaybeNone:
        """1σ of `column`: (H, W) float32, projector px, NaN where there is none; None when columns are not coded."""
    @property
    def row(self) -> NDArray[np.float32] | _MaybeNone:
        """Projector row of each pixel: (H, W) float32, px, NaN where there is none; None when rows are not coded."""
    @property
    def sigma_row(self) -> NDArray[np.float32] | _MaybeNone:
        """1σ of `row`: (H, W) float32, projector px, NaN where there is none; None when rows are not coded."""
    @property
    def confidence(self) -> NDArray[np.float32]:
        """Confidence of each pixel: (H, W) float32, 0 to 1."""
    @property
    def color(self) -> NDArray[np.uint8] | _MaybeNone:
        """Colour of each pixel under white light: (H, W, 3) uint8, sRGB; None when the sequence has no white picture."""
    @property
    def report(self) -> SequenceDecodeReport | _MaybeNone:
        """Counts and measurements of decoding; None for matches that were constructed or loaded."""
    def to_matches(self) -> Matches:
        """The pixels that have a match, as a list without gaps.

        `Matches.sigma_px` is in camera px. It is set to the σ of the projector's position, as if pixels of both had the same size on the
        surface; `Rig.triangulate` of the dense matches themselves needs no such assumption.

        Returns
        -------
        Matches
            In the order of the pixels, row by row.
        """
    def save(self, file: _Path | IO[bytes]) -> None:
        """Writes the pixels that have a match as NumPy's .npz: u, v, projector_column, sigma_column_px, projector_row, sigma_row_px,
        confidence, color, image_size.

        Parameters
        ----------
        file : path or binary file object
            A path, where the file appears when it is complete and replaces an older one, or an object with write().
        """
    @staticmethod
    def load(file: _Path | IO[bytes]) -> DenseMatches:
        """Reads matches from `save`, ``slcal decode`` or another program.

        Parameters
        ----------
        file : path or binary file object
            A .npz. The arrays u, v and at least one of projector_column and projector_row are needed; the others are taken when they are
            there.

        Returns
        -------
        DenseMatches

        Raises
        ------
        OSError
            When the file cannot be read.
        FormatError
            When it does not have this format; the message names the array.
        """
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@overload
def decode(
    image: _Frames,
    pattern: SequencePattern,
    *,
    rig: Rig | None = None,
    mirror: bool = False,
) -> DenseMatches:
    """Finds the stripes in a photograph and identifies their slits; or decodes the photographs of a sequence pixel by pixel.

    Parameters
    ----------
    image : ndarray, or iterable of ndarrays and paths
        (H, W, 3), uint8 or uint16, RGB order: the scene with the stripes projected. Of a sequence its photographs in the order of
        the pattern: (N, H, W) or (N, H, W, 3), or an iterable of arrays and paths. Paths are read, and items of an iterator
        taken, one by one, so that memory holds few.
    pattern : StripePattern or SequencePattern
        What was projected. With a sequence, `black`, `white`, `gamma` and `min_confidence` are not allowed.
    black, white : ndarray, optional
        The same view with the projector dark (ambient light is subtracted) and plain white (surface colours are divided
        out).
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the image.
    min_confidence : float, default 0.4
        Matches with a lower confidence are rejected and counted, 0 to 1.
    rig : Rig, optional
        The calibrated rig of the camera that took the image: its registration of the colour channels is used. Without it the registration is estimated from the
        stripes where they show it.
    mirror : bool, default False
        Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
        counts as width - 1 - c.
        A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.

    Returns
    -------
    Matches or DenseMatches
        Of stripes, `Matches`: one per slit and image row (image column, where the stripes are horizontal). Of a sequence,
        `DenseMatches`: the column, the row, or both of every pixel. Its `report` counts what was found, and what was rejected
        and why.

    Raises
    ------
    TypeError
        When the image is not an array of uint8 or uint16.
    Error
        When the shape is wrong, an image of stripes is grey, images differ in size, a sequence has another number of frames than its
        pattern, or an option is out of range.
    DecodeError
        When the stripes are not found, or are not those of the pattern. The message says so when they are found with red
        and blue swapped. When nothing can be read from a sequence.

    Examples
    --------
    >>> stripes = slcal.StripePattern(projector=(1024, 768))
    >>> matches = slcal.decode(stripes.image(), stripes)  # The projected picture itself.
    >>> bool(np.abs(matches.pixels[:, 0] - matches.columns).max() < 0.05)
    True
    >>> matches.report.slits
    64
    >>> shifts = slcal.SequencePattern(projector=(320, 240), kind="phase")
    >>> frames = (shifts.image(i)[:, 20:] for i in range(len(shifts)))  # A part of the projected pictures.
    >>> dense = slcal.decode(frames, shifts)
    >>> bool(np.nanmax(np.abs(dense.column - np.arange(20, 320))) < 0.1)
    True
    """
@overload
def decode(
    image: _ImageLike,
    pattern: StripePattern,
    *,
    black: _ImageLike | None = None,
    white: _ImageLike | None = None,
    gamma: _Gamma = "srgb",
    min_confidence: float = 0.4,
    rig: Rig | None = None,
    mirror: bool = False,
) -> Matches:
    """Finds the stripes in a photograph and identifies their slits; or decodes the photographs of a sequence pixel by pixel.

    Parameters
    ----------
    image : ndarray, or iterable of ndarrays and paths
        (H, W, 3), uint8 or uint16, RGB order: the scene with the stripes projected. Of a sequence its photographs in the order of
        the pattern: (N, H, W) or (N, H, W, 3), or an iterable of arrays and paths. Paths are read, and items of an iterator
        taken, one by one, so that memory holds few.
    pattern : StripePattern or SequencePattern
        What was projected. With a sequence, `black`, `white`, `gamma` and `min_confidence` are not allowed.
    black, white : ndarray, optional
        The same view with the projector dark (ambient light is subtracted) and plain white (surface colours are divided
        out).
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the image.
    min_confidence : float, default 0.4
        Matches with a lower confidence are rejected and counted, 0 to 1.
    rig : Rig, optional
        The calibrated rig of the camera that took the image: its registration of the colour channels is used. Without it the registration is estimated from the
        stripes where they show it.
    mirror : bool, default False
        Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
        counts as width - 1 - c.
        A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.

    Returns
    -------
    Matches or DenseMatches
        Of stripes, `Matches`: one per slit and image row (image column, where the stripes are horizontal). Of a sequence,
        `DenseMatches`: the column, the row, or both of every pixel. Its `report` counts what was found, and what was rejected
        and why.

    Raises
    ------
    TypeError
        When the image is not an array of uint8 or uint16.
    Error
        When the shape is wrong, an image of stripes is grey, images differ in size, a sequence has another number of frames than its
        pattern, or an option is out of range.
    DecodeError
        When the stripes are not found, or are not those of the pattern. The message says so when they are found with red
        and blue swapped. When nothing can be read from a sequence.

    Examples
    --------
    >>> stripes = slcal.StripePattern(projector=(1024, 768))
    >>> matches = slcal.decode(stripes.image(), stripes)  # The projected picture itself.
    >>> bool(np.abs(matches.pixels[:, 0] - matches.columns).max() < 0.05)
    True
    >>> matches.report.slits
    64
    >>> shifts = slcal.SequencePattern(projector=(320, 240), kind="phase")
    >>> frames = (shifts.image(i)[:, 20:] for i in range(len(shifts)))  # A part of the projected pictures.
    >>> dense = slcal.decode(frames, shifts)
    >>> bool(np.nanmax(np.abs(dense.column - np.arange(20, 320))) < 0.1)
    True
    """

@final
class PointCloud:
    """Points in space with their properties, and the triangles of a mesh where one was requested.

    `Rig.reconstruct` and `Rig.triangulate` return clouds; they can also be made from arrays. Two of them are equal when
    their numbers are (NaN equals NaN); the report is not compared. ``np.asarray(cloud)`` gives the points.

    ``cloud[index]`` is the cloud of some of the points, by a boolean mask, an array of integers or a slice. It keeps the
    triangles whose three corners are all among them, with new indices; of a point that is given twice the first counts. Its
    `report` is None.

    Parameters
    ----------
    points : array_like
        (N, 3), mm.
    colors : array_like, optional
        (N, 3), sRGB from 0 to 255; black unless given.
    sigma : array_like, optional
        (N,) or one for all: 1σ along the camera's ray, mm; 0 unless given.
    noise : array_like, optional
        (N,) or one for all: the part of `sigma` that varies from point to point, mm; 0 unless given.
    pixels : array_like, optional
        (N, 2): the camera pixels of the points; NaN unless given.
    slits : array_like, optional
        (N,): numbers of the slits; 0 unless given.
    confidence : array_like, optional
        (N,) or one for all, 0 to 1; 1 unless given.
    triangles : array_like, optional
        (M, 3): indices into the points, counter-clockwise as the camera sees them.
    normals : array_like, optional
        (N, 3): unit vectors towards the camera, zero where one is not known.
    frame : {"camera", "plane"}, default "camera"
        The coordinate frame: the camera's, or that of the sheet in the rig's first view.
    camera_centre : array_like, optional
        (3,): the position of the camera in these coordinates, mm; the origin unless given.

    Raises
    ------
    Error
        When shapes do not match, points are not finite, or a number is out of range.
    TypeError
        When something is not an array of numbers.

    Examples
    --------
    >>> cloud = slcal.PointCloud([[0, 0, 1000], [3, 4, 1000]], sigma=0.2)
    >>> cloud
    PointCloud(2 points, 1000.0 to 1000.0 mm from the camera, median σ 0.200 mm)
    >>> np.asarray(cloud).shape
    (2, 3)
    >>> cloud[cloud.points[:, 0] > 1].points
    array([[   3.,    4., 1000.]])
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
        normals: ArrayLike | None = None,
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
        """The part of `sigma` that varies from point to point: (N,) float64, mm. The rest is common to the whole cloud."""
    @property
    def pixels(self) -> NDArray[np.float64]:
        """Camera pixels (x, y) of the points: (N, 2) float64, NaN in clouds from files."""
    @property
    def slits(self) -> NDArray[np.uint16]:
        """Numbers of the slits: (N,) uint16, 0 where the matches were not of stripes."""
    @property
    def confidence(self) -> NDArray[np.float64]:
        """Confidence of the matches: (N,) float64, 0 to 1."""
    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Indices into the points: (M, 3) uint32, counter-clockwise as the camera sees them; (0, 3) without a mesh."""
    @property
    def normals(self) -> NDArray[np.float32] | _MaybeNone:
        """Unit vectors perpendicular to the surface, towards the camera: (N, 3) float32, zero for a point without neighbours; None where they
        are not known. Clouds of a sequence have them.
        """
    @property
    def frame(self) -> _Frame:
        """The coordinate frame: "camera", or "plane" for that of the sheet in the rig's first view."""
    @property
    def camera_centre(self) -> NDArray[np.float64]:
        """The position of the camera in these coordinates: (3,) float64, mm."""
    @property
    def report(self) -> CloudReport | _MaybeNone:
        """Counts and measurements of the reconstruction; None for a cloud that was constructed, loaded or is a part of
        another.
        """
    def save(self, file: _File, *, format: Literal["ply", "pcd", "xyz", "obj", "glb"] | None = None) -> None:
        """Writes the cloud.

        PLY holds all but pixels, in single precision; OBJ and GLB hold points, colours, normals and triangles (GLB in metres, y up);
        PCD and XYZ have no triangles, XYZ no normals.

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
            Positions are needed; colours, sigma, noise, slit, confidence, normals and faces are taken when they are there.

        Returns
        -------
        PointCloud

        Raises
        ------
        OSError
            When the file cannot be read.
        FormatError
            When it is not a PLY file, or is incomplete.
        Error
            When its name is that of another format; these can only be written.
        """
    def to_bytes(self, format: Literal["ply", "pcd", "xyz", "obj", "glb"] = "ply") -> bytes:
        """The content of the file that `save` would write."""
    def fit_plane(self) -> PlaneFit:
        """Fits a plane to the points, which may contain other surfaces as well.

        Returns
        -------
        PlaneFit
            The plane, and the distances of its inliers.

        Raises
        ------
        Error
            When there are fewer than three points, or no plane is found.
        """
    def fit_sphere(self) -> SphereFit:
        """Fits a sphere to the points, which may contain a wall as well.

        Returns
        -------
        SphereFit
            The sphere, and the distances of its inliers.

        Raises
        ------
        Error
            When there are fewer than four points, or no sphere that the camera could see is found.
        """
    def crop(self, min: ArrayLike, max: ArrayLike) -> PointCloud:
        """The points within a box whose sides are parallel to the axes of the cloud's own `frame`.

        Triangles are kept where all three corners are. The `report` is None.

        Parameters
        ----------
        min, max : array_like
            (3,), mm: least and greatest x, y and z, both included; infinite where a side is open.

        Returns
        -------
        PointCloud
            In the same frame and order; without points when there are none in the box.

        Raises
        ------
        Error
            When a coordinate is NaN, or one of `min` exceeds that of `max`.

        Examples
        --------
        >>> cloud = slcal.PointCloud([[0, 0, 900], [0, 0, 1100], [300, 0, 1000]])
        >>> cloud.crop([-100, -100, 0], [100, 100, 1000]).points
        array([[  0.,   0., 900.]])
        >>> len(cloud.crop([-np.inf, -np.inf, 1000], [np.inf, np.inf, np.inf]))
        2
        """
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: _Indices, /) -> PointCloud: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def __eq__(self, other: object, /) -> bool: ...

@overload
def evaluate(cloud: PointCloud | ArrayLike, shape: Literal["plane"]) -> PlaneFit:
    """Fits a plane or a sphere to a cloud and reports the distances of its points, as ``slcal evaluate`` does.

    The fit is robust: the cloud may contain other surfaces as well. Inliers lie within four times the robust σ, and the
    report is about the inliers.

    Parameters
    ----------
    cloud : PointCloud or array_like
        The points; an array is (N, 3), mm, in the camera's frame.
    shape : {"plane", "sphere"}
        What to fit.

    Returns
    -------
    PlaneFit or SphereFit

    Raises
    ------
    Error
        When there are too few points, they are not finite, or no such shape is found.

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
    >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
    (400, True)
    """
@overload
def evaluate(cloud: PointCloud | ArrayLike, shape: Literal["sphere"]) -> SphereFit:
    """Fits a plane or a sphere to a cloud and reports the distances of its points, as ``slcal evaluate`` does.

    The fit is robust: the cloud may contain other surfaces as well. Inliers lie within four times the robust σ, and the
    report is about the inliers.

    Parameters
    ----------
    cloud : PointCloud or array_like
        The points; an array is (N, 3), mm, in the camera's frame.
    shape : {"plane", "sphere"}
        What to fit.

    Returns
    -------
    PlaneFit or SphereFit

    Raises
    ------
    Error
        When there are too few points, they are not finite, or no such shape is found.

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
    >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
    (400, True)
    """
@overload
def evaluate(cloud: PointCloud | ArrayLike, shape: Literal["plane", "sphere"]) -> PlaneFit | SphereFit:
    """Fits a plane or a sphere to a cloud and reports the distances of its points, as ``slcal evaluate`` does.

    The fit is robust: the cloud may contain other surfaces as well. Inliers lie within four times the robust σ, and the
    report is about the inliers.

    Parameters
    ----------
    cloud : PointCloud or array_like
        The points; an array is (N, 3), mm, in the camera's frame.
    shape : {"plane", "sphere"}
        What to fit.

    Returns
    -------
    PlaneFit or SphereFit

    Raises
    ------
    Error
        When there are too few points, they are not finite, or no such shape is found.

    Examples
    --------
    >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
    >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
    (400, True)
    """

@final
class Reconstructor:
    """Reconstructs many photographs with the same rig and pattern, such as the frames of a video, or many scans by a sequence. It does what
    `Rig.reconstruct` does; rig, pattern and options are checked once, and buffers for stripes are kept from frame to frame.

    Threads that share a Reconstructor for stripes wait for each other; use one per thread. With a sequence they need not.

    Parameters
    ----------
    rig : Rig
        With a projector.
    pattern : StripePattern or SequencePattern
        What is projected, drawn for that projector. With a sequence, `gamma` and `min_confidence` are not allowed.
    gamma : {"srgb", "linear"} or float, default "srgb"
        The transfer curve of the images.
    frame : {"camera", "plane"}, default "camera"
        The coordinate frame of the clouds: the camera's, or that of the sheet in the rig's first view.
    mesh : bool, default False
        Whether the clouds keep the triangles between their points.
    cull : {"auto", "off"} or float, default "auto"
        Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
        removed.
    min_confidence : float, default 0.4
        Matches with a lower confidence are rejected, 0 to 1.
    near, far : float, optional
        Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.
    mirror : bool, default False
        Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
        counts as width - 1 - c.
        A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.

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

    @overload
    def __new__(
        cls,
        rig: Rig,
        pattern: SequencePattern,
        *,
        frame: _Frame = "camera",
        mesh: bool = False,
        cull: _Cull = "auto",
        near: float | None = None,
        far: float | None = None,
        mirror: bool = False,
    ) -> Reconstructor: ...
    @overload
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
        mirror: bool = False,
    ) -> Reconstructor: ...
    def reconstruct(
        self, image: _Frames, *, black: _ImageLike | None = None, white: _ImageLike | None = None
    ) -> PointCloud:
        """The cloud of one photograph of the stripes, or of the photographs of a sequence.

        Parameters
        ----------
        image : ndarray, or iterable of ndarrays and paths
            (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected. Of a sequence
            its photographs in the order of the pattern, as `slcal.decode` takes them.
        black, white : ndarray, optional
            The same scene with the projector dark and plain white; not with a sequence.

        Returns
        -------
        PointCloud
            Later frames do not change it.

        Raises
        ------
        TypeError
            When the image is not an array of uint8 or uint16.
        Error
            When its shape or size is wrong, or a sequence has another number of frames than its pattern.
        DecodeError
            When the stripes, or the light of the projector, are not found, or cannot be those of this rig.
        """

# Photographs and observations with known truth: see slcal.simulate for what the functions take

@final
class Scene:
    """Photographs of a simulated scene, and the ground truth of every pixel. `slcal.simulate.scene` makes them.

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
        """The true rig. If it was simulated and the surface is a sheet, the sheet is its view."""
    @property
    def pattern(self) -> CheckerPattern | StripePattern | SequencePattern:
        """What was projected."""
    @property
    def photo(self) -> _Image:
        """The photograph under the pattern: (H, W, 3) uint8, or uint16 with 16 bits. Of a sequence, that under a white projector."""
    @property
    def frames(self) -> SceneFrames:
        """The photographs under the pictures of a sequence, in its order; none of other patterns."""
    @property
    def white(self) -> _Image:
        """The photograph under a white projector."""
    @property
    def black(self) -> _Image:
        """The photograph under a dark projector."""
    @property
    def matches(self) -> Matches:
        """The true positions of slits or corners of the pattern in the photograph; none of a sequence, for which `column` and `row` are
        the truth.
        """
    @property
    def cloud(self) -> PointCloud:
        """The true points of the matches, in the camera's frame."""
    @property
    def column(self) -> NDArray[np.float32]:
        """The projector column that illuminates each pixel: (H, W) float32, px; NaN in shadow and outside the projector's
        footprint.
        """
    @property
    def row(self) -> NDArray[np.float32]:
        """The projector row that illuminates each pixel: (H, W) float32, px; NaN in shadow and outside the projector's
        footprint.
        """
    @property
    def depth(self) -> NDArray[np.float32]:
        """Depth of each pixel along the camera's axis: (H, W) float32, mm; NaN where there is no surface."""
    @property
    def surface(self) -> NDArray[np.uint8]:
        """Number of the surface in each pixel: (H, W) uint8, counted from 1; 0 for none."""
    @property
    def report(self) -> SceneReport:
        """Counts and depths of the scene."""

@final
class SceneFrames:
    """The photographs of a scene under the pictures of a sequence. Each is rendered when it is asked for, so that memory holds those that are
    kept; asked for again, it is the same.

    Examples
    --------
    >>> from slcal import simulate
    >>> sequence = slcal.SequencePattern(projector=(1024, 768), bits=3)
    >>> scene = simulate.scene("sphere", sequence, camera=(320, 240), focal=375)
    >>> len(scene.frames), scene.frames[0].shape
    (8, (240, 320, 3))
    >>> stack = [frame.mean(axis=2) for frame in scene.frames]
    """

    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> _Image: ...
    def __iter__(self) -> Iterator[_Image]: ...

def simulate_scene(options: dict[str, Any], /) -> Scene:
    """Photographs of a simulated scene, with the ground truth of every pixel; see `slcal.simulate.scene`."""
def simulate_views(options: dict[str, Any], /) -> tuple[Observations, Rig]:
    """Observations of a sheet in several poses and the rig behind them; see `slcal.simulate.views`."""
def simulate_noise(options: dict[str, Any], /) -> NoiseReport:
    """Both calibration methods at increasing noise; see `slcal.simulate.noise`."""
def run_command(args: Sequence[str], /) -> int:
    """Runs a command line, the program's name first, and returns its exit code."""
