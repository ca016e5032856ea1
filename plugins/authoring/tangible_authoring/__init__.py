"""Starter files: a pipeline file for a picture, and its parts as a list to name and to give heights."""
