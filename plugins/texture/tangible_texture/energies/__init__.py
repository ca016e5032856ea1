"""Energies of Gabor filters, at every pixel."""
