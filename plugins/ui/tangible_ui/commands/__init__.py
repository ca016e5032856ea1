"""What the page adds to `tangible`. Imported whenever `tangible` starts, so this room imports next to nothing."""
