"""Readers of pictures too large to be held whole: cut into bands, each a small file of its own, and reduced."""
