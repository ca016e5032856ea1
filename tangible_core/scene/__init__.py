"""Scenes, stereo rigs, and the geometry from disparity to relief."""
