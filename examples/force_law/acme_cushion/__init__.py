"""A force law for Tangible Images."""
