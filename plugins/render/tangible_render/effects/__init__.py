"""What materials add to a law: textures, friction, damping."""
