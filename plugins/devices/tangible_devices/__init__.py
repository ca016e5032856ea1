"""Haptic devices: one method per file, found by entry point."""
