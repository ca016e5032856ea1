"""Heights become a closed solid: the plate around them, triangles, walls and floor, and what a print makes of it."""
