"""Simulated photographs and observations with ground truth, as from ``slcal simulate``, with the same options and defaults.

Lengths are millimetres, angles degrees, focal lengths pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Literal, NamedTuple, TypeAlias

from numpy.typing import ArrayLike

from ._slcal import (
    CheckerPattern,
    Observations,
    PointCloud,
    Rig,
    Scene,
    SceneFrames,
    SequencePattern,
    StripePattern,
    simulate_noise,
    simulate_scene,
    simulate_views,
)
from .reports import NoiseReport

__all__ = ["Scene", "SceneFrames", "Views", "noise", "scene", "views"]

_Pose: TypeAlias = tuple[float, float] | tuple[float, float, float]


def scene(
    surface: Literal["plane", "sphere", "step", "sheet"] | str | PathLike[str] | PointCloud = "plane",
    pattern: Literal["stripes", "checker"] | StripePattern | CheckerPattern | SequencePattern | None = None,
    *,
    rig: Rig | None = None,
    camera: tuple[int, int] = (1280, 960),
    focal: float = 1500.0,
    projector: tuple[int, int] = (1024, 768),
    projector_focal: float = 1700.0,
    lens_shift: float = 0.0,
    baseline: float = 250.0,
    size_mm: tuple[float, float] | str = (594.0, 420.0),
    distance: float = 1000.0,
    distortion: ArrayLike = 0.0,
    pixel_aspect: float = 1.0,
    projector_pixel_aspect: float = 1.0,
    projector_offset: float | tuple[float, float] = 0.0,
    projector_distortion: ArrayLike = 0.0,
    bend: str | None = None,
    thickness: float = 0.0,
    tilt: _Pose | None = None,
    aside: tuple[float, float] = (0.0, 0.0),
    radius: float | None = None,
    albedo: float | tuple[float, float, float] = 0.9,
    wall: float | Literal["auto", "none"] = "auto",
    wall_albedo: float = 0.4,
    mesh_frame: Literal["object", "camera"] = "object",
    mesh_scale: float = 1.0,
    exact: bool = False,
    noise: float | None = None,
    blur: float | None = None,
    projector_blur: float = 0.0,
    projector_black: float = 0.0,
    crosstalk: ArrayLike = 0.0,
    ambient: float | tuple[float, float, float] = 0.03,
    exposure: float = 0.8,
    bits: Literal[8, 16] | None = None,
    seed: int = 1,
    gamma: Literal["srgb", "linear"] | float = "srgb",
    projector_gamma: float | None = None,
    projector_falloff: float = 0.0,
    channel_shift: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    lateral_colour: tuple[float, float] = (0.0, 0.0),
    vignetting: float = 0.0,
    flicker: tuple[float, float] | None = None,
    demosaic: Literal["malvar", "bilinear"] | None = None,
    tone: float = 0.0,
    sharpen: tuple[float, float] | None = None,
    jpeg: int | None = None,
    mirror: bool = False,
) -> Scene:
    """Simulates photographs of a surface under the projector's light, with the ground truth of every pixel.

    The geometry is exact: lens distortion, occlusion and shadow. The light is simple: matt surfaces, no
    interreflection.

    Parameters
    ----------
    surface : {"plane", "sphere", "step", "sheet"}, path or PointCloud, default "plane"
        The scene: an infinite plane, a sphere, a wall with two blocks in front of it, a sheet of `size_mm`, or a mesh. A mesh
        is a file whose name ends in .ply or .obj, or a cloud with triangles.
    pattern : {"stripes", "checker"}, StripePattern, CheckerPattern or SequencePattern, optional
        The projected pattern; by default the checkerboard on a sheet, and stripes on everything else. A "checker" on a sheet
        is scaled down until it fits on the sheet. Under a sequence, `Scene.frames` has a photograph for each of its pictures.
    rig : Rig, optional
        A given rig instead of the options from `camera` to `baseline` and from `distortion` to `projector_distortion`;
        `distance`, `size_mm` and `bend` still define the surface.
    camera, projector : (int, int)
        Width and height of the camera's image and of the projector's panel, px.
    focal, projector_focal : float
        Focal lengths, px.
    lens_shift : float
        Offset of the projector's principal point below the centre of the panel, in panel heights.
    baseline : float
        Horizontal distance between camera and projector, mm.
    size_mm : (float, float) or str
        Width and height of the sheet, mm, or a text such as "A2-landscape" or "594x420mm".
    distance : float
        Distance of the surface's centre along the camera's axis, mm.
    distortion : array_like
        The camera's k1, k2, p1, p2, k3; zeros at the end may be omitted.
    pixel_aspect, projector_pixel_aspect : float
        Focal lengths along y over those along x, which are `focal` and `projector_focal`.
    projector_offset : float or (float, float)
        Offset of the projector's principal point to the right of the centre of the panel and, optionally, down (added to
        `lens_shift`), px.
    projector_distortion : array_like
        The projector's k1, k2, p1, p2, k3; zeros at the end may be omitted.
    bend : str, optional
        Bend of the sheet as ``"SAG[,AXIS_DEG[,curl|wave|twist]]"``: "3mm", "0.5%" (of the width), "3mm,20" or "0.5%,90,wave".
        The sheet is not stretched. ``slcal simulate scene --help`` defines sag and axis.
    thickness : float
        Thickness of the sheet, mm: a board whose side faces have the albedo of its front.
    tilt : (float, float) or (float, float, float), optional
        Tilt of the surface about the camera's horizontal and vertical axis and, optionally, roll, degrees; by default
        (10, 20) for a plane, (25, 28) for a sheet, none for others.
    aside : (float, float)
        Offset of the surface's centre to the right of and below the camera's axis, mm.
    radius : float, optional
        Radius of the sphere, mm; by default 0.18 of the distance.
    albedo : float or (float, float, float)
        Albedo of the surface: grey, or red, green and blue.
    wall : float or {"auto", "none"}
        Distance of a wall behind the surface's centre, mm; "auto" places one close behind a sphere or a mesh.
    wall_albedo : float
        Albedo of the wall (grey).
    mesh_frame : {"object", "camera"}
        Frame of the mesh: its own (y up, z to the viewer; its centre is placed at the distance), or the camera's.
    mesh_scale : float
        Scale factor of the mesh, if its unit is not the millimetre.
    exact : bool
        No noise, no blur and 16 bit, unless `noise`, `blur` or `bits` are given.
    noise : float, optional
        Standard deviation of the noise, grey levels of 255; 1 unless given.
    blur : float, optional
        σ of the camera's blur, px; 0.6 unless given.
    projector_blur : float
        σ of the projector's blur, panel px.
    projector_black : float
        Light of the projector where it shows black, as a share of full light.
    crosstalk : array_like
        Share of light that each channel receives from its neighbours (red, green, blue), or the matrix (3, 3): channels of
        the camera by those of the light.
    ambient : float or (float, float, float)
        Ambient light, as a share of the projector's.
    exposure : float
        Value of a white surface that faces the projector under full light, as a share of full scale; more saturates.
    bits : {8, 16}, optional
        Bits per sample; 8 unless given.
    seed : int
        Seed of the noise: the same seed gives the same photographs.
    gamma : {"srgb", "linear"} or float
        The transfer curve of the photographs.
    projector_gamma : float, optional
        Light of the projector is value ** projector_gamma; by default it follows sRGB's curve.
    projector_falloff, vignetting : float
        Share of the light that is lost in the corners of the projector's panel and of the camera's image. It falls with the
        square of the distance from the middle.
    channel_shift : (float, float, float, float)
        Columns and rows by which the red and the blue panel of the projector lie beside the green one (rx, ry, bx, by), panel
        px: red light of panel position p falls where green light of p + (rx, ry) falls. The true rig, matches and maps
        are those of green.
    lateral_colour : (float, float)
        Lateral colour of the camera's lens for red and blue: what green shows at u, red shows at c + (u - c) * (1 + r), with c
        the principal point.
    flicker : (float, float), optional
        Amount A and period P of mains flicker under a rolling shutter: row y gets 1 - A/2 + A/2 * sin(2 * pi * y / P) of its
        light.
    demosaic : {"malvar", "bilinear"}, optional
        A sensor with a Bayer mosaic (RGGB), and how the camera fills it in. `noise` is then that of the sensor's samples. By
        default each pixel has three samples.
    tone : float
        Strength S of an S-shaped tone curve, 0 to 1: an encoded value v becomes v + S * (3 * v**2 - 2 * v**3 - v).
    sharpen : (float, float), optional
        Amount and radius of sharpening: the amount times what a Gaussian whose σ is the radius, px, takes away from the luma of
        the encoded image is added to all channels.
    jpeg : int, optional
        The photographs are what is read from JPEG files of this quality, 1 to 100, with colour at half the resolution (4:2:0);
        8 bit only.
    mirror : bool
        Whether the projector's pictures appear mirrored, left and right exchanged; the rig then says so.

    Returns
    -------
    Scene
        The photographs under the pattern, under white and without light, and the ground truth of every pixel.

    Raises
    ------
    Error
        When an option is out of range, or options contradict each other.
    OSError
        When a mesh cannot be read.

    Examples
    --------
    >>> from slcal import simulate
    >>> made = simulate.scene("sphere", camera=(640, 480), focal=750, exact=True)
    >>> made.photo.dtype, made.photo.shape
    (dtype('uint16'), (480, 640, 3))
    >>> found = slcal.decode(made.photo, made.pattern)
    >>> true_column = made.column[found.pixels[:, 1].astype(int), found.pixels[:, 0].round().astype(int)]
    >>> bool(np.nanmedian(np.abs(found.columns - true_column)) < 2)
    True
    """
    return simulate_scene(dict(locals()))


class Views(NamedTuple):
    """The simulated observations, and the true rig."""

    observations: Observations
    rig: Rig


def views(
    poses: int = 10,
    *,
    pose: Sequence[_Pose] | None = None,
    noise: float = 0.1,
    edges: int | None = None,
    seed: int = 1,
    camera: tuple[int, int] = (1280, 960),
    focal: float = 1500.0,
    camera_offset: tuple[float, float] = (0.0, 0.0),
    projector: tuple[int, int] = (1024, 768),
    projector_focal: float = 1700.0,
    projector_offset: float | tuple[float, float] = 0.0,
    lens_shift: float = 0.0,
    baseline: float = 250.0,
    size_mm: tuple[float, float] | str = (594.0, 420.0),
    distance: float = 1000.0,
    distortion: ArrayLike = 0.0,
    pixel_aspect: float = 1.0,
    projector_pixel_aspect: float = 1.0,
    projector_distortion: ArrayLike = 0.0,
    bend: str | None = None,
) -> Views:
    """Simulates observations of a sheet in several poses, with noise.

    Parameters
    ----------
    poses : int
        Number of poses, tilted by 15° to 35° in all directions.
    pose : sequence of (float, float) or (float, float, float), optional
        Given poses instead: tilt about the camera's horizontal and vertical axis and, optionally, roll, degrees.
    noise : float
        Standard deviation of the noise on each image coordinate, px.
    edges : int, optional
        Number of points on each of the sheet's edges, instead of its corners.
    seed : int
        Seed of poses and noise: the same seed gives the same observations.
    camera, focal, projector, projector_focal, projector_offset, lens_shift, baseline, size_mm, distance, distortion
        The rig, as in `scene`.
    pixel_aspect, projector_pixel_aspect, projector_distortion
        The rig's lenses, as in `scene`.
    bend : str, optional
        Bend of the sheet in every pose, as in `scene`. Its edges are curves in the image, and the projected corners lie on it.
    camera_offset : (float, float)
        Offset of the camera's principal point from the image centre, px.

    Returns
    -------
    Views
        `observations`, which `slcal.calibrate_observations` takes, and the true `rig`.

    Raises
    ------
    Error
        When an option is out of range.

    Examples
    --------
    >>> from slcal import simulate
    >>> seen, truth = simulate.views(poses=3, noise=0.05)
    >>> len(seen), round(truth.baseline_mm)
    (3, 250)
    """
    return Views(*simulate_views(dict(locals())))


def noise(
    levels: Sequence[float] | None = None,
    *,
    draws: int = 50,
    seed: int = 1,
    tilt: tuple[float, float] = (25.0, 28.0),
    principal_points: Literal["exact", "prior"] = "exact",
    cube: float | None = None,
    camera: tuple[int, int] = (1280, 960),
    focal: float = 1500.0,
    projector: tuple[int, int] = (1024, 768),
    projector_focal: float = 1700.0,
    lens_shift: float = 0.0,
    baseline: float = 250.0,
    size_mm: tuple[float, float] | str = (594.0, 420.0),
    distance: float = 1000.0,
    pixel_aspect: float = 1.0,
    projector_pixel_aspect: float = 1.0,
    projector_offset: float | tuple[float, float] = 0.0,
    projector_distortion: ArrayLike = 0.0,
    bend: str | None = None,
) -> NoiseReport:
    """Calibrates repeatedly at increasing noise, with both methods, and compares with the ground truth.

    Parameters
    ----------
    levels : sequence of float, optional
        Standard deviations of the noise on each image coordinate, px; 0, 0.1, ... 1 unless given.
    draws : int
        Draws of the noise per level.
    seed : int
        Seed of the noise: the same seed gives the same numbers.
    tilt : (float, float)
        Tilt of the sheet about the camera's horizontal and vertical axis, degrees.
    principal_points : {"exact", "prior"}
        What the methods know about principal points: the true values, as in the published experiment, or the default priors,
        from which the true values are then drawn.
    cube : float, optional
        Edge of the reference cube on the sheet, mm; by default a quarter of the sheet's shorter side, or less where that is
        not completely visible.
    camera, focal, projector, projector_focal, lens_shift, baseline, size_mm, distance
        The rig, as in `scene`.
    pixel_aspect, projector_pixel_aspect, projector_offset, projector_distortion, bend
        Its lenses and the bend of the sheet, as in `scene`. Both methods take pixels for square and everything for flat: the
        errors show what that costs.

    Returns
    -------
    NoiseReport
        Level by level what ``slcal simulate noise --json`` prints: errors of both methods, and the Cramér-Rao bound.

    Raises
    ------
    Error
        When an option is out of range.

    Examples
    --------
    >>> from slcal import simulate
    >>> report = simulate.noise([0.1], draws=5)
    >>> sorted(report.levels[0])
    ['bound', 'level_px', 'methods']
    """
    return simulate_noise(dict(locals()))


