"""Pictures of pins: which of them rise for parts and heights, and how files say so."""
