"""Heights under a point: cells, a C2 spline, tiles; dequantisation of heights."""
