"""Acme's exporter for Tangible Images."""
