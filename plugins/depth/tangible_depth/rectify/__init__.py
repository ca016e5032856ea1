"""Rectification: epipolar geometry, and turning two pictures so that rows correspond."""
