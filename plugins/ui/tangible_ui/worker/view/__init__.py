"""A surface as pages draw and read it: arrays in files, levels of detail, words."""
