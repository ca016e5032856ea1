"""The borders between labels as smooth lines, and the distance to them."""
