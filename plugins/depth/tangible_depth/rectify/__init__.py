"""Rectification of pairs whose rows do not correspond: start at `rectification`."""
