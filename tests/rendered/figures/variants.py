"""The striped photographs as other cameras, objects and projectors would have given them."""

import functools
import struct
import zlib
from dataclasses import dataclass
from typing import Callable

import numpy as np
from PIL import Image

NOISE_CODES = 3.0
BLUR_PX = 1.5
ALBEDO = (0.7, 0.35, 0.25)
# Too strong for the stripes' photograph alone.
STRONG_ALBEDO = (0.8, 0.2, 0.1)
# A fifth of the neighbouring channels' light: taken from the channel's own, and on top of it.
CROSSTALK = {
    "crosstalk mixed": [[0.8, 0.2, 0.0], [0.1, 0.8, 0.1], [0.0, 0.2, 0.8]],
    "crosstalk added": [[1.0, 0.2, 0.0], [0.2, 1.0, 0.2], [0.0, 0.2, 1.0]],
}
JPEG_QUALITY = 90


@dataclass
class Mapping:
    """Which pixels of a variant are judged, in pixels (x, y) of the photograph as rendered: `back` takes arrays x', y' to x, y;
    `part` is the part that is seen, (left, top, right, bottom), right and bottom excluded; None: all of it."""

    back: Callable = lambda x, y: (x, y)
    part: tuple | None = None


def linear(image):
    """Linear light, 0 to 1, of 8-bit sRGB codes."""
    x = np.arange(256) / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)[image]


def encoded(light):
    """8-bit sRGB codes of linear light; what is brighter than white is white."""
    x = np.clip(light, 0.0, 1.0)
    return np.round(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)).astype(np.uint8)


def blurred(light, sigma):
    """Convolved with a Gaussian; the border's pixels go on outside."""
    radius = int(np.ceil(4 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        pad = [(0, 0)] * light.ndim
        pad[axis] = (radius, radius)
        padded, n = np.pad(light, pad, mode="edge"), light.shape[axis]
        light = sum(k * np.take(padded, range(i, i + n), axis) for i, k in enumerate(kernel))
    return light


def resized(light, size):
    """Linear light at another size, (width, height): means of whole blocks when smaller, cubic when larger."""
    height, width = light.shape[:2]
    if size[0] < width:
        f = width // size[0]
        return light.reshape(height // f, f, width // f, f, 3).mean((1, 3))
    planes = [Image.fromarray(light[:, :, c].astype(np.float32), "F").resize(size, Image.Resampling.BICUBIC) for c in range(3)]
    return np.stack([np.asarray(p) for p in planes], 2)


def signed_distance(inside):
    """Pixels to the outline along a row, positive inside; far away where a row has none."""
    n = inside.shape[1]
    at, far = np.arange(n), 4 * n
    distance = []
    for wanted in (inside, ~inside):
        last = np.maximum.accumulate(np.where(wanted, at, -far), 1)
        following = np.minimum.accumulate(np.where(wanted, at, far)[:, ::-1], 1)[:, ::-1]
        distance.append(np.minimum(at - last, following - at))
    return distance[1] - distance[0]


def object_mask(truth, height):
    """Pixels of the object; between the rows whose truth is known its outline runs straight."""
    distance, rows = signed_distance(truth.obj), truth.rows
    above = np.clip(np.searchsorted(rows, np.arange(height), "right") - 1, 0, len(rows) - 2)
    w = np.clip((np.arange(height) - rows[above]) / (rows[above + 1] - rows[above]), 0.0, 1.0)[:, None]
    return (1 - w) * distance[above] + w * distance[above + 1] > 0


def noise(image, _):
    rng = np.random.default_rng(4)
    return np.clip(np.round(image + rng.normal(0, NOISE_CODES, image.shape)), 0, 255).astype(np.uint8), Mapping()


def crosstalk(matrix, image, _):
    return encoded(linear(image) @ np.array(matrix).T), Mapping()


def albedo_object(albedo, image, truth):
    mask = object_mask(truth, image.shape[0])[:, :, None]
    return encoded(linear(image) * np.where(mask, albedo, 1.0)), Mapping()


def all_at_once(image, truth):
    """Coloured object, crosstalk and blur, then noise."""
    mask = object_mask(truth, image.shape[0])[:, :, None]
    light = linear(image) * np.where(mask, ALBEDO, 1.0) @ np.array(CROSSTALK["crosstalk mixed"]).T
    return noise(encoded(blurred(light, BLUR_PX)), truth)


def scaled(factor, image, _):
    """Pixel centres: x' + 1/2 = factor (x + 1/2)."""
    size = round(image.shape[1] * factor), round(image.shape[0] * factor)
    return encoded(resized(linear(image), size)), Mapping(lambda x, y: ((x + 0.5) / factor - 0.5, (y + 0.5) / factor - 0.5))


def turned(quarters, image, _):
    """Turned clockwise by quarters of a circle."""
    h, w = image.shape[:2]
    back = {
        1: lambda x, y: (y, h - 1 - x),
        2: lambda x, y: (w - 1 - x, h - 1 - y),
        3: lambda x, y: (w - 1 - y, x),
    }
    return np.ascontiguousarray(np.rot90(image, -quarters)), Mapping(back[quarters])


def mirrored(image, _):
    w = image.shape[1]
    return np.ascontiguousarray(image[:, ::-1]), Mapping(lambda x, y: (w - 1 - x, y))


def cropped(share, image, _):
    """The middle; `share` of width and height."""
    h, w = image.shape[:2]
    left, top = round(w * (1 - share[0]) / 2), round(h * (1 - share[1]) / 2)
    right, bottom = w - left, h - top
    return np.ascontiguousarray(image[top:bottom, left:right]), Mapping(lambda x, y: (x + left, y + top), (left, top, right, bottom))


def exposed(factor, image, _):
    return encoded(factor * linear(image)), Mapping()


VARIANTS = {
    "as rendered": lambda image, _: (image, Mapping()),
    "noise 3": noise,
    "blur 1.5 px": lambda image, _: (encoded(blurred(linear(image), BLUR_PX)), Mapping()),
    **{name: functools.partial(crosstalk, matrix) for name, matrix in CROSSTALK.items()},
    "coloured object": functools.partial(albedo_object, ALBEDO),
    "all coloured": lambda image, _: (encoded(linear(image) * ALBEDO), Mapping()),
    "half size": functools.partial(scaled, 0.5),
    "double size": functools.partial(scaled, 2.0),
    "turned 90": functools.partial(turned, 1),
    "turned 180": functools.partial(turned, 2),
    "turned 270": functools.partial(turned, 3),
    "mirrored": mirrored,
    "16 bit": lambda image, _: (image.astype(np.uint16) * 257, Mapping()),
    "JPEG 90": lambda image, _: (image, Mapping()),
    "middle half": functools.partial(cropped, (0.5, 1.0)),
    "middle quarter": functools.partial(cropped, (0.25, 0.5)),
    "exposure x0.25": functools.partial(exposed, 0.25),
    "exposure x2": functools.partial(exposed, 2.0),
    "all at once": all_at_once,
    "with frames": lambda image, _: (image, Mapping()),
    "strong + frames": functools.partial(albedo_object, STRONG_ALBEDO),
}
# Those that are decoded with photographs of the dark and of the white projector beside the striped one, where there are any.
WITH_FRAMES = ("with frames", "strong + frames")


def make(name, photo, truth):
    """The variant's picture and its mapping back; `truth` may be None for those that do not ask which pixels are the object."""
    image = np.asarray(Image.open(photo).convert("RGB"))
    return VARIANTS[name](image, truth)


def png16(image, path):
    """A PNG of 16 bits per channel: Pillow writes none in colour."""
    h, w = image.shape[:2]
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in image)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", w, h, 16, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


def write(image, path):
    """Writes the picture by its ending; returns the path."""
    if image.dtype == np.uint16:
        png16(image, path)
    elif path.suffix == ".jpg":
        Image.fromarray(image).save(path, quality=JPEG_QUALITY)
    else:
        Image.fromarray(image).save(path, compress_level=1)
    return path
