# %% [markdown]
# # A tour of slcal
#
# One photograph of a sheet of paper calibrates a projector and a camera. One more photograph gives the shape
# of an object. Run this cell by cell in an editor or a notebook, or as a whole: `python examples/tour.py`. The
# photographs are simulated, so every result stands beside the ground truth.
#
# `pip install './crates/slcal-py[viz]'` installs what it needs, in the repository's folder.

# %%
from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np

import slcal
from slcal import simulate, viz

SIZE_MM = "A2"  # Of the sheet; (594, 420) and "594x420mm" are sizes, too.
PROJECTOR = (1024, 768)

# %% [markdown]
# ## What to project
# A checkerboard for calibration and coloured stripes for scanning. Show both full screen, at the projector's
# native resolution.

# %%
checker = slcal.CheckerPattern(PROJECTOR)
stripes = slcal.StripePattern(PROJECTOR)
print(checker, stripes, sep="\n")

# %% [markdown]
# ## One photograph of the sheet
# The sheet is tilted by 25° about the horizontal and 28° about the vertical axis. Load your own photograph with
# `slcal.read_image("sheet.jpg")`.

# %%
sheet = simulate.scene("sheet", checker, tilt=(25, 28), lens_shift=0.5, projector_focal=1400)
found = slcal.detect(sheet.photo, SIZE_MM, checker)
print(found)
viz.overlay(sheet.photo, found)
plt.savefig("tour_sheet.png")

# %% [markdown]
# ## Calibrate, and read the verdict
# Every estimate has its standard deviation (1σ).

# %%
rig = slcal.calibrate(sheet.photo, SIZE_MM, checker)
truth = sheet.rig


def compare(what: str, found: float, sigma: float, true: float) -> None:
    print(f"{what:<28} {found:8.1f} ± {sigma:5.1f}   truth {true:8.1f}")


compare("camera, focal length, px", rig.camera.K[0, 0], rig.camera.sigma.focal_px, truth.camera.K[0, 0])
compare(
    "projector, focal length, px",
    rig.projector.K[0, 0],
    rig.projector.sigma.focal_px,
    truth.projector.K[0, 0],
)
compare("projector, cy, px", rig.projector.K[1, 2], rig.projector.sigma.cy_px, truth.projector.K[1, 2])
compare("baseline, mm", rig.baseline_mm, rig.baseline_sigma_mm, truth.baseline_mm)
print("verdict:", rig.quality.verdict)
for warning in rig.quality.warnings:
    print(f"{warning.code}: {warning.message}; {warning.advice}")

# %% [markdown]
# ## Which photograph next?
# One photograph does not determine the principal point. A second photograph with the right tilt does.

# %%
advice = rig.advise(checker)
print(advice.next.in_words)
print(
    f"σ of the camera's focal length: {advice.sigma_now.camera_focal_percent:.2g} % now, "
    f"{advice.next.sigma_after.camera_focal_percent:.2g} % after it"
)

# %%
second = simulate.scene("sheet", checker, rig=truth, tilt=(-25, -28), seed=2)
rig = slcal.calibrate([sheet.photo, second.photo], SIZE_MM, checker)
print(rig)
viz.rig(rig)
plt.savefig("tour_rig.png")
rig.save("tour_rig.json")

# %% [markdown]
# ## One photograph of an object under the stripes

# %%
ball = simulate.scene("sphere", stripes, rig=truth, radius=120)
cloud = rig.reconstruct(ball.photo, stripes, mesh=True)
print(cloud)
cloud.save("tour_ball.ply")
viz.overlay(ball.photo, slcal.decode(ball.photo, stripes))
plt.savefig("tour_stripes.png")

# %% [markdown]
# ## How uncertain is each point?
# `sigma` is 1σ along the camera's ray; `noise` is the part of it that differs from point to point.

# %%
sigma, noise = np.median(cloud.sigma), np.median(cloud.noise)
print(f"σ {sigma:.3f} mm, of which {noise:.3f} mm vary from point to point (medians)")
viz.cloud(cloud, "sigma")
plt.savefig("tour_sigma.png")
print(f"{cloud.report.decode.crossings} crossings seen, {cloud.report.decode.decoded} decoded")

# %% [markdown]
# ## How accurate is it?

# %%
fit = slcal.evaluate(cloud, "sphere")
print(f"radius {fit.radius_mm:.2f} mm, truth 120; mean distance of the points {fit.report.mean_mm:.3f} mm")

# %% [markdown]
# ## The rig in OpenCV

# %%
for name, value in rig.to_opencv().items():
    print(name, np.array2string(value, precision=2, suppress_small=True).replace("\n", ""))
