"""Heights as the grey levels of a picture, for force laws that were defined for pictures."""

import numpy as np
from jaxtyping import Float32, UInt8


def grey_levels(height_m: Float32[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w"]:
    """Return heights in 256 steps: 0 on the base plane, 255 at the highest point; all 0 for a surface of height 0."""
    highest = height_m.max()
    return np.rint(height_m / highest * 255).astype(np.uint8) if highest > 0 else np.zeros(height_m.shape, np.uint8)
