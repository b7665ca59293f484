"""Figures that are known to be missed."""

# Figures that are missed, and why: printed as missed, counted apart, and no failure of the run. One that holds again is named,
# so that its row here goes.
KNOWN_SHORTFALLS = {
    "real_tang_a+real_tang_b: sigma of the projector's f": "0.117 %: the largest of the five pairs, the one whose projector is shifted sideways by 8 %; the camera's is 0.107 %, the error 0.08 %",
    "real_tang_a+real_tang_b, screen: sigma of the projector's f": "0.114 %: as without the dark photograph; the error is 0.02 %",
    "paper_tilted, plane_b, as rendered: errors within one sigma": "65.1 %: without noise, what sampling does to neighbouring stripes alike is left, and no scatter among them shows it",
    "strong + frames, the worst view: found": "92.8 %: one view of five, two crossings of a thousand short",
}
