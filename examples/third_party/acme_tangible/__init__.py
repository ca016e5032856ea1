"""Acme's methods for Tangible Images."""
