"""Measurements: one process each, or errors alone on all cores; their rows are kept as soon as they are known."""
