"""Depth estimators: one method per file, found by entry point."""
