"""Stripes decoded and points reconstructed from the photographs as they are, as the scorer counts them."""

VIEWS = ["stripes_plane_a", "stripes_plane_b", "stripes_sphere", "stripes_step", "stripes_blob"]

RIGHT_PERCENT = 99.8
FOUND_PERCENT = 98.0
BLOB_FOUND_PERCENT = 96.0
BIAS_PX = 0.02
# Of the projector's column, and of the depth with the true rig: planes and the sphere, the rest.
RMS_PX = {True: 0.10, False: 0.20}
P50_PERCENT = {True: 0.02, False: 0.04}
OFF_PERCENT = 0.1
# Of the depth, with the rig from one photograph.
OWN_P50_PERCENT = 0.2
SHOWN = ("right", "found", "bias", "rms", "p50", "p95", "off")


def is_smooth(view):
    """Planes and the sphere: without edges of depth on the object."""
    return "plane" in view or "sphere" in view


def check(table, ctx):
    rows = ctx.striped_scores
    if rows is None:
        table.row("the scorer runs", "failed", "exit 0", False)
        return
    rows = [r for r in rows if r["view"] in VIEWS]
    print(f"     {'':36s}" + "".join(f"{name:>9s}" for name in SHOWN))
    for r in rows:
        values = "".join(f"{r[name]:9.4f}" if name in r else f"{'-':>9s}" for name in SHOWN)
        print(f"     {r['scene']:16s} {r['view'][8:]:10s} {r['rig']:8s}{values}  {r.get('error', '')}", flush=True)
    for r in rows:
        what, smooth = f"{r['scene']}, {r['view'][8:]}", is_smooth(r["view"])
        if r["rig"] == "own":
            table.at_most(f"{what}, own rig: median error", r.get("p50"), OWN_P50_PERCENT, " % of depth")
            continue
        table.at_least(f"{what}: right", r.get("right"), RIGHT_PERCENT, " %")
        table.at_least(f"{what}: found", r.get("found"), BLOB_FOUND_PERCENT if "blob" in what else FOUND_PERCENT, " %")
        table.at_most(f"{what}: bias", r.get("bias"), BIAS_PX, " px")
        table.at_most(f"{what}: rms", r.get("rms"), RMS_PX[smooth], " px")
        table.at_most(f"{what}: median error", r.get("p50"), P50_PERCENT[smooth], " % of depth")
        table.at_most(f"{what}: off the surface", r.get("off"), OFF_PERCENT, " %")
