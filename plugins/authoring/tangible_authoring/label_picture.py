"""Label pictures to edit in a paint program: a colour for each part, and spare colours for new parts."""

from io import BytesIO

import numpy as np
from jaxtyping import Int32

from tangible_core.scene.formats import MAX_IN_PALETTE, SPARE, distinct_colours


def label_picture(labels: Int32[np.ndarray, "h w"]) -> bytes:
    """Write a PNG with a colour for each label from 0 on, which `read_labels` reads as the same segments."""
    from PIL import Image

    count = int(labels.max()) + 1
    if count > MAX_IN_PALETTE:
        image = Image.fromarray(distinct_colours(count)[labels])
    else:
        image = Image.fromarray(labels.astype(np.uint8))
        image.putpalette(distinct_colours(min(count + SPARE, MAX_IN_PALETTE)).tobytes())
    file = BytesIO()
    image.save(file, format="PNG")
    return file.getvalue()
