"""Comparison files: which methods are compared, on which scenes, and how often."""
