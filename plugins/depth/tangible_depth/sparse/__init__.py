"""Features: corners, their matches, and maps made of them."""
