"""A haptic device for Tangible Images."""
