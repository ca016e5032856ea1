"""The compiled kernels of the force laws, one file a law, of the law's name."""
