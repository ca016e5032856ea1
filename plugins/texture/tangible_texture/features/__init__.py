"""Features of texture, in windows of several widths."""
