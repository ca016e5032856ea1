"""The USB side of a Falcon: its port, its firmware, and the errors of USB in words."""
