"""The checks of each kind of method."""
