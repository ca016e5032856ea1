"""What a picture's texture is like, in windows of several widths."""
