# %% [markdown]
# # A tour of slcal
#
# From one photograph of a sheet of paper to a projector and a camera whose geometry is known, and from one
# more photograph to the shape of a thing. Run it cell by cell in an editor or a notebook, or from top to
# bottom: `python tour.py`. The photographs are simulated, so that the truth is known beside every result.
#
# `pip install slcal[viz]`

# %%
from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np

import slcal
from slcal import simulate, viz

SIZE_MM = (594, 420)  # Of the sheet: A2 on its side.
PROJECTOR = (1024, 768)

# %% [markdown]
# ## What to project
# A checkerboard to calibrate with, coloured stripes to scan with; both full screen, at the projector's native
# resolution.

# %%
checker = slcal.CheckerPattern(PROJECTOR)
stripes = slcal.StripePattern(PROJECTOR)
print(checker, stripes, sep="\n")

# %% [markdown]
# ## One photograph of the sheet
# The sheet leans by 25° about the horizontal and 28° about the vertical axis. A photograph of yours comes in
# by `slcal.read_image("sheet.jpg")`.

# %%
sheet = simulate.scene("sheet", checker, tilt=(25, 28), lens_shift=0.5, projector_focal=1400)
found = slcal.detect(sheet.photo, SIZE_MM, checker)
print(found)
viz.overlay(sheet.photo, found)
plt.savefig("tour_sheet.png")

# %% [markdown]
# ## Calibrate, and read the verdict
# Everything that is estimated has its 1σ.

# %%
rig = slcal.calibrate(sheet.photo, SIZE_MM, checker)
truth = sheet.rig
assert rig.projector and rig.projector.sigma and rig.camera.sigma and rig.quality and truth.projector


def tell(what: str, found: float, sigma: float, true: float) -> None:
    print(f"{what:<28} {found:8.1f} ± {sigma:5.1f}   truly {true:8.1f}")


tell("camera, focal length, px", rig.camera.K[0, 0], rig.camera.sigma.focal_px, truth.camera.K[0, 0])
tell(
    "projector, focal length, px",
    rig.projector.K[0, 0],
    rig.projector.sigma.focal_px,
    truth.projector.K[0, 0],
)
tell("projector, axis at row, px", rig.projector.K[1, 2], rig.projector.sigma.cy_px, truth.projector.K[1, 2])
tell("baseline, mm", rig.baseline_mm or 0, rig.baseline_sigma_mm or 0, truth.baseline_mm or 0)
print("verdict:", rig.quality.verdict)
for warning in rig.quality.warnings:
    print(f"{warning.code}: {warning.message}; {warning.advice}")

# %% [markdown]
# ## Which photograph next?
# One photograph cannot tell where the lens's axis meets the sensor. A second can, if it is the right one.

# %%
advice = rig.advise(checker)
assert advice.next and advice.sigma_now
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
# ## How sure is it of each point?
# `sigma` is 1σ along the camera's ray; `noise` the part of it that differs from point to point.

# %%
sigma, noise = np.median(cloud.sigma), np.median(cloud.noise)
print(f"σ {sigma:.3f} mm, of which from point to point {noise:.3f} mm (medians)")
viz.cloud(cloud, "sigma")
plt.savefig("tour_sigma.png")
assert cloud.report and cloud.report.decode
print(f"{cloud.report.decode.crossings} crossings seen, {cloud.report.decode.decoded} decoded")

# %% [markdown]
# ## How good is it?

# %%
fit = slcal.evaluate(cloud, "sphere")
print(f"radius {fit.radius_mm:.2f} mm, truly 120; points off by {fit.report.mean_mm:.3f} mm on average")

# %% [markdown]
# ## And in OpenCV

# %%
for name, value in rig.to_opencv().items():
    print(name, np.array2string(value, precision=2, suppress_small=True).replace("\n", ""))
