"""Reports about results: frozen dataclasses with the names and numbers of the command's `--json`."""

from __future__ import annotations

import dataclasses
import functools
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, TypeVar

_R = TypeVar("_R", bound="Report")
#: There in the usual case, None in the cases that are named: it may be used without a check, as in typeshed.
_MaybeNone: TypeAlias = Any


@dataclass(frozen=True)
class Report:
    """A record that can be compared, copied, pickled and converted to a dictionary."""

    def to_dict(self) -> dict[str, Any]:
        """The record as nested dictionaries, lists, numbers and strings, for ``json.dumps``.

        Returns
        -------
        dict
            Its fields by name.
        """
        return typing.cast("dict[str, Any]", _plain(self))

    @classmethod
    def _of(cls: type[_R], fields: Mapping[str, Any]) -> _R:
        """From a dictionary of the extension; other fields in it are ignored."""
        kinds = _kinds(cls)  # type: ignore[arg-type]  # Classes are hashable; mypy does not know it of a type variable.
        return cls(**{name: _typed(kind, fields.get(name)) for name, kind in kinds.items()})


@functools.cache
def _kinds(cls: type[Report]) -> dict[str, Any]:
    """The annotations of a record's fields, in their order."""
    kinds = typing.get_type_hints(cls)
    return {f.name: kinds[f.name] for f in dataclasses.fields(cls)}


def _plain(value: Any) -> Any:
    if isinstance(value, Report):
        return {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, tuple):
        return [_plain(v) for v in value]
    if isinstance(value, Mapping):
        return {k: _plain(v) for k, v in value.items()}
    return value


def _typed(kind: Any, value: Any) -> Any:
    """`value` as the annotation `kind` says: records from dictionaries, tuples from lists."""
    if value is None:
        return None
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin in (typing.Union, types.UnionType):
        (kind,) = (k for k in inner if k not in (type(None), Any))
        return _typed(kind, value)
    if origin is tuple:
        kinds = inner[:1] * len(value) if inner[-1] is Ellipsis else inner
        return tuple(_typed(k, v) for k, v in zip(kinds, value, strict=True))
    if isinstance(kind, type) and issubclass(kind, Report):
        return kind._of(value)
    return value


# Calibration


@dataclass(frozen=True)
class DeviceSigma(Report):
    """1σ of a device's parameters; zero for what was held fixed."""

    focal_px: float
    cx_px: float
    cy_px: float
    #: k1, k2, p1, p2, k3.
    distortion: tuple[float, ...]
    #: Of the ratio of fy to fx.
    aspect: float


@dataclass(frozen=True)
class FocalSigma(Report):
    """1σ of the focal lengths, per cent."""

    camera: float
    projector: float | None


@dataclass(frozen=True)
class Warning(Report):  # noqa: A001 - the name that the rig's file has for it
    """A warning about a result, and what to do about it."""

    #: Stable identifier.
    code: str
    #: What was found, with numbers.
    message: str
    #: What to do.
    advice: str


@dataclass(frozen=True)
class Moves(Report):
    """By how much results move when an assumption is wrong, per cent; None for what was not calibrated."""

    f_cam: float | None
    f_proj: float | None
    baseline: float | None


@dataclass(frozen=True)
class Assumption(Report):
    """Something that a calibration takes for given, and what it would cost if it were otherwise."""

    #: Stable identifier, such as "square-pixels-camera".
    code: str
    #: What is assumed, as a clause.
    text: str
    #: The value that is assumed, or estimated, in `unit`.
    value: float
    #: Unit of `value`, `sigma` and `if_off_by`; the name of a quantity that has none.
    unit: str
    #: 1σ of the value; None where it is taken for exact.
    sigma: float | None
    #: An ordinary departure from the value.
    if_off_by: float
    #: By how much the results would move if the value were off by that.
    moves_percent: Moves
    #: Whether nothing confirms it, the photographs would contradict it, or they determine the value.
    status: Literal["assumed", "tested", "estimated"]


@dataclass(frozen=True)
class PanelDisplacement(Report):
    """A colour of the projector against green."""

    #: Shift to the right and down, px of the panel.
    shift_px: tuple[float, float]
    #: Magnification about the middle of the panel, beyond that of green.
    scale: float


@dataclass(frozen=True)
class LateralColor(Report):
    """A channel of the camera against green."""

    #: Magnification about the principal point, beyond that of green.
    radial: float


@dataclass(frozen=True)
class ProjectorChannels(Report):
    """Red and blue of the projector."""

    red: PanelDisplacement
    blue: PanelDisplacement


@dataclass(frozen=True)
class CameraChannels(Report):
    """Red and blue of the camera."""

    red: LateralColor
    blue: LateralColor


@dataclass(frozen=True)
class ChannelDisplacements(Report):
    """Displacements of projector and camera."""

    projector: ProjectorChannels
    camera: CameraChannels


@dataclass(frozen=True)
class ChannelRegistration(Report):
    """How red and blue are displaced against green. One sheet hardly tells the projector's magnification from the camera's."""

    #: The colour that the others are displaced against.
    reference: Literal["green"]
    projector: ProjectorChannels
    camera: CameraChannels
    #: 1σ of all of them.
    sigma: ChannelDisplacements
    #: What it was measured from.
    source: Literal["checker", "stripes"]


@dataclass(frozen=True)
class Quality(Report):
    """The quality of a calibration."""

    verdict: Literal["good", "fair", "weak", "degenerate"]
    focal_sigma_percent: FocalSigma
    #: 1σ of the depth of a point at the sheet's distance that the uncertainty of the rig itself causes, per cent.
    depth_sigma_percent: float | None
    #: Expected 1σ of a reconstructed point at the sheet's distance, mm.
    expected_point_sigma_mm: float | None
    #: The reason for the verdict: the pose of the sheet and the resulting σ of the focal length or of the depth, or a misfit where
    #: that made the verdict worse. Empty where the rig's file has none.
    cause: str
    #: How to improve it, with predicted numbers. Empty where the rig's file has none.
    advice: str
    warnings: tuple[Warning, ...]
    #: What the calibration takes for given, and what it would cost if it were otherwise. Empty where the rig's file has none.
    assumptions: tuple[Assumption, ...] = ()


@dataclass(frozen=True)
class ViewRms(Report):
    """Root mean square residuals of one view: camera px, camera px, projector px."""

    edges: float
    corners: float | None
    projector: float | None


@dataclass(frozen=True)
class ViewBend(Report):
    """How the sheet of one view bends out of its mean plane.

    With u and v from −1 to 1 along width and height, its height away from the viewer is the sum of ``coefficients_mm`` times P2(u), u·v,
    P2(v), P3(u), P2(u)·v, u·P2(v), P3(v), P4(u), P4(v), P3(u)·v, u·P3(v), P2(u)·P2(v); P are the Legendre polynomials.
    """

    #: Coefficients of the twelve terms, mm.
    coefficients_mm: tuple[float, ...]
    #: 1σ of them, mm.
    sigma_mm: tuple[float, ...]
    #: 1σ that was expected of each before the photograph, around zero, mm.
    expected_sigma_mm: tuple[float, ...]
    #: From valley to peak, mm.
    sag_mm: float


@dataclass(frozen=True)
class CalibrationReport(Report):
    """Details of a calibration beyond the rig itself."""

    #: Iterations of the least-squares refinement.
    iterations: int
    #: Share of the sheet's edge points that are inliers.
    edge_inliers: float
    #: Share of the projected corners that are inliers.
    corner_inliers: float
    #: The pose of the sheet and the resulting σ of the focal length.
    cause: str
    #: What more tilt or another photograph would improve.
    advice: str


# From stripes to points


@dataclass(frozen=True)
class Dropped(Report):
    """Stripe crossings that were rejected, by reason."""

    #: Low contrast relative to the noise, or no two edges.
    weak: int
    #: Ambiguous: the scanlines of its track do not agree on a slit, or too few of them were decoded.
    ambiguous: int
    #: Duplicate: a neighbour on the scanline has the same slit and more votes.
    inconsistent: int
    #: Truncated by an outline or a shadow.
    cut: int
    #: Low confidence: below ``min_confidence``.
    unsure: int


@dataclass(frozen=True)
class ChannelShift(Report):
    """Displacement of red and blue light against green along the pattern's axis, projector px."""

    red_px: float
    blue_px: float
    #: 1σ of red and blue.
    sigma_px: tuple[float, ...]
    #: Magnification of red and blue by the camera's lens beyond that of green.
    radial: tuple[float, ...]
    #: Whether it was removed: it came from a calibration, or is beyond 3σ.
    used: bool


@dataclass(frozen=True)
class DecodeReport(Report):
    """Counts and measurements of decoding a photograph of stripes."""

    #: Stripe crossings found on all scanlines.
    crossings: int
    #: Crossings that became matches.
    decoded: int
    #: Different slits among them.
    slits: int
    dropped: Dropped
    #: Whether scanlines run along image rows or columns.
    lines: Literal["rows", "columns"]
    #: Median width of the stripes, px.
    stripe_width_px: float
    #: Width of the stripes in the photograph over that of the drawn slits.
    width_ratio: float
    #: Noise of a pixel, 1σ in 8-bit grey levels.
    noise_levels: float
    #: Colours of the hues in the photograph (linear light, unit length), in the order of the palette.
    hues_seen: tuple[tuple[float, ...], ...]
    #: Response of the camera's channels (rows) to the projector's primaries (columns).
    crosstalk: tuple[tuple[float, ...], ...] | None
    #: Angle by which colours of one hue scatter, rad.
    hue_spread_rad: float
    #: Share of the crossings that are saturated in some channel.
    saturated: float
    #: How far red and blue were seen beside green; ``None`` where too few slits stand side by side to tell.
    channel_shift: ChannelShift | None
    #: Whether edges alternated from scanline to scanline, as a demosaiced photograph's do, and were averaged over three.
    demosaiced: bool
    #: Log-likelihood ratio of the pattern against chance, nats per crossing.
    code_fit: float
    #: Whether slit numbers ascend against the image's axis.
    reversed: bool
    #: Whether the stripes run across the direction that the pattern's axis has in the projector's image.
    turned: bool


@dataclass(frozen=True)
class SequenceDecodeReport(Report):
    """Counts and measurements of decoding the photographs of a sequence."""

    #: Frames of the sequence.
    frames: int
    #: Pixels of the camera.
    pixels: int
    #: Pixels on which white differs from black, or any bit from its inverse.
    lit: int
    #: Pixels with a position.
    decoded: int
    #: Lit pixels of which too little is certain: bits without contrast, no amplitude, or the light of two surfaces.
    undecided: int
    #: Lit pixels whose bits mean no place on the panel, or contradict the sinusoid.
    contradicting: int
    #: 1σ of a pixel's level in a frame, as a share of white of the file: the median of the lit pixels.
    noise: float
    #: White less black, as a share of white of the file: the median of the lit pixels; None when they are not shown.
    contrast: float | _MaybeNone
    #: Median 1σ of columns, projector px; None when they are not coded.
    median_sigma_column_px: float | _MaybeNone
    #: Median 1σ of rows, projector px; None when they are not coded.
    median_sigma_row_px: float | _MaybeNone
    #: What makes the result doubtful, such as ``moved``.
    warnings: tuple[Warning, ...]


@dataclass(frozen=True)
class TriangulateReport(Report):
    """Counts of triangulation."""

    points: int
    #: Neither column nor row known, or a pixel that the lens's model does not reach.
    invalid: int
    #: Grazing: the camera's ray is nearly parallel to the light plane.
    grazing: int
    #: Points behind the devices.
    behind: int
    #: Matches whose projector coordinate lies outside the panel.
    outside_panel: int
    #: Points nearer than ``near`` or farther than ``far``.
    outside_depth: int
    #: Column and row that contradict each other.
    contradicting: int
    #: Whether σ includes the rig's uncertainty.
    rig_sigma_known: bool
    median_sigma_mm: float
    median_noise_mm: float


@dataclass(frozen=True)
class CullReport(Report):
    """What was removed because it is not part of a surface."""

    #: Triangles between the points.
    triangles: int
    #: Of these, removed.
    triangles_removed: int
    #: Points removed.
    outliers: int


@dataclass(frozen=True)
class SlitCount(Report):
    """How many slits contradict the rig in one way."""

    #: Slits that could contradict it.
    tested: int
    #: Slits that do.
    contradicting: int
    #: By how much, px on the panel: the median of those that do.
    median_px: float
    #: What scanlines, noise and the uncertainty of the rig explain, px on the panel.
    allowed_px: float


@dataclass(frozen=True)
class RigCheckReport(Report):
    """How the matches agree with the rig, by the positions along the slits from which their light comes.

    Positions count from the panel's first row (its first column for slits that are rows).
    """

    #: Slits that were seen on enough scanlines.
    slits: int
    #: Whether the slits are rows of the panel.
    slits_are_rows: bool
    #: Light from before the panel's first position.
    outside_start: SlitCount
    #: Light from beyond its last one.
    outside_end: SlitCount
    #: Slits that end on a straight border of the light inside the panel, at its first position.
    inside_start: SlitCount
    #: The same at its last position.
    inside_end: SlitCount
    #: Light that would fall on two surfaces.
    lit_twice: SlitCount
    #: The scale at which the stripes seem to be shown, where that explains the ends of the light.
    shown_scale: float | None


@dataclass(frozen=True)
class CloudReport(Report):
    """Counts and measurements of a reconstruction."""

    points: int
    triangles: int
    #: None for a cloud from matches or of a sequence.
    decode: DecodeReport | _MaybeNone
    triangulate: TriangulateReport
    cull: CullReport
    rig_check: RigCheckReport
    #: What makes the cloud doubtful, such as ``rig-moved``.
    warnings: tuple[Warning, ...]
    #: None for a cloud that is not of a sequence.
    sequence: SequenceDecodeReport | _MaybeNone = None


# Evaluation


@dataclass(frozen=True)
class FitReport(Report):
    """Distances of the inliers from a fitted plane or sphere."""

    #: Which points count as inliers.
    rule: str
    #: Points of the cloud.
    points: int
    #: Points no further than `inlier_limit_mm` from the surface.
    inliers: int
    #: Share of the others, 0 to 1.
    outlier_share: float
    inlier_limit_mm: float
    #: Mean of |distance|.
    mean_mm: float
    #: Standard deviation of |distance|.
    std_mm: float
    #: Root mean square of the distance.
    rms_mm: float
    #: Mean distance of the inliers from the camera.
    camera_distance_mm: float
    #: The same three in per cent of the distance from the camera.
    mean_percent: float
    std_percent: float
    rms_percent: float


@dataclass(frozen=True)
class PlaneFit(Report):
    """The points X with normal · X + offset_mm = 0."""

    normal: tuple[float, float, float]
    offset_mm: float
    report: FitReport


@dataclass(frozen=True)
class SphereFit(Report):
    """The points at `radius_mm` from the centre."""

    centre_mm: tuple[float, float, float]
    radius_mm: float
    report: FitReport


# Verification


@dataclass(frozen=True)
class Measured(Report):
    """A value and its 1σ."""

    value: float
    sigma: float


@dataclass(frozen=True)
class Keystone(Report):
    """Keystone of the projected rectangle on the sheet; angles in degrees, positive clockwise."""

    worst_deg: Measured
    top_deg: Measured
    right_deg: Measured
    bottom_deg: Measured
    left_deg: Measured
    bottom_against_top_deg: Measured
    right_against_left_deg: Measured
    rotation_deg: Measured
    #: Error of the ratio of width to height, per cent.
    aspect_percent: Measured
    #: Corners TL, TR, BR, BL on the sheet, mm.
    corners_mm: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class CornerRms(Report):
    """Residuals of the projected corners, px."""

    under_rig: float
    projector_free: float


@dataclass(frozen=True)
class Change(Report):
    """What has changed, with the figures for this kind of change."""

    what: Literal["projector-moved", "projector-focal", "camera-focal", "several"]
    turn_deg: Measured | None = None
    shift_mm: Measured | None = None
    focal_percent: Measured | None = None


@dataclass(frozen=True)
class RigCheck(Report):
    """Whether the projector has moved relative to the camera."""

    moved: bool
    p_value: float
    chi_squared: float
    degrees_of_freedom: int
    #: Distance of the pattern from its predicted position, rms.
    pattern_off_mm: float
    corner_rms_px: CornerRms
    change: Change | None


@dataclass(frozen=True)
class SheetCheck(Report):
    """Whether the sheet has moved since the rig's first view."""

    moved: bool
    p_value: float
    chi_squared: float
    turn_deg: float
    shift_mm: float
    largest_mm: float


@dataclass(frozen=True)
class NoiseFactor(Report):
    """Ratio of the observed scatter to the stated σ, at least 1."""

    sheet: float
    pattern: float


@dataclass(frozen=True)
class Verification(Report):
    """Keystone of a projection, and whether the rig has moved."""

    #: Whether the pattern was assumed to be rectified, or as drawn.
    pattern: Literal["rectified", "as-drawn"]
    #: False-alarm rate: the probability that an unmoved rig is reported as moved.
    significance: float
    #: Whether the rig's own uncertainty is part of the tests.
    with_covariance: bool
    keystone: Keystone
    rig: RigCheck
    sheet: SheetCheck | None
    #: Projected corners that were found, and how many the pattern has.
    corners: int
    pattern_corners: int
    #: Corners and edge points that were rejected as outliers.
    left_out: int
    noise_factor: NoiseFactor


# Advice


@dataclass(frozen=True)
class Predicted(Report):
    """Predicted 1σ after a photograph."""

    camera_focal_percent: float
    projector_focal_percent: float | None
    projector_cy_px: float | None
    #: Of a point at the centre of the sheet, along the camera's ray.
    point_mm: float | None


@dataclass(frozen=True)
class TiltForecast(Report):
    """Predicted σ after a photograph with this tilt; None where it is not possible."""

    tilt_about_horizontal_deg: float
    tilt_about_vertical_deg: float
    #: One photograph (more).
    one: Predicted | None
    #: Two, the second with the tilt reversed.
    pair: Predicted | None


@dataclass(frozen=True)
class SheetPose(Report):
    """X_camera = R · X_sheet + t, mm."""

    R: tuple[tuple[float, float, float], ...]
    t: tuple[float, float, float]


@dataclass(frozen=True)
class NextView(Report):
    """The photograph that improves the calibration most."""

    tilt_about_horizontal_deg: float
    tilt_about_vertical_deg: float
    distance_mm: float
    #: Where the centre of the sheet should be in the photograph.
    centre_px: tuple[float, float]
    camera_from_sheet: SheetPose
    in_words: str
    #: Whether a second one with both tilts reversed should follow.
    then_reversed: bool
    sigma_after: Predicted


@dataclass(frozen=True)
class Noise(Report):
    """1σ of the observations of sheet and pattern, px."""

    sheet: float
    pattern: float


@dataclass(frozen=True)
class Advice(Report):
    """Which photograph to take next, and the predicted σ after it."""

    size_mm: tuple[float, float]
    distance_mm: float
    noise_px: Noise
    #: None before the first photograph.
    sigma_now: Predicted | _MaybeNone
    table: tuple[TiltForecast, ...]
    #: None when no pose is possible.
    next: NextView | _MaybeNone
    worth_it: bool


# Simulation


@dataclass(frozen=True)
class SceneReport(Report):
    """Counts and depths of a simulated photograph."""

    camera: tuple[int, int]
    surfaces: int
    #: Pixels that see a surface, and those of them that the projector illuminates.
    seen_pixels: int
    lit_pixels: int
    #: Least and greatest depth of the lit pixels, mm.
    depth_mm: tuple[float, float] | None
    matches: int
    #: How the light was simulated.
    render: dict[str, Any]
    #: Shape, axis and sag of a bent sheet, and the thickness of a board, mm.
    bend: dict[str, Any] | None = None
    thickness_mm: float | None = None


@dataclass(frozen=True)
class NoiseReport(Report):
    """Both calibration methods under noise, level by level: what ``slcal simulate noise --json`` prints."""

    config: dict[str, Any]
    truth: dict[str, Any]
    levels: tuple[dict[str, Any], ...]
