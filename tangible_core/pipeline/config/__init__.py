"""The pipeline file: its model, its schema, and changes of its text."""
