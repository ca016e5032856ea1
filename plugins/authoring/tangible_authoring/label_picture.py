"""Label pictures to edit in a paint program: a colour for each part, and spare colours for new parts."""

from functools import cache
from io import BytesIO

import numpy as np
from jaxtyping import Int32, UInt8

from tangible_core.runtime.opencv import plain_opencv

MOST_IN_PALETTE = 256
"""Largest number of colours in the palette of a PNG."""
SPARE = 24
"""Number of unused colours in the palette, for new parts in a paint program that keeps to the palette."""
STEPS = 21
"""Levels of red, green and blue among which colours are chosen: more colours than a label picture may have labels."""
DARKEST, LIGHTEST, MOST_CHROMA = 30.0, 92.0, 85.0
"""Bounds of the colours in CIELAB: black and white are a paint program's defaults, and strong colours glare."""


def label_picture(labels: Int32[np.ndarray, "h w"]) -> bytes:
    """Write a PNG with a colour for each label, which `formats.pictures.read_labels` reads as the same segments.

    Labels start at 0, and number at most `formats.pictures.MAX_LABELS`. The PNG has a palette, so that no brush mixes
    two colours at a border; with more than 256 labels it has red, green and blue.
    """
    from PIL import Image

    count = int(labels.max()) + 1
    if count > MOST_IN_PALETTE:
        image = Image.fromarray(distinct_colours(count)[labels])
    else:
        image = Image.fromarray(labels.astype(np.uint8))
        image.putpalette(distinct_colours(min(count + SPARE, MOST_IN_PALETTE)).tobytes())
    file = BytesIO()
    image.save(file, format="PNG")
    return file.getvalue()


@cache
def distinct_colours(count: int) -> UInt8[np.ndarray, "n 3"]:
    """Choose n colours, each as far as possible, in CIELAB, from all before it; fewer colours are the first of these.

    Source: Gonzalez, Clustering to minimize the maximum intercluster distance (1985).
    """
    import cv2

    steps = np.rint(np.linspace(0, 255, STEPS)).astype(np.uint8)
    colours = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    with plain_opencv():
        lab = cv2.cvtColor(colours[None].astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0]
    chroma = np.hypot(lab[:, 1], lab[:, 2])
    pleasant = (lab[:, 0] >= DARKEST) & (lab[:, 0] <= LIGHTEST) & (chroma <= MOST_CHROMA)
    colours, lab, chroma = colours[pleasant], lab[pleasant], chroma[pleasant]
    chosen = [int(chroma.argmax())]
    far = np.linalg.norm(lab - lab[chosen[0]], axis=1)
    while len(chosen) < count:
        chosen.append(int(far.argmax()))
        far = np.minimum(far, np.linalg.norm(lab - lab[chosen[-1]], axis=1))
    distinct = colours[chosen]
    distinct.flags.writeable = False
    return distinct
