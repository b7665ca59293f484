#!/usr/bin/env python3
"""Makes the pictures in docs/images of what slcal does, from the demonstration and from a simulated scene.

    scripts/pictures.py [--slcal target/release/slcal] [--only keystone,...]

Needs the Python package `slcal`, Pillow, plyfile and selenium (tests/requirements.txt has them), and Chromium with its driver for the
picture of the report.
"""

import argparse
import io
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import slcal
from PIL import Image, ImageDraw, ImageFont
from plyfile import PlyData
from slcal import simulate

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "browser"))
from browser import opened  # noqa: E402

IMAGES = ROOT / "docs" / "images"
#: Width of pictures in pages, px.
WIDTH = 900


def save(name: str, picture: Image.Image) -> None:
    """Writes a picture of at most `WIDTH` px: JPEG for photographs, PNG for pages."""
    if picture.width > WIDTH:
        picture = picture.resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.Resampling.LANCZOS)
    options = {"quality": 86, "optimize": True} if name.endswith(".jpg") else {"optimize": True}
    picture.convert("RGB").save(IMAGES / name, **options)
    print(f"docs/images/{name}: {picture.width}x{picture.height}")


def beside(left: Image.Image, right: Image.Image) -> Image.Image:
    """Two pictures of one height beside each other with a white gap."""
    gap = left.width // 60
    both = Image.new("RGB", (left.width + gap + right.width, left.height), "white")
    both.paste(left, (0, 0))
    both.paste(right, (left.width + gap, 0))
    return both


# ---------------------------------------------------------------------------------------------------------------------------
# What was found


def found(demo: Path) -> None:
    """The demonstration's overlays."""
    for name in ("sheet_found", "head_found"):
        save(f"{name}.jpg", Image.open(demo / f"{name}.png"))


# ---------------------------------------------------------------------------------------------------------------------------
# The report


def report(demo: Path) -> None:
    """What one sees first of the demonstration's report, and what is measured and in space further down."""
    with opened(demo / "report.html", size=(1180, 1400)) as page:

        def look(element: str) -> Image.Image:
            page.run(f"document.querySelector('{element}').scrollIntoView({{ block: 'center', behavior: 'instant' }})")
            time.sleep(1.0)
            return Image.open(io.BytesIO(page.pixels(element))).convert("RGB")

        verdict = look(".verdict")
        seen, space = look(".photos svg"), look("#space .cloud-view-stage")
    width = verdict.width
    below = beside(*(p.resize((p.width * 420 // p.height, 420), Image.Resampling.LANCZOS) for p in (seen, space)))
    below = below.resize((width, below.height * width // below.width), Image.Resampling.LANCZOS)
    both = Image.new("RGB", (width + 80, verdict.height + below.height + 120), "white")
    both.paste(verdict, (40, 40))
    both.paste(below, (40, verdict.height + 80))
    save("report.png", both)


# ---------------------------------------------------------------------------------------------------------------------------
# Keystone


def test_card(width: int, height: int) -> Image.Image:
    """A picture that shows at a glance whether it is square: rings, squares and a frame."""
    card = Image.new("RGB", (width, height), (12, 44, 84))
    draw = ImageDraw.Draw(card)
    step = height // 12
    for x in range(width // 2 % step, width, step):
        draw.line((x, 0, x, height), fill=(60, 110, 160), width=2)
    for y in range(height // 2 % step, height, step):
        draw.line((0, y, width, y), fill=(60, 110, 160), width=2)
    draw.rectangle((4, 4, width - 5, height - 5), outline="white", width=8)
    middle = (width / 2, height / 2)
    for radius, color in ((4.6, "white"), (4.2, (230, 159, 0)), (2.4, "white"), (2.0, (0, 114, 178))):
        draw.circle(middle, radius * step, fill=color)
    font = ImageFont.load_default(1.5 * step)
    draw.text(middle, "slcal", font=font, fill="white", anchor="mm")
    return card


def projected(scene: simulate.Scene, picture: np.ndarray) -> Image.Image:
    """The scene's photograph with `picture` projected instead of the pattern: light adds up, and a scene knows which of the
    projector's pixels each of the camera's looks at."""

    def linear(encoded: np.ndarray) -> np.ndarray:
        share = encoded.astype(float) / np.iinfo(encoded.dtype).max
        return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)

    def at(column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """Between the pixels of the picture, which light up around their centres."""
        light = np.pad(linear(picture), ((1, 1), (1, 1), (0, 0)))
        height, width = light.shape[:2]
        lit = np.isfinite(column) & np.isfinite(row)
        x, y = (np.clip(np.where(lit, c, -1.0) + 1.0, 0.0, size - 1.001) for c, size in ((column, width), (row, height)))
        left, top = x.astype(int), y.astype(int)
        by_x, by_y = (x - left)[..., None], (y - top)[..., None]
        upper = light[top, left] * (1 - by_x) + light[top, left + 1] * by_x
        lower = light[top + 1, left] * (1 - by_x) + light[top + 1, left + 1] * by_x
        return upper * (1 - by_y) + lower * by_y

    black, white = linear(scene.black), linear(scene.white)
    light = black + (white - black) * at(scene.column, scene.row)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.clip(light, 0, 1) ** (1 / 2.4) - 0.055)
    return Image.fromarray(np.round(np.clip(encoded, 0, 1) * 255).astype(np.uint8))


def from_the_front(photo: Image.Image, camera: slcal.Camera, view: slcal.View) -> Image.Image:
    """The photograph as somebody in front of the sheet sees it, with a border around the sheet."""
    border, per_mm = 70, 2.0
    width, height = ((side + 2 * border) * per_mm for side in view.size_mm)
    x, y = np.meshgrid(np.arange(width) / per_mm - border, np.arange(height) / per_mm - border)
    sheet = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    pixel = camera.project(sheet @ view.camera_from_sheet.R.T + view.camera_from_sheet.t)
    column, row = (np.round(pixel[:, i]).astype(int).clip(0, size - 1) for i, size in enumerate(photo.size))
    seen = np.asarray(photo)[row, column].reshape(*x.shape, 3)
    return Image.fromarray(seen).reduce(2)


def keystone() -> None:
    """A picture projected onto a tilted sheet as it is, and as slcal draws it for that sheet after one photograph."""
    checker = slcal.CheckerPattern(projector=(1024, 768))
    scene = simulate.scene(
        "sheet",
        checker,
        camera=(3840, 2880),
        focal=4500,
        tilt=(20, -35),
        projector_focal=2300,
        lens_shift=0.2,
        wall=350,
        blur=0,
        noise=0,
    )
    rig = slcal.calibrate([scene.photo], size_mm=(594, 420), pattern=checker)
    card = np.asarray(test_card(1024, 768))
    straight = rig.rectify(np.asarray(test_card(1188, 840)))
    before, after = (
        from_the_front(projected(scene, picture), rig.camera, rig.views[0]) for picture in (card, straight)
    )
    save("keystone.jpg", beside(before, after))


# ---------------------------------------------------------------------------------------------------------------------------
# A cloud


def vertex_normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals at the points, averaged over their surroundings: those of single triangles show the points' noise."""
    corners = points[triangles]
    of_triangles = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for _ in range(6):
        normals = np.zeros_like(points)
        for k in range(3):
            np.add.at(normals, triangles[:, k], of_triangles)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
        of_triangles = normals[triangles].sum(axis=1)
    return normals


def shaded(points: np.ndarray, triangles: np.ndarray, turn_deg: float, size: tuple[int, int]) -> Image.Image:
    """A mesh in the camera's frame as clay, turned about the upright axis through its middle, lit from the upper left."""
    a = np.radians(turn_deg)
    turn = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    p = (points - (points.min(axis=0) + points.max(axis=0)) / 2) @ turn.T
    scale = 0.92 * size[1] / np.ptp(p[:, 1])
    xy = (p[:, :2] - (p[:, :2].min(axis=0) + p[:, :2].max(axis=0)) / 2) * scale + np.array(size) / 2
    lamp = np.array([-0.45, -0.6, -0.66])
    light = np.abs(vertex_normals(p, triangles) @ lamp)[triangles].mean(axis=1)
    color = (np.array([222, 205, 182]) * (0.18 + 0.82 * light)[:, None]).clip(0, 255).astype(np.uint8)
    picture = Image.new("RGB", size, (24, 26, 30))
    draw = ImageDraw.Draw(picture)
    for i in np.argsort(-p[triangles][:, :, 2].mean(axis=1)):
        draw.polygon([tuple(q) for q in xy[triangles[i]]], fill=tuple(color[i]))
    return picture


def nearest_part(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What stands before the widest gap in depth: the object without the wall behind it."""
    depth = np.sort(points[:, 2])
    inner = slice(len(depth) // 20, -len(depth) // 20)
    gap = np.argmax(np.diff(depth[inner])) + inner.start
    near = points[:, 2] <= depth[gap]
    triangles = triangles[near[triangles].all(axis=1)]
    return points[near], np.cumsum(near)[triangles] - 1


def cloud(demo: Path) -> None:
    """The demonstration's head: the photograph, and the mesh from two sides."""
    ply = PlyData.read(demo / "cloud.ply")
    points = np.column_stack([ply["vertex"][c] for c in "xyz"]).astype(float)
    head = nearest_part(points, np.vstack(ply["face"].data["vertex_indices"]))
    photo = Image.open(demo / "head.jpg")
    photo = photo.crop(((photo.width - photo.height) // 2, 0, (photo.width + photo.height) // 2, photo.height))
    left, right = (shaded(*head, turn, (1000, 1400)) for turn in (14, -24))
    save("cloud.jpg", beside(beside(photo.resize((1400, 1400)), left), right))


# ---------------------------------------------------------------------------------------------------------------------------


def studio(slcal_command: Path) -> None:
    """The studio's demonstration, as its test walks through it."""
    check = ROOT / "tests" / "browser" / "check_studio.py"
    with tempfile.TemporaryDirectory() as folder:
        walk = ["--only", "two_photographs", "--pictures", folder]
        subprocess.run([sys.executable, check, "--slcal", slcal_command, *walk], check=True, stdout=subprocess.DEVNULL)
        for shown, name in {"2-display-open": "set-up", "4-one-photograph": "calibrate", "6-cloud": "scan", "8-use": "use"}.items():
            page = Image.open(Path(folder) / f"{shown}-desk-light.png")
            # Below stands the folder of this walk.
            save(f"studio-{name}.jpg", page.crop((0, 0, page.width, page.height * 23 // 25)) if name == "use" else page)
        phones = [Image.open(Path(folder) / f"{shown}-phone-light.png") for shown in ("4-one-photograph", "6-cloud")]
        height = min(p.height for p in phones)
        save("studio-phone.jpg", beside(*(p.crop((0, 0, p.width, height)) for p in phones)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--slcal", type=Path, default=ROOT / "target" / "release" / "slcal")
    parser.add_argument("--only", default="found,report,keystone,cloud,studio")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        demo = Path(folder) / "demo"
        subprocess.run([args.slcal, "demo", "--out", demo], check=True, stdout=subprocess.DEVNULL)
        makers = {
            "found": lambda: found(demo),
            "report": lambda: report(demo),
            "keystone": keystone,
            "cloud": lambda: cloud(demo),
            "studio": lambda: studio(args.slcal.resolve()),
        }
        for name in args.only.split(","):
            if name not in makers:
                sys.exit(f"--only {name}: expected some of {', '.join(makers)}")
            makers[name]()


if __name__ == "__main__":
    main()
