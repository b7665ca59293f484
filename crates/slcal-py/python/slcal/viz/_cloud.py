"""A cloud in space or in the image, with selectable colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import PointCloud
from . import _check, _colors, _picture, _sample, _space
from ._extras import need

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped,unused-ignore]

Color: TypeAlias = Literal["rgb", "sigma", "depth", "slit"]
Photo: TypeAlias = NDArray[np.uint8] | NDArray[np.uint16]

#: Drawing a point takes microseconds on 2-D axes, and several times as much on 3-D axes.
_MOST_IN_SPACE, _MOST_IN_IMAGE = 30_000, 200_000


@dataclass(frozen=True)
class Scale:
    """A colour scale: values, their label, and the limits."""

    values: NDArray[np.float64]
    label: str
    cmap: Colormap
    limits: tuple[float, float]

    def colors(self) -> NDArray[np.float64]:
        """The values' colours, (N, 3) in 0 to 1."""
        low, high = self.limits
        share = np.clip((self.values - low) / (high - low), 0.0, 1.0)
        return np.asarray(self.cmap(share))[:, :3]


@overload
def cloud(
    cloud: PointCloud,
    color: Color = "rgb",
    ax: Axes3D | None = None,
    *,
    view: Literal["3d"] = "3d",
    limits: tuple[float, float] | None = None,
    cmap: str | None = None,
    size: float | None = None,
    max_points: int | None = None,
) -> Axes3D: ...
@overload
def cloud(
    cloud: PointCloud,
    color: Color = "rgb",
    ax: Axes | None = None,
    *,
    view: Literal["image"],
    image: Photo | None = None,
    limits: tuple[float, float] | None = None,
    cmap: str | None = None,
    size: float | None = None,
    max_points: int | None = None,
) -> Axes: ...
def cloud(
    cloud: PointCloud,
    color: Color = "rgb",
    ax: Axes | Axes3D | None = None,
    *,
    view: Literal["3d", "image"] = "3d",
    image: Photo | None = None,
    limits: tuple[float, float] | None = None,
    cmap: str | None = None,
    size: float | None = None,
    max_points: int | None = None,
) -> Axes | Axes3D:
    """Draw a cloud as dots, in space or in the image in which its points were seen.

    Parameters
    ----------
    cloud : PointCloud
        The points.
    color : "rgb", "sigma", "depth" or "slit"
        What the dots' colours say: the photograph's colour; 1σ along the camera's ray; depth (z: in the
        camera's frame the distance in front of it, in the sheet's frame the distance behind the sheet); or
        the slit, in colours of which neighbours differ most. A bar explains σ and depth in mm.
    ax : matplotlib.axes.Axes, optional
        Where to draw, 3-D axes for ``view="3d"`` (they are turned so that y points down), flat ones for
        ``view="image"``; by default the axes of a new pyplot figure.
    view : "3d" or "image"
        Points in 3-D, or their pixels in the image.
    image : ndarray, optional
        The photograph to draw dimmed below the pixels, with ``view="image"``: (H, W, 3) or (H, W), uint8 or
        uint16.
    limits : (float, float), optional
        Limits of the scale of σ or depth, mm; by default the 2nd and 98th percentile, so that a few outliers do
        not take all the colours.
    cmap : str, optional
        Name of a matplotlib colour map for σ or depth.
    size : float, optional
        Area of a dot, points² (matplotlib's ``s``).
    max_points : int, optional
        Maximum number of points to draw, by default 30,000 in 3-D and 200,000 in the image; a reproducible random
        choice of a larger cloud. In 3-D, points farther from the interquartile range than eight times its width
        are omitted; their number is below the figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: in millimetres, equally scaled (an ``Axes3D``), or in pixels.

    Raises
    ------
    ImportError
        When matplotlib is not installed.
    TypeError
        When `cloud` is not a cloud, or `image` is not an array of uint8 or uint16.
    slcal.Error
        When the cloud is empty, has no values for the colours or no pixels, its pixels lie outside the image,
        or the axes are of the other kind.

    Examples
    --------
    >>> import numpy as np, slcal, slcal.viz
    >>> x, y = (v.ravel() for v in np.meshgrid(np.arange(20.0), np.arange(10.0)))
    >>> board = slcal.PointCloud(np.column_stack([x, y, 900.0 + 0.1 * x]))
    >>> ax = slcal.viz.cloud(board, "depth")
    >>> ax.get_zlabel()
    'z, mm (forward)'
    """
    points = _check.cloud(cloud)
    if view not in ("3d", "image"):
        raise Error(f'view: expected "3d" or "image", found {view!r}')
    if limits is not None and not (np.isfinite(limits).all() and limits[0] < limits[1]):
        raise Error(f"limits: expected two numbers, the smaller one first, found {limits!r}")
    if max_points is not None:
        _check.positive(max_points, "max_points")
    scale = scale_of(points, color)
    if scale is not None:
        colors = scale.cmap if cmap is None else _named(cmap)
        scale = Scale(scale.values, scale.label, colors, limits or scale.limits)
    if view == "image":
        return _in_image(points, color, scale, ax, image, size, max_points or _MOST_IN_IMAGE)
    if image is not None:
        raise Error('image: a photograph goes with view="image"; leave it out or ask for that view')
    return _in_space(points, color, scale, ax, size, max_points or _MOST_IN_SPACE)


def _named(cmap: str) -> Colormap:
    maps = need("matplotlib").colormaps
    if cmap not in maps:
        raise Error(
            f"cmap: expected the name of a matplotlib colour map, found {cmap!r}; "
            "list(matplotlib.colormaps) has them"
        )
    found: Colormap = maps[cmap]
    return found


def scale_of(cloud: PointCloud, color: str) -> Scale | None:
    """The numbers that colours stand for; None where colours are colours.

    Raises
    ------
    slcal.Error
        When the cloud does not know them, or nothing is called so.
    """
    if color == "depth":
        depth = cloud.points[:, 2]
        name = "depth" if cloud.frame == "camera" else "behind the sheet"
        return Scale(depth, f"{name}, mm", _colors.scale("viridis"), _colors.robust_range(depth))
    if color == "sigma":
        sigma = cloud.sigma
        if not sigma.any():  # Zero where it is not known.
            raise Error(
                "color: expected a cloud that knows its points' σ, found none of them known; "
                'reconstruct with a rig that slcal calibrated, or choose "depth"'
            )
        return Scale(
            sigma,
            "1σ along the camera's ray, mm",
            _colors.scale("plasma"),
            _colors.robust_range(sigma),
        )
    if color not in ("rgb", "slit"):
        raise Error(f'color: expected "rgb", "sigma", "depth" or "slit", found {color!r}')
    return None


def plain_colors(cloud: PointCloud, color: str) -> NDArray[np.float64]:
    """Colours that are no numbers' scale, (N, 3) in 0 to 1."""
    return _colors.of_slits(cloud.slits) if color == "slit" else np.asarray(cloud.colors / 255.0)


def _dots(cloud: PointCloud, color: str, scale: Scale | None, keep: NDArray[np.intp]) -> dict[str, Any]:
    """What scatter is told about colours."""
    if scale is None:
        return {"c": plain_colors(cloud, color)[keep]}
    low, high = scale.limits
    return {"c": scale.values[keep], "cmap": scale.cmap, "vmin": low, "vmax": high}


def _bar(ax: Any, dots: Any, scale: Scale | None) -> None:
    if scale is None:
        return
    low, high = scale.limits
    below, above = bool((scale.values < low).any()), bool((scale.values > high).any())
    extend = "both" if below and above else "min" if below else "max" if above else "neither"
    ax.figure.colorbar(
        dots,
        ax=ax,
        label=scale.label,
        extend=extend,
        shrink=0.8,
        pad=0.08 if hasattr(ax, "get_zlim") else 0.02,
    )


def _in_space(
    cloud: PointCloud, color: str, scale: Scale | None, ax: Any, size: float | None, most: int
) -> Axes3D:
    ax = _space.axes(ax)
    points = cloud.points
    near = np.flatnonzero(_space.near(points))
    keep = near[_sample.spread(len(near), most)]
    size = size or float(np.clip(30_000 / len(keep), 1.0, 12.0))
    colors = _dots(cloud, color, scale, keep)
    dots = ax.scatter(*points[keep].T, s=size, linewidths=0, depthshade=False, gid="cloud", **colors)
    _space.limits(ax, points[near])
    _space.name(ax, cloud.frame)
    _bar(ax, dots, scale)
    if len(near) < len(points):
        missing = f"{len(points) - len(near)} of {len(points)} points lie far outside"
        ax.text2D(0.5, 0.0, missing, transform=ax.transAxes, ha="center")
    return ax


def _in_image(
    cloud: PointCloud,
    color: str,
    scale: Scale | None,
    ax: Any,
    image: Photo | None,
    size: float | None,
    most: int,
) -> Axes:
    pixels = cloud.pixels
    if len(pixels) != len(cloud) or not np.isfinite(pixels).all():
        raise Error(
            "cloud: expected one that knows its points' pixels, found none; "
            "use the cloud that reconstruct returns"
        )
    picture = None if image is None else _check.image(image)
    if picture is not None:
        _check.pixels_in(pixels, picture, "cloud")
        width, height = float(picture.shape[1]), float(picture.shape[0])
    else:
        width, height = (float(n) for n in np.ptp(pixels, axis=0) + 1.0)
    flat = _picture.axes(ax, width, height)
    if picture is not None:
        _picture.show(flat, _picture.dimmed(_picture.displayed(picture, "srgb")))
    else:
        _frame(flat, pixels)
    keep = _sample.spread(len(pixels), most)
    colors = _dots(cloud, color, scale, keep)
    x, y = pixels[keep].T
    dots = flat.scatter(x, y, s=size or 2.0, linewidths=0, gid="cloud", **colors)
    _bar(flat, dots, scale)
    return flat


def _frame(ax: Axes, pixels: NDArray[np.float64]) -> None:
    """Flat axes as an image has them, around the pixels alone."""
    (left, top), (right, bottom) = pixels.min(axis=0), pixels.max(axis=0)
    margin = 0.02 * max(right - left, bottom - top, 1.0)
    ax.set_xlim(left - margin, right + margin)
    ax.set_ylim(bottom + margin, top - margin)
    ax.set_aspect("equal")
    ax.set_xlabel("x, px")
    ax.set_ylabel("y, px")
