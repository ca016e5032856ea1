"""Texture segmenters: one method per file, found by entry point."""
