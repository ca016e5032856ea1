"""A procedure for studies of Tangible Images: a staircase."""
