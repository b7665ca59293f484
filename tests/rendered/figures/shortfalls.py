"""Figures that are known to be missed."""

# Figures that are missed, and why: printed as missed, counted apart, and no failure of the run. One that holds again is named,
# so that its row here goes.
KNOWN_SHORTFALLS = {
    "real sheet 02: f_cam": "3.1 %: all five lie low by 0.6 to 3 %; the sheet bends in some, which no lens takes up",
    "paper_tilted, plane_b, as rendered: errors within one sigma": "65.1 %: without noise, what sampling does to neighbouring stripes alike is left, and no scatter among them shows it",
    "strong + frames, the worst view: found": "92.8 %: one view of five, two crossings of a thousand short",
}
