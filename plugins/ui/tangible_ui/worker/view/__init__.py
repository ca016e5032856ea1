"""A surface as pages draw it and read it: arrays in files, levels of detail, words."""
