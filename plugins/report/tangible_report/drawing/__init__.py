"""The sheet of pictures: panels are arranged, drawn in one style, and written with a description in words."""
