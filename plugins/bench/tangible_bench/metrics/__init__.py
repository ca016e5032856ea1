"""Measures that only comparisons need: of segments, of confidence, and the greatest stable stiffness."""
