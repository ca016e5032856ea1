"""Videos and cameras, read frame by frame."""
