"""Strokes of a hand over surfaces, and the exact nearest points along them."""
