"""The figures that the binary is held to on photographs with ground truth, one module per kind."""
