"""The borders between labels as lines without stairs, and the distance to them."""
