"""The engine: it makes a product from what that needs and no more, and says why."""
