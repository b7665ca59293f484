"""The memory that a 24-megapixel photograph takes."""

import sys

from .common import run, size_of

MEMORY_BOUND_GIB = 1.5


def peak_memory_gib(*command):
    """Exit code and peak resident memory of one command."""
    script = "import resource,subprocess,sys; c=subprocess.run(sys.argv[1:],stdout=subprocess.DEVNULL).returncode; print(c, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    out = run(sys.executable, "-c", script, *command)
    code, kib = out.stdout.split()
    return int(code), int(kib) / 2**20, out.stderr


def check(table, ctx):
    from PIL import Image

    scene = ctx.rendered / "paper_tilted"
    truth = ctx.truth_rig("paper_tilted")
    size = (5664, 4248)
    for name in ("checker", "stripes_blob"):
        Image.open(scene / f"{name}.png").convert("RGB").resize(size, Image.Resampling.BICUBIC).save(ctx.tmp / f"{name}.png", compress_level=1)
    patterns = scene / "patterns"
    for what, command in {
        "calibrate": ["calibrate", ctx.tmp / "checker.png", "--size", size_of(truth), "--pattern", patterns / "checker.json", "-o", ctx.tmp / "large.json", "--force"],
        "reconstruct": ["reconstruct", "--rig", ctx.tmp / "large.json", "--pattern", patterns / "stripes.json", ctx.tmp / "stripes_blob.png", "-o", ctx.tmp / "large.ply", "--force"],
    }.items():
        code, gib, said = peak_memory_gib(ctx.slcal, *map(str, command))
        if code:
            print(said, file=sys.stderr)
        table.row(f"24 megapixels, {what}: memory", f"exit {code}, {gib:.2f} GiB", f"exit 0, <= {MEMORY_BOUND_GIB} GiB", code == 0 and gib <= MEMORY_BOUND_GIB)
