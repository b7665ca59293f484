"""A door at four angles, calibrated from one photograph of itself and reconstructed from one more."""

import json

# R. Orghidan, J. Salvi, M. Gordan, C. Florea, J. Batlle, "Structured light self-calibration with vanishing points",
# Machine Vision and Applications 25:489-500 (2014), Table 2: mean distance of the points from the fitted plane, per cent of the
# distance to the system, and standard deviation.
PAPER = [(3.55, 1.37), (3.25, 1.18), (3.25, 1.20), (3.20, 1.21)]
# Tilts of the doors, degrees, that the paper's vanishing points imply: with its principal point in the middle, door 1 gives a
# focal length of 1.6 widths, and that the angles.
TILTS = ["27,5.8", "27,1.9", "27,-2.3", "27,-7.8"]
# A third of the paper's 4752 x 3168 px with the same angle of view, at 1.5 m; a panel of known size in the door's plane.
SIZE = "700x480mm"
PLACE = f"--distance 1500 --size {SIZE}"
RIG = f"--camera 1584x1056 --focal 2527 --baseline 375 {PLACE}"
# What rigs are like: principal points off the centre, px, and a lens that bends.
ORDINARY = "--camera-offset 12,-9 --projector-offset -8 --distortion -0.08,0.02"
DOOR = "--surface sheet --wall 0.01 --wall-albedo 0.35"
NOISY = "--noise 2 --blur 0.8 --crosstalk 0.1"
# What: (options of the photograph, whether the rig is an ordinary one).
PICTURES = {
    "exact": ("--exact", False),
    "noisy": (NOISY, False),
    "noisy, ordinary rig": (NOISY, True),
}
METHODS = ["ml", "two-vp"]


def flatness(slcal, folder, rig):
    """Reconstruct the door with a rig: (mean, std) of the distances from the fitted plane, per cent, and the points; or why not."""
    cloud = folder / "cloud.ply"
    pattern = folder / "stripes/pattern.json"
    photo = folder / "stripes/photo.png"
    run = slcal(f"reconstruct --rig {rig} --pattern {pattern} {photo} -o {cloud} --force", check=False)
    if run.returncode:
        return None
    report = json.loads(slcal(f"evaluate plane {cloud} --json").stdout)
    return report["mean_percent"], report["std_percent"], report["inliers"], report["outlier_share"]


def door(slcal, folder, tilt, picture, rig):
    """All rigs at one angle: {rig: what flatness gives}, and each method's error of the camera's focal length, per cent."""
    scene = f"simulate scene {rig} {DOOR} --tilt {tilt} {picture} --force"
    slcal(f"{scene} --pattern checker --seed 1 --out {folder}/checker")
    slcal(f"{scene} --pattern stripes --seed 2 --out {folder}/stripes")
    truth = folder / "checker/rig.json"
    results, focal = {"true rig": flatness(slcal, folder, truth)}, {}
    true_focal = json.loads(truth.read_text())["camera"]["K"][0][0]
    for method in METHODS:
        rig = folder / f"{method}.json"
        photo, pattern = folder / "checker/photo.png", folder / "checker/pattern.json"
        line = f"calibrate {photo} --size {SIZE} --pattern {pattern} --method {method} --flatness flat -o {rig} --force"
        if slcal(line, check=False).returncode:
            results[method], focal[method] = None, None
            continue
        results[method] = flatness(slcal, folder, rig)
        focal[method] = 100 * (json.loads(rig.read_text())["camera"]["K"][0][0] / true_focal - 1)
    return results, focal


def experiment(slcal, folder):
    """The table."""
    ways = ["true rig", *METHODS]
    lines = [
        "| photographs | door | paper | " + " | ".join(f"{w}: mean ± std, %" for w in ways)
        + " | off the plane, ml | f camera, ml, % | f camera, two-vp, % |",
        "|---" * (len(ways) + 6) + "|",
    ]
    show = lambda r: "refused" if r is None else f"{r[0]:.4f} ± {r[1]:.4f}"
    ordinary = folder / "ordinary.json"
    slcal(f"simulate views --poses 1 {RIG} {ORDINARY} -o {folder}/seen.json --truth {ordinary} --force")
    for what, (picture, is_ordinary) in PICTURES.items():
        rig = f"--rig {ordinary} {PLACE}" if is_ordinary else RIG
        for i, tilt in enumerate(TILTS):
            results, focal = door(slcal, folder, tilt, picture, rig)
            cells = [what, f"{i + 1} ({tilt.replace(',', '°, ')}°)", "{:.2f} ± {:.2f}".format(*PAPER[i])]
            cells += [show(results[w]) for w in ways]
            ml = results["ml"]
            cells += ["–" if ml is None else f"{100 * ml[3]:.2f} % of {ml[2] / (1 - ml[3]):.0f}"]
            cells += ["–" if focal[m] is None else f"{focal[m]:+.2f}" for m in METHODS]
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)
