"""Camera, projector and sheets in space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import Camera, PointCloud, Pose, Rig
from . import _check, _colors, _sample, _space
from ._extras import need
from ._residuals import outline_mm

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped,unused-ignore]

#: Depth of a device's pyramid, as a share of the distance to the scene.
_DEPTH_SHARE = 0.22
#: Depth without sheet and cloud: as a multiple of the baseline, or without a projector in mm.
_DEPTH_BASELINES, _DEPTH_ALONE_MM = 0.8, 300.0
#: Number of straight segments along a side of the image, since distortion bends it.
_PARTS = 12


def rig(
    rig: Rig,
    ax: Axes3D | None = None,
    *,
    cloud: PointCloud | None = None,
    max_points: int = 5000,
    depth_mm: float | None = None,
) -> Axes3D:
    """Draws camera and projector as view pyramids, and the sheets of the views.

    The axes are those of the camera's frame. The bases of the pyramids are the borders of the image and of the
    projector's panel, with a thick top side; lens shift makes the projector's pyramid oblique. A line joins the
    two centres. The sheet of each view is a quadrilateral with its top left corner marked TL.

    Parameters
    ----------
    rig : Rig
        With or without a projector.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        3-D axes to draw on; by default those of a new pyplot figure. They are turned so that y points down.
    cloud : PointCloud, optional
        Points to draw in their colours, in the camera's frame or in that of the first view's sheet.
    max_points : int
        Maximum number of points to draw; a reproducible random choice of a larger cloud.
    depth_mm : float, optional
        Depth of the pyramids along the optical axes; by default a share of the distance to sheets and cloud.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
        The axes, in millimetres, equally scaled.

    Raises
    ------
    ImportError
        When matplotlib is not installed.
    TypeError
        When `rig` or `cloud` is something else.
    slcal.Error
        When `ax` is flat, the cloud is empty, or its frame is a sheet that the rig does not know.

    Examples
    --------
    >>> import slcal, slcal.viz
    >>> camera = slcal.Camera.from_fov((1280, 960), 45.0)
    >>> projector = slcal.Camera.from_throw((1024, 768), 1.5)
    >>> pose = slcal.Pose([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [-200.0, 0.0, 0.0])
    >>> ax = slcal.viz.rig(slcal.Rig(camera, projector, pose))
    >>> ax.get_title()
    'baseline 200.0 mm'
    """
    _check.rig(rig)
    _check.positive(max_points, "max_points")
    if depth_mm is not None and not (np.isfinite(depth_mm) and depth_mm > 0):
        raise Error(f"depth_mm: expected a positive number, found {depth_mm}")
    points = None if cloud is None else in_camera(_check.cloud(cloud), rig)
    ax = _space.axes(ax)
    views = rig.views
    sheets = [v.camera_from_sheet.transform(outline_mm(v.size_mm)) for v in views]
    shown = [np.zeros((1, 3)), *sheets]
    if cloud is not None and points is not None:
        keep = np.flatnonzero(_space.near(points))
        keep = keep[_sample.spread(len(keep), max_points)]
        shown.append(points[keep])
        _scatter(ax, points[keep], cloud.colors[keep])
    depth = _depth(rig, shown[1:]) if depth_mm is None else depth_mm
    shown.append(_device(ax, rig.camera, None, depth, "camera", _colors.CAMERA))
    if rig.projector is not None and rig.projector_from_camera is not None:
        from_projector = rig.projector_from_camera.inverse()
        shown.append(_device(ax, rig.projector, from_projector, depth, "projector", _colors.PROJECTOR))
        _baseline(ax, from_projector.t)
    for number, corners in enumerate(sheets):
        _sheet(ax, corners, "sheet" if len(sheets) == 1 else f"sheet {number + 1}", 0.3 / len(sheets) ** 0.5)
    _space.limits(ax, np.concatenate(shown))
    _space.name(ax, "camera")
    title = _title(rig)
    if title:
        ax.set_title(title)
    return ax


def in_camera(cloud: PointCloud, rig: Rig) -> NDArray[np.float64]:
    """The cloud's points in the camera's frame, (N, 3) mm."""
    if cloud.frame == "camera":
        return cloud.points
    views = rig.views
    if not views:
        raise Error(
            'cloud: expected one in the camera\'s frame, found frame "plane", and the rig has no view '
            'whose sheet that could be; reconstruct with frame="camera"'
        )
    return views[0].camera_from_sheet.transform(cloud.points)


def border_px(camera: Camera, parts: int) -> NDArray[np.float64]:
    """The image's outer border, (4 · parts + 1, 2), closed, from the top left corner along the top side."""
    right, bottom = camera.width - 0.5, camera.height - 0.5
    corners = np.array([[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom], [-0.5, -0.5]])
    share = np.arange(parts)[:, None] / parts
    sides = [a + share * (b - a) for a, b in zip(corners[:-1], corners[1:], strict=True)]
    return np.concatenate([*sides, corners[:1]])


def rays(camera: Camera, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Viewing directions (N, 3) of pixels, z = 1; undistorted only where the distortion model has an inverse."""
    try:
        directions = camera.rays(pixels)
        if np.isfinite(directions).all():
            return np.asarray(directions / directions[:, 2:])
    except Error:
        pass
    return np.asarray(np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(camera.K).T)


def _depth(rig: Rig, seen: list[NDArray[np.float64]]) -> float:
    if seen:
        return _DEPTH_SHARE * float(np.median(np.concatenate(seen)[:, 2]))
    return _DEPTH_BASELINES * rig.baseline_mm if rig.baseline_mm else _DEPTH_ALONE_MM


def _device(
    ax: Axes3D, device: Camera, camera_from_device: Pose | None, depth_mm: float, name: str, color: str
) -> NDArray[np.float64]:
    """A pyramid from the device's centre to its image's border; returns its points."""
    base = depth_mm * rays(device, border_px(device, _PARTS))
    points = np.concatenate([np.zeros((1, 3)), base])
    if camera_from_device is not None:
        points = camera_from_device.transform(points)
    centre, base = points[0], points[1:]
    art3d = need("mpl_toolkits.mplot3d.art3d")
    faces = art3d.Poly3DCollection([base], facecolor=color, alpha=0.18, edgecolor="none", gid=f"{name}-image")
    ax.add_collection3d(faces)
    ax.plot(*base.T, color=color, linewidth=1.3, gid=f"{name}-border")
    ax.plot(*base[: _PARTS + 1].T, color=color, linewidth=3.0, solid_capstyle="butt", gid=f"{name}-top")
    for corner in base[:-1:_PARTS]:
        ax.plot(*np.stack([centre, corner]).T, color=color, linewidth=1.0, gid=f"{name}-edge")
    ax.plot(*centre[:, None], "o", color=color, markersize=5, gid=f"{name}-centre")
    _text(ax, centre, name, color, up=9)
    return points


def _text(ax: Axes3D, at: NDArray[np.float64], text: str, color: str, up: float = 0.0) -> None:
    """A name a little above a point of space, wherever that is on the picture."""
    effects = need("matplotlib.patheffects")
    offset = need("matplotlib.transforms").ScaledTranslation(0.0, up / 72.0, ax.figure.dpi_scale_trans)
    written = ax.text(*at, text, color=color, ha="center", va="bottom", fontweight="bold", fontsize=10)
    written.set_transform(ax.transData + offset)
    written.set_path_effects([effects.withStroke(linewidth=2.5, foreground=ax.get_facecolor())])


def _baseline(ax: Axes3D, projector: NDArray[np.float64]) -> None:
    ends = np.stack([np.zeros(3), projector])
    ax.plot(*ends.T, "--", color=_colors.BASELINE, linewidth=1.8, gid="baseline")


def _sheet(ax: Axes3D, corners: NDArray[np.float64], name: str, alpha: float) -> None:
    art3d = need("mpl_toolkits.mplot3d.art3d")
    ax.add_collection3d(
        art3d.Poly3DCollection([corners], facecolor=_colors.PLANE, alpha=alpha, edgecolor="none", gid=name)
    )
    ring = np.concatenate([corners, corners[:1]])
    ax.plot(*ring.T, color=_colors.PLANE, linewidth=1.3, gid=f"{name}-outline")
    _text(ax, corners[0], f"TL of {name}", _colors.PLANE)


def _scatter(ax: Axes3D, points: NDArray[np.float64], colors: NDArray[Any]) -> None:
    ax.scatter(*points.T, c=colors / 255.0, s=4.0, linewidths=0, depthshade=False, gid="cloud")


def _title(rig: Rig) -> str:
    quality, baseline, sigma = rig.quality, rig.baseline_mm, rig.baseline_sigma_mm
    parts: list[str] = [] if quality is None else [f"verdict {quality.verdict}"]
    if baseline is not None:
        parts.append(f"baseline {baseline:.1f}" + ("" if sigma is None else f" \u00b1 {sigma:.1f}") + " mm")
    return ", ".join(parts)
