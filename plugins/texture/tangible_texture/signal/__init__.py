"""Smoothing, slopes, and whether there is anything in a picture to divide."""
