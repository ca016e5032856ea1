"""Readers for the folders of the standard sets, a file for each benchmark."""
