"""A sheet of pictures: its panels arranged, drawn in one style, and written with a description in words."""
