"""Parts simplified until fingers can read them."""
