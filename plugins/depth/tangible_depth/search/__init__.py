"""The disparities that occur in a pair, estimated before the matching: start at `disparity_range`."""
