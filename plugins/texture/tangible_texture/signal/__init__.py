"""Smoothing, slopes, and reasons to leave a picture undivided."""
