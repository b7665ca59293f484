"""What cannot be decoded must be refused: exit code 3 or 4 and no file, never a cloud of nonsense."""

import json

import numpy as np
from PIL import Image

from . import variants
from .common import run

SCENE = "paper_tilted"
REFUSED = (3, 4)
EXPOSURE = 6.0
# Views that a wrong pattern is tried on: many stripes on a plane, few on a head before a wall, and broken ones.
WRONG_PATTERN_VIEWS = ("stripes_plane_a", "stripes_blob", "stripes_step")
# Other patterns that the binary draws: they share windows of the code, or its beginning, with the one that was projected.
DRAWN_PATTERNS = {
    "3 hues, order 4, 61 slits": ("--hues", 3, "--order", 4, "--slits", 61),
    "3 hues, order 3, 27 slits": ("--hues", 3, "--order", 3, "--slits", 27),
    "5 hues": ("--hues", 5),
    "5 hues, 125 slits": ("--hues", 5, "--slits", 125),
    "6 hues": ("--hues", 6),
    "40 slits": ("--slits", 40),
    "50 slits": ("--slits", 50),
}
# A share of errors that is no nonsense: what a photograph must reach that is decoded although it might be refused.
RIGHT_PERCENT = 99.0


def de_bruijn(hues, order, seed):
    """A random De Bruijn sequence: an Eulerian circuit through the words of `order` - 1 colours (Hierholzer)."""
    rng = np.random.default_rng(seed)
    unused = {}
    stack, circuit = [(0,) * (order - 1)], []
    while stack:
        edges = unused.setdefault(stack[-1], list(rng.permutation(hues)))
        if edges:
            stack.append((*stack[-1][1:], int(edges.pop())))
        else:
            circuit.append(stack.pop()[-1])
    return circuit[::-1][: hues**order]


def wrong_patterns(right, ctx):
    """Name -> pattern whose code is not the one that was projected."""
    hues, sequence = len(right["palette"]), right["sequence"]
    rng = np.random.default_rng(2)
    yield "hues shifted", {**right, "sequence": [(s + 1) % hues for s in sequence]}
    yield "palette shifted", {**right, "palette": right["palette"][1:] + right["palette"][:1]}
    yield "two hues swapped", {**right, "sequence": [{0: 1, 1: 0}.get(s, s) for s in sequence]}
    for i in range(3):
        yield f"order shuffled, {i}", {**right, "sequence": [int(s) for s in rng.permutation(sequence)]}
    for seed in range(5):
        yield f"another De Bruijn sequence, {seed}", {**right, "sequence": de_bruijn(hues, right["order"], seed)}
    for what, options in DRAWN_PATTERNS.items():
        out = ctx.tmp / "other.png"
        run(ctx.slcal, "pattern", "stripes", "--projector", "x".join(map(str, right["projector"])), *options, "-o", out, "--force")
        yield what, json.loads(out.with_suffix(".json").read_text())


def rows_pattern(right):
    """The same slits as rows of the panel."""
    width, height = right["projector"]
    centres = [(c + 0.5) * height / width - 0.5 for c in right["centres_px"]]
    return {**right, "axis": "rows", "centres_px": centres, "width_px": right["width_px"] * height / width}


class Refusals:
    """Runs the binary on what must be refused and notes what it did."""

    def __init__(self, table, ctx):
        self.table, self.ctx = table, ctx
        self.rig = ctx.rendered / SCENE / "truth_rig.json"

    def run(self, verb, photo, pattern):
        """Exit code, what was said first, and whether a file came out."""
        out = self.ctx.tmp / ("refused.csv" if verb == "decode" else "refused.ply")
        out.unlink(missing_ok=True)
        rig = ["--rig", self.rig] if verb == "reconstruct" else []
        r = run(self.ctx.slcal, verb, *rig, "--pattern", pattern, photo, "-o", out)
        said = r.stderr.strip().splitlines()
        return r.returncode, said[0] if said else "nothing said", out

    def expect(self, what, photo, pattern, verbs=("decode", "reconstruct")):
        for verb in verbs:
            code, said, out = self.run(verb, photo, pattern)
            refused = code in REFUSED and not out.exists()
            measured = f"exit {code}{', and a file' if out.exists() else ''}"
            self.table.row(f"{verb}, {what}", measured, "exit 3 or 4, no file", refused)
            if not refused:
                print(f"          {said[:200]}")


def check_photographs(refusals, ctx, folder, pattern):
    files = {
        "no stripes but a checkerboard": folder / "checker.png",
        "no stripes but a plain sheet": folder / "screen.png",
        "white light": folder / "stripes_sphere_white.png",
        "no light": folder / "stripes_sphere_black.png",
    }
    for what, photo in files.items():
        refusals.expect(what, photo, pattern)
    photo = Image.open(folder / "stripes_plane_a.png").convert("RGB")
    image = np.asarray(photo)
    made = {
        "all white": np.full_like(image, 255),
        "all black": np.zeros_like(image),
        "noise alone": np.random.default_rng(5).integers(0, 256, image.shape, dtype=np.uint8),
        "grey as a colour image": np.repeat(np.asarray(photo.convert("L"))[:, :, None], 3, 2),
        "greyscale": np.asarray(photo.convert("L")),
    }
    for what, picture in made.items():
        refusals.expect(what, variants.write(picture, ctx.tmp / "bad.png"), pattern)
    small = variants.write(np.asarray(photo.resize((800, 600))), ctx.tmp / "bad.png")
    refusals.expect("another size than the rig's camera", small, pattern, ["reconstruct"])


def check_overexposed(refusals, ctx, folder, pattern):
    """A photograph six times too bright: refused, or else right."""
    from .robustness import score_matches_of

    for view in ("stripes_plane_a", "stripes_blob"):
        image = np.asarray(Image.open(folder / f"{view}.png").convert("RGB"))
        photo = variants.write(variants.exposed(EXPOSURE, image, None)[0], ctx.tmp / "bad.png")
        code, _, out = refusals.run("decode", photo, pattern)
        measured, holds = f"exit {code}", code in REFUSED and not out.exists()
        if code == 0:
            right = score_matches_of(ctx, folder, view, out)["right"]
            measured, holds = f"exit 0, {right:.2f} % right", right >= RIGHT_PERCENT
        refusals.table.row(f"decode, {view[8:]} exposed x{EXPOSURE:g}", measured, f"exit 3 or 4, or {RIGHT_PERCENT:g} % right", holds)


def check_patterns(refusals, ctx, folder, pattern):
    right = json.loads(pattern.read_text())
    wrong = ctx.tmp / "wrong.json"
    for what, made in wrong_patterns(right, ctx):
        wrong.write_text(json.dumps(made))
        for view in WRONG_PATTERN_VIEWS:
            refusals.expect(f"{view[8:]}, {what}", folder / f"{view}.png", wrong)
    # To a camera that is turned or sees a part of the pattern these may be right: it takes the rig to know.
    sequence = right["sequence"]
    for what, made in {
        "sequence reversed": {**right, "sequence": sequence[::-1]},
        **{f"sequence moved on by {n}": {**right, "sequence": sequence[n:] + sequence[:n]} for n in (7, 31)},
        "slits as rows": rows_pattern(right),
    }.items():
        wrong.write_text(json.dumps(made))
        for view in WRONG_PATTERN_VIEWS:
            refusals.expect(f"{view[8:]}, {what}", folder / f"{view}.png", wrong, ["reconstruct"])
    wrong.write_text(json.dumps({**right, "projector": [1280, 800]}))
    refusals.expect("pattern of another panel", folder / "stripes_plane_a.png", wrong, ["reconstruct"])


def check_turned(refusals, ctx, folder, pattern):
    """Photographs that the rig cannot have taken: upside down, mirrored, and stripes that run the wrong way (the middle of
    the photograph turned by a quarter and set back where it was)."""
    for view in WRONG_PATTERN_VIEWS:
        image = np.asarray(Image.open(folder / f"{view}.png").convert("RGB"))
        h, w = image.shape[:2]
        left = (w - h) // 2
        wrong_way = image.copy()
        wrong_way[:, left : left + h] = np.rot90(image[:, left : left + h])
        wrong_way[:, :left] = wrong_way[:, left + h :] = 0
        for what, picture in {"upside down": image[::-1, ::-1], "mirrored": image[:, ::-1], "stripes the wrong way": wrong_way}.items():
            refusals.expect(f"{view[8:]}, {what}", variants.write(np.ascontiguousarray(picture), ctx.tmp / "bad.png"), pattern, ["reconstruct"])


def check(table, ctx):
    folder = ctx.rendered / SCENE
    pattern = folder / "patterns/stripes.json"
    refusals = Refusals(table, ctx)
    for part in (check_photographs, check_overexposed, check_patterns, check_turned):
        part(refusals, ctx, folder, pattern)
