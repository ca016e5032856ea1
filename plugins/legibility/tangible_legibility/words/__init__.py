"""The words of descriptions, a file for each language, with the same keys and placeholders."""
