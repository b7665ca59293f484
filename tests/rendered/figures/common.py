"""What every check uses: the table of figures, the binary, the scenes."""

import json
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from .shortfalls import KNOWN_SHORTFALLS

SCENES = ["paper_tilted", "paper_lensshift", "near_frontal", "dark_clutter", "pair_a", "pair_b"]
STRIPED_SCENES = ["paper_tilted", "paper_lensshift"]


class Table:
    """The figures beside their bounds; `brief` prints those alone that are missed."""

    def __init__(self, brief=False):
        self.brief = brief
        self.failed = self.passed = self.known = 0

    def row(self, what, measured, bound, holds):
        reason = KNOWN_SHORTFALLS.get(what)
        self.passed += bool(holds)
        self.known += not holds and reason is not None
        self.failed += not holds and reason is None
        if holds and reason:
            bound = f"{bound} (holds: no longer a known shortfall)"
        elif reason:
            bound = f"{bound} (known: {reason})"
        if holds and self.brief and not reason:
            return
        print(f"{'ok  ' if holds else 'MISS'} {what:58s} {measured:>22s}   asked: {bound}", flush=True)

    def at_most(self, what, value, bound, unit=""):
        if value is None:
            self.row(what, "no result", f"<= {bound:g}{unit}", False)
        else:
            self.row(what, f"{value:.4f}{unit}", f"|x| <= {bound:g}{unit}", abs(value) <= bound)

    def at_least(self, what, value, bound, unit=""):
        if value is None:
            self.row(what, "no result", f">= {bound:g}{unit}", False)
        else:
            self.row(what, f"{value:.3f}{unit}", f">= {bound:g}{unit}", value >= bound)

    def between(self, what, value, low, high, unit=""):
        asked = f"{low:g} to {high:g}{unit}"
        if value is None:
            self.row(what, "no result", asked, False)
        else:
            self.row(what, f"{value:.2f}{unit}", asked, low <= value <= high)


def run(*command):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True)


def size_of(truth):
    return "x".join(f"{s:g}" for s in truth["views"][0]["size_mm"]) + "mm"


def calibrate(slcal, photo, size, out, *more):
    return run(slcal, "calibrate", photo, "--size", size, "-o", out, "--force", *more)


@dataclass
class Context:
    """The binary, the data beside the repository, a folder for files, and how many processes may run at once."""

    slcal: Path
    shared: Path
    tmp: Path
    jobs: int = 2
    # Variants of the photographs to try; none named: all.
    variants: tuple = ()

    @property
    def rendered(self):
        return self.shared / "data/rendered"

    def truth_rig(self, scene):
        return json.loads((self.rendered / scene / "truth_rig.json").read_text())

    def own_rig(self, scene):
        """The rig from the scene's one photograph, calibrated once; None when that fails."""
        out = self.tmp / f"own_{scene}.json"
        if not out.exists():
            folder = self.rendered / scene
            calibrate(self.slcal, folder / "checker.png", size_of(self.truth_rig(scene)), out, "--pattern", folder / "patterns/checker.json")
        return out if out.exists() else None

    def score(self, scenes):
        """Rows of the scorer over these scenes, or None when it does not run."""
        folders = [self.rendered / s for s in scenes]
        scorer = run(sys.executable, self.shared / "tools/score_rendered.py", "--slcal", self.slcal, *folders, "--json")
        if scorer.returncode:
            print(scorer.stderr, file=sys.stderr)
            return None
        return json.loads(scorer.stdout)

    @cached_property
    def striped_scores(self):
        return self.score(STRIPED_SCENES)

    @cached_property
    def scores(self):
        """Rows of the scorer over all scenes; those with stripes are not scored twice."""
        if self.striped_scores is None:
            return None
        rest = self.score([s for s in SCENES if s not in STRIPED_SCENES])
        return None if rest is None else self.striped_scores + rest


def photo_of(folder, name):
    """NAME.png or NAME.jpg of a scene."""
    path = folder / f"{name}.png"
    return path if path.exists() else folder / f"{name}.jpg"


def calibrate_scenes(ctx, scenes, screen=False, more=()):
    """The rig of the scenes' photographs together, or None, and the exit code; with `screen` also from those without the pattern."""
    folders = [ctx.rendered / s for s in scenes]
    out = ctx.tmp / "scenes.json"
    screens = [x for f in folders for x in ("--screen", photo_of(f, "screen"))] if screen else []
    pattern = ["--pattern", folders[0] / "patterns/checker.json"]
    photos = [photo_of(f, "checker") for f in folders]
    size = size_of(ctx.truth_rig(scenes[0]))
    r = run(ctx.slcal, "calibrate", *photos, "--size", size, "-o", out, "--force", *pattern, *screens, *more)
    return (json.loads(out.read_text()) if r.returncode == 0 else None), r.returncode
