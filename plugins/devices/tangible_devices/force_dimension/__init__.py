"""Force Dimension's devices, through their maker's library."""
