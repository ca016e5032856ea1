"""Features: corners, their matches, and dense maps assembled from them."""
