"""What is said about results: plain frozen records, with the names and numbers of the command line's `--json`."""

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
    """A record that can be compared, copied, pickled and turned into a dictionary."""

    def to_dict(self) -> dict[str, Any]:
        """The record as nested dictionaries, lists, numbers and strings: what ``json.dumps`` takes.

        Returns
        -------
        dict
            Its fields by name.
        """
        return typing.cast("dict[str, Any]", _plain(self))

    @classmethod
    def _of(cls: type[_R], fields: Mapping[str, Any]) -> _R:
        """From the dictionary that the extension makes; fields that it has beyond these are left out."""
        kinds = _kinds(cls)  # type: ignore[arg-type]  # Classes are hashable, whatever mypy makes of a type variable.
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


@dataclass(frozen=True)
class FocalSigma(Report):
    """1σ of the focal lengths, per cent."""

    camera: float
    projector: float | None


@dataclass(frozen=True)
class Warning(Report):  # noqa: A001 - the name that the rig's file has for it
    """Something that the user should know about a result, and what to do about it."""

    #: Stable identifier.
    code: str
    #: What was noticed, with numbers.
    message: str
    #: What to do.
    advice: str


@dataclass(frozen=True)
class Quality(Report):
    """The judgement on a calibration."""

    verdict: Literal["good", "fair", "weak", "degenerate"]
    focal_sigma_percent: FocalSigma
    #: Expected 1σ of a reconstructed point at the sheet's distance, mm.
    expected_point_sigma_mm: float | None
    #: Why the verdict is what it is: how the sheet was seen and how well the focal length is known from it, or what does not
    #: fit, where that made the verdict worse; empty where a rig does not say.
    cause: str
    #: What would make it better, with predicted numbers; empty where a rig does not say.
    advice: str
    warnings: tuple[Warning, ...]


@dataclass(frozen=True)
class ViewRms(Report):
    """Root mean square residuals of one view: camera px, camera px, projector px."""

    edges: float
    corners: float | None
    projector: float | None


@dataclass(frozen=True)
class CalibrationReport(Report):
    """How a calibration went, beyond the rig itself."""

    #: Iterations of the refinement.
    iterations: int
    #: Share of the sheet's edge points that the robust loss kept.
    edge_inliers: float
    #: Share of the projected corners that it kept.
    corner_inliers: float
    #: How the sheet is seen and how well the focal length is known from it.
    cause: str
    #: What more tilt or another photograph would bring.
    advice: str


# From stripes to points


@dataclass(frozen=True)
class Dropped(Report):
    """Bright bands that were seen and not reported, by reason."""

    #: Too little contrast over the noise, or no two edges.
    weak: int
    #: The lines of its curve do not agree on a slit, or too few of them decoded.
    ambiguous: int
    #: The neighbour on the line has the same number, with better reason.
    inconsistent: int
    #: An outline or a shadow cuts it.
    cut: int
    #: Confidence below the one asked for.
    unsure: int


@dataclass(frozen=True)
class DecodeReport(Report):
    """What decoding saw in a photograph of stripes."""

    #: Bright bands seen, over all lines.
    crossings: int
    #: Reported as matches.
    decoded: int
    #: Different slits among them.
    slits: int
    dropped: Dropped
    #: Whether lines were read along image rows or columns.
    lines: Literal["rows", "columns"]
    #: Median width of the stripes, px.
    stripe_width_px: float
    #: Width of the stripes as photographed over that of the slits as drawn.
    width_ratio: float
    #: Noise of a pixel, 1σ in 8-bit grey levels.
    noise_levels: float
    #: Colours of the hues as seen (linear light, unit length), in the order of the palette.
    hues_seen: tuple[tuple[float, ...], ...]
    #: What the camera's channels (rows) see of the projector's primaries (columns).
    crosstalk: tuple[tuple[float, ...], ...] | None
    #: Angle by which colours of one hue scatter, rad.
    hue_spread_rad: float
    #: Share of the crossings that are clipped in some channel.
    saturated: float
    #: How much better than chance the colours follow the pattern, nats per crossing.
    code_fit: float
    #: Whether slits ascend against the image's axis.
    reversed: bool
    #: Whether the stripes run across the direction that the pattern's axis has in the projector's image.
    turned: bool


@dataclass(frozen=True)
class TriangulateReport(Report):
    """What became of the matches."""

    points: int
    #: Neither column nor row known, or a pixel that the lens's model does not reach.
    invalid: int
    #: The camera's ray nearly lies in the plane of light.
    grazing: int
    #: Behind the devices.
    behind: int
    #: Lit from outside the panel.
    outside_panel: int
    #: Nearer or farther than the limits that were given.
    outside_depth: int
    #: Column and row that contradict each other.
    contradicting: int
    #: Whether σ holds the rig's own uncertainty.
    rig_sigma_known: bool
    median_sigma_mm: float
    median_noise_mm: float


@dataclass(frozen=True)
class CullReport(Report):
    """What was removed as no surface."""

    #: Triangles between the points.
    triangles: int
    #: Of these, removed.
    triangles_removed: int
    #: Points removed.
    outliers: int


@dataclass(frozen=True)
class CloudReport(Report):
    """How a cloud came about."""

    points: int
    triangles: int
    #: None when the matches were given.
    decode: DecodeReport | _MaybeNone
    triangulate: TriangulateReport
    cull: CullReport


# Evaluation


@dataclass(frozen=True)
class FitReport(Report):
    """Distances of the inliers from a fitted surface."""

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
    """How square the projected rectangle is on the sheet; angles in degrees, clockwise counts up."""

    worst_deg: Measured
    top_deg: Measured
    right_deg: Measured
    bottom_deg: Measured
    left_deg: Measured
    bottom_against_top_deg: Measured
    right_against_left_deg: Measured
    rotation_deg: Measured
    #: Width to height, off by so many per cent.
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
    """What has changed; the figures that belong to `what` are given."""

    what: Literal["projector-moved", "projector-focal", "camera-focal", "several"]
    turn_deg: Measured | None = None
    shift_mm: Measured | None = None
    focal_percent: Measured | None = None


@dataclass(frozen=True)
class RigCheck(Report):
    """Projector against camera."""

    moved: bool
    p_value: float
    chi_squared: float
    degrees_of_freedom: int
    #: Distance of the pattern from where the rig puts it, rms.
    pattern_off_mm: float
    corner_rms_px: CornerRms
    change: Change | None


@dataclass(frozen=True)
class SheetCheck(Report):
    """The sheet against the rig's first view."""

    moved: bool
    p_value: float
    chi_squared: float
    turn_deg: float
    shift_mm: float
    largest_mm: float


@dataclass(frozen=True)
class NoiseFactor(Report):
    """By how much what was seen scatters more than its own σ says, at least 1."""

    sheet: float
    pattern: float


@dataclass(frozen=True)
class Verification(Report):
    """How square a projection is, and whether the rig has moved."""

    #: Whether the pattern was taken to be rectified, or as drawn.
    pattern: Literal["rectified", "as-drawn"]
    #: How often an unmoved rig would be called moved.
    significance: float
    #: Whether the rig's own uncertainty is part of the tests.
    with_covariance: bool
    keystone: Keystone
    rig: RigCheck
    sheet: SheetCheck | None
    #: Projected corners that were seen, and how many the pattern has.
    corners: int
    pattern_corners: int
    #: Corners and edge points that did not fit and were left out.
    left_out: int
    noise_factor: NoiseFactor


# Advice


@dataclass(frozen=True)
class Predicted(Report):
    """Predicted 1σ after a photograph."""

    camera_focal_percent: float
    projector_focal_percent: float | None
    projector_cy_px: float | None
    #: Of a point at the middle of the sheet, along the camera's ray.
    point_mm: float | None


@dataclass(frozen=True)
class TiltForecast(Report):
    """What a photograph with this tilt would bring; None where it is not possible."""

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
    """The photograph that is worth most."""

    tilt_about_horizontal_deg: float
    tilt_about_vertical_deg: float
    distance_mm: float
    #: Where the sheet's middle should be seen.
    centre_px: tuple[float, float]
    camera_from_sheet: SheetPose
    in_words: str
    #: Whether a second one with both tilts reversed should follow.
    then_reversed: bool
    sigma_after: Predicted


@dataclass(frozen=True)
class Noise(Report):
    """1σ of what is seen of sheet and pattern, px."""

    sheet: float
    pattern: float


@dataclass(frozen=True)
class Advice(Report):
    """Which photograph to take next, and what it will bring."""

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
    """What a simulated photograph shows."""

    camera: tuple[int, int]
    surfaces: int
    #: Pixels that see a surface, and those of them that the projector's light reaches.
    seen_pixels: int
    lit_pixels: int
    #: Least and greatest depth of the lit pixels, mm.
    depth_mm: tuple[float, float] | None
    matches: int
    #: How the light was simulated.
    render: dict[str, Any]


@dataclass(frozen=True)
class NoiseReport(Report):
    """Both methods of calibration under noise, level by level: what ``slcal simulate noise --json`` prints."""

    config: dict[str, Any]
    truth: dict[str, Any]
    levels: tuple[dict[str, Any], ...]
