"""Pictures in files, for tests that read them."""

from pathlib import Path

import numpy as np
from PIL import Image

from tangible_core.data.pictures import to_rgb8


def write_png(path: Path, picture: np.ndarray) -> None:
    """This picture as PNG."""
    Image.fromarray(to_rgb8(picture)).save(path, format="PNG")
