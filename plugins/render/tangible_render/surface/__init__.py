"""Heights under a point: cells, a C2 spline, tiles; heights that came in steps."""
