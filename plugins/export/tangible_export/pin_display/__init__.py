"""Pictures of pins: which pins rise for parts and heights, and the formats of their files."""
