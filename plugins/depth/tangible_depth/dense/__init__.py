"""From raw matches to a dense map: confidence, speckles, filling, edges."""
