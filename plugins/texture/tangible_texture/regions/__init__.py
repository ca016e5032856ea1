"""Regions of a picture: basins, flooding, borders, merging."""
