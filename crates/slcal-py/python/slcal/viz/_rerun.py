"""Rig, cloud and photograph in the rerun viewer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._errors import Error
from .._slcal import Camera, PointCloud, Pose, Rig
from . import _check, _cloud, _colors
from ._extras import need
from ._residuals import outline_mm
from ._rig import in_camera

if TYPE_CHECKING:
    import rerun  # type: ignore[import-not-found,unused-ignore]


def to_rerun(
    rig: Rig | None = None,
    cloud: PointCloud | None = None,
    image: NDArray[np.uint8] | NDArray[np.uint16] | None = None,
    recording: rerun.RecordingStream | None = None,
    path: str = "slcal",
    *,
    color: _cloud.Color = "rgb",
    radius_mm: float | None = None,
) -> None:
    """Logs a rig, a cloud and a photograph to rerun.

    The entities are below `path`, in millimetres in the camera's frame (x right, y down, z forward): ``camera`` and
    ``projector`` as pinholes, the photograph as ``camera/image``, the outlines of the views' sheets as ``sheet/0``
    and so on, ``baseline`` and ``points``. The rig is logged as static. Cloud and image are logged at the
    recording's current time, so that frames of a video follow one another.

    Rerun's pinholes have no distortion, and their pixel corners are at integers. K is therefore logged with its
    principal point half a pixel further right and down. If the distortion is large, pass an undistorted
    photograph.

    Parameters
    ----------
    rig : Rig, optional
        Camera, projector and sheets to log.
    cloud : PointCloud, optional
        Points to log, all of them. A cloud in the frame of a sheet is transformed to the camera's by the rig's
        first view; without a rig it is logged unchanged.
    image : ndarray, optional
        Photograph to log, (H, W, 3) RGB or (H, W), uint8 or uint16, without loss.
    recording : rerun.RecordingStream, optional
        Where to log; by default the active recording that ``rerun.init`` makes.
    path : str
        Entity path of everything that is logged.
    color : "rgb", "sigma", "depth" or "slit"
        Meaning of the points' colours, as in `slcal.viz.cloud`.
    radius_mm : float, optional
        The points' radius; by default rerun chooses one.

    Raises
    ------
    ImportError
        When rerun-sdk (or, for the colours of σ and depth, matplotlib) is not installed.
    RuntimeError
        When there is no recording to log to.
    TypeError
        When an argument is something else.
    slcal.Error
        When nothing is given to log, the cloud is empty, or the image is not of the size of the rig's camera.

    Examples
    --------
    >>> import rerun as rr, slcal.viz  # doctest: +SKIP
    >>> rr.init("scan")  # doctest: +SKIP
    >>> rr.save("scan.rrd")  # doctest: +SKIP
    >>> slcal.viz.to_rerun(rig, cloud, image, color="sigma")  # doctest: +SKIP
    """
    rr = need("rerun")
    if rig is None and cloud is None and image is None:
        raise Error(
            "to_rerun: expected a rig, a cloud or an image, found none of them; there is nothing to log"
        )
    if rig is not None and not isinstance(rig, Rig):
        raise TypeError(f"rig: expected a slcal.Rig, found {type(rig).__name__}; slcal.calibrate makes one")
    picture = None if image is None else _check.image(image)
    if picture is not None and rig is not None:
        _check.image_of(picture, rig.camera)
    points = None if cloud is None else _points(rr, _check.cloud(cloud), rig, color, radius_mm)
    if recording is None and rr.get_data_recording() is None:
        raise RuntimeError(
            'rerun has no recording to log to: call rerun.init("name") first, or give recording='
        )

    def log(name: str, *entities: Any, static: bool = False) -> None:
        rr.log(f"{path}/{name}" if name else path, *entities, static=static, recording=recording, strict=True)

    log("", rr.ViewCoordinates.RDF, static=True)
    if rig is not None:
        _log_rig(rr, log, rig)
    if picture is not None:
        log("camera/image", rr.Image(picture, color_model="L" if picture.ndim == 2 else "RGB"))
    if points is not None:
        log("points", points)


def _log_rig(rr: Any, log: Any, rig: Rig) -> None:
    log("camera", _pinhole(rr, rig.camera, _colors.CAMERA), static=True)
    if rig.projector is not None and rig.projector_from_camera is not None:
        from_projector = rig.projector_from_camera.inverse()
        log(
            "projector",
            _pinhole(rr, rig.projector, _colors.PROJECTOR),
            _transform(rr, from_projector),
            static=True,
        )
        ends = [np.zeros(3), from_projector.t]
        log("baseline", rr.LineStrips3D([ends], colors=[_rgb(_colors.BASELINE)]), static=True)
    for number, view in enumerate(rig.views):
        corners = view.camera_from_sheet.transform(outline_mm(view.size_mm))
        ring = np.concatenate([corners, corners[:1]])
        outline = rr.LineStrips3D(
            [ring], colors=[_rgb(_colors.PLANE)], labels=[view.photo or f"sheet {number}"]
        )
        log(f"sheet/{number}", outline, static=True)


def _pinhole(rr: Any, device: Camera, color: str) -> Any:
    K = device.K.copy()
    K[:2, 2] += 0.5
    return rr.Pinhole(
        image_from_camera=K,
        resolution=[device.width, device.height],
        camera_xyz=rr.ViewCoordinates.RDF,
        color=_rgb(color),
    )


def _transform(rr: Any, parent_from_device: Pose) -> Any:
    return rr.Transform3D(translation=parent_from_device.t, mat3x3=parent_from_device.R)


def _points(rr: Any, cloud: PointCloud, rig: Rig | None, color: str, radius_mm: float | None) -> Any:
    scale = _cloud.scale_of(cloud, color)
    colors = _cloud.plain_colors(cloud, color) if scale is None else scale.colors()
    positions = cloud.points if rig is None else in_camera(cloud, rig)
    rgb = np.rint(255.0 * colors).astype(np.uint8)
    return rr.Points3D(positions, colors=rgb, radii=radius_mm)


def _rgb(color: str) -> list[int]:
    return [int(color[i : i + 2], 16) for i in (1, 3, 5)]
