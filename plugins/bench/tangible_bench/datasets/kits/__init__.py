"""Readers for the folders of the standard sets: Middlebury, KITTI and the others."""
