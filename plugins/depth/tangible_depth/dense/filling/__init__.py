"""The disparity of pixels without a match, taken from the surfaces next to them."""
