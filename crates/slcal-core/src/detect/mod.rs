//! Photograph → observations: the checkerboard's corners and the sheet's edges, to sub-pixel.
