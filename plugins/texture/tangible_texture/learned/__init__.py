"""Values that a network makes of features: the metric of textures, learned from many of them."""
