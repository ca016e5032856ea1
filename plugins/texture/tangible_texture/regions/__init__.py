"""Regions of a picture: basins, watershed, borders, merging."""
