"""Videos and cameras: their frames, one after the other."""
