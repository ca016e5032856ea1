"""Heights as a closed solid: the plate around them, triangles, walls and floor, and checks for printing."""
