"""Scenes and their pictures, calibrations and geometry."""
