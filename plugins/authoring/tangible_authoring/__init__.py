"""Files to begin with: a pipeline file for a picture, its parts as a list to name and to give heights."""
