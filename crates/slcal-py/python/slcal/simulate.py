"""Photographs and observations with known truth: what ``slcal simulate`` makes, with the same options and defaults.

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
    StripePattern,
    simulate_noise,
    simulate_scene,
    simulate_views,
)
from .reports import NoiseReport

__all__ = ["Scene", "Views", "noise", "scene", "views"]

_Pose: TypeAlias = tuple[float, float] | tuple[float, float, float]


def scene(
    surface: Literal["plane", "sphere", "step", "sheet"] | str | PathLike[str] | PointCloud = "plane",
    pattern: Literal["stripes", "checker"] | StripePattern | CheckerPattern | None = None,
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
) -> Scene:
    """Photograph a surface under the projector's light, with the truth of every pixel.

    Geometrically exact: lenses with their distortion, occlusion, shadow. Physically simple: matt surfaces, no light from
    one surface to another.

    Parameters
    ----------
    surface : {"plane", "sphere", "step", "sheet"}, path or PointCloud, default "plane"
        What the rig looks at: an endless plane, a sphere, a wall with two blocks before it, a sheet of `size_mm`, or a mesh:
        a file whose name ends in .ply or .obj, or a cloud with triangles.
    pattern : {"stripes", "checker"}, StripePattern or CheckerPattern, optional
        What the projector shows; unless given the checkerboard on a sheet and stripes on everything else. A "checker" on a
        sheet is as small as it takes to fall on it.
    rig : Rig, optional
        A rig of one's own instead of the options from `camera` to `baseline` and `distortion`; `distance` and `size_mm`
        still place the surface.
    camera, projector : (int, int)
        Width and height of the camera's image and of the projector's panel, px.
    focal, projector_focal : float
        Focal lengths, px.
    lens_shift : float
        How far below the panel's middle the projector's principal point lies, in heights of the panel.
    baseline : float
        Horizontal distance between camera and projector, mm.
    size_mm : (float, float)
        Width and height of the sheet, mm.
    distance : float
        Distance of the surface's middle from the camera along its axis, mm.
    distortion : array_like
        The camera's k1, k2, p1, p2, k3, as many of them as are not zero.
    tilt : (float, float) or (float, float, float), optional
        Tilt of the surface about the camera's horizontal and vertical axis and, if wanted, roll, degrees; unless given
        (10, 20) for a plane, (25, 28) for a sheet, none for others.
    aside : (float, float)
        How far right of and below the camera's axis the surface's middle stands, mm.
    radius : float, optional
        Radius of the sphere, mm; 0.18 of the distance unless given.
    albedo : float or (float, float, float)
        Share of light that the surface returns: grey, or red, green and blue.
    wall : float or {"auto", "none"}
        A wall so far behind the surface's middle, mm; "auto" puts one close behind a sphere and a mesh.
    wall_albedo : float
        Grey share of light that the wall returns.
    mesh_frame : {"object", "camera"}
        Frame of the mesh: its own (y up, z to the viewer; its middle is put at the distance), or the camera's.
    mesh_scale : float
        Multiplies the mesh's coordinates, for those that are not in millimetres.
    exact : bool
        Neither noise nor blur, and 16 bit, where `noise`, `blur` and `bits` do not say otherwise.
    noise : float, optional
        Standard deviation of the noise, grey levels of 255; 1 unless given.
    blur : float, optional
        σ of the camera's blur, px; 0.6 unless given.
    projector_blur : float
        σ of the projector's blur, panel px.
    projector_black : float
        What the projector sends out where it shows black, as a share of full light.
    crosstalk : array_like
        Light that each channel gets of those next to it (red, green, blue), or the whole matrix (3, 3): channels of the
        camera by those of the light.
    ambient : float or (float, float, float)
        Light from everywhere, as a share of the projector's.
    exposure : float
        Light, as a share of full scale, of what is white and faces the projector under full light; more saturates.
    bits : {8, 16}, optional
        Bits per sample; 8 unless given.
    seed : int
        Seed of the noise: the same seed gives the same photographs.
    gamma : {"srgb", "linear"} or float
        How the values of the photographs follow the light.

    Returns
    -------
    Scene
        The photographs under the pattern, under white and under no light, and what is true of every pixel.

    Raises
    ------
    Error
        When an option is out of its range, or they contradict each other.
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
    """What was simulated, and the rig that is the truth behind it."""

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
    projector_offset: float = 0.0,
    lens_shift: float = 0.0,
    baseline: float = 250.0,
    size_mm: tuple[float, float] | str = (594.0, 420.0),
    distance: float = 1000.0,
    distortion: ArrayLike = 0.0,
) -> Views:
    """Observe a sheet in several poses, with noise.

    Parameters
    ----------
    poses : int
        Number of poses, tilted by 15° to 35° in directions all round.
    pose : sequence of (float, float) or (float, float, float), optional
        Poses of one's own instead: tilt about the camera's horizontal and vertical axis and, if wanted, roll, degrees.
    noise : float
        Standard deviation of the noise on each image coordinate, px.
    edges : int, optional
        So many points on each of the sheet's edges instead of its corners.
    seed : int
        Seed of poses and noise: the same seed gives the same observations.
    camera, focal, projector, projector_focal, lens_shift, baseline, size_mm, distance, distortion
        The rig, as in `scene`.
    camera_offset : (float, float)
        The camera's principal point off the picture's centre, px.
    projector_offset : float
        The projector's principal point off the panel's middle column, px.

    Returns
    -------
    Views
        `observations`, which `slcal.calibrate_observations` takes, and the true `rig`.

    Raises
    ------
    Error
        When an option is out of its range.

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
) -> NoiseReport:
    """Calibrate again and again under rising noise, by both methods, and compare with the truth.

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
        What the methods are told about principal points: the truth, as in the published experiment, or the default priors,
        from which the truth is then drawn.
    cube : float, optional
        Edge of the reference cube that stands on the sheet, mm; a quarter of the sheet's shorter side unless given, or less
        where that is not seen whole.
    camera, focal, projector, projector_focal, lens_shift, baseline, size_mm, distance
        The rig, as in `scene`.

    Returns
    -------
    NoiseReport
        Level by level what ``slcal simulate noise --json`` prints: errors of both methods, and the Cramér-Rao bound.

    Raises
    ------
    Error
        When an option is out of its range.

    Examples
    --------
    >>> from slcal import simulate
    >>> report = simulate.noise([0.1], draws=5)
    >>> sorted(report.levels[0])
    ['bound', 'level_px', 'methods']
    """
    return simulate_noise(dict(locals()))


