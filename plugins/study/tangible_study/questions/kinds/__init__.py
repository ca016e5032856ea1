"""A file a kind of question; its name is the name in a study file, and its `QUESTION` all that it is."""
