"""Post-processing of raw matches into a dense map: confidence, speckles, filling, edges."""
