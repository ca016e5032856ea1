"""Parts as a picture to paint on: a colour each, and colours to spare for new ones."""

from functools import cache
from io import BytesIO

import numpy as np
from jaxtyping import Int32, UInt8

from ..runtime.opencv import plain_opencv

MOST_IN_PALETTE = 256
SPARE = 24
"""Colours of the palette that no part has: a paint program that keeps to the palette has them for new parts."""
STEPS = 21
"""Of red, green and blue each, among which colours are chosen: more of them than a label picture may have labels."""
DARKEST, LIGHTEST, MOST_CHROMA = 30.0, 92.0, 85.0
"""In CIELAB: black and white are what a paint program begins with, and the strongest colours hurt beside each other."""


def label_picture(labels: Int32[np.ndarray, "h w"]) -> bytes:
    """A PNG with a colour for each label, which is read back as the same segments (`formats.pictures.read_labels`).

    Labels are from 0 on, at most `formats.pictures.MAX_LABELS`. It has a palette, in which no brush can mix two colours
    at a border; with more than 256 labels it has red, green and blue.
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
    """So many colours, each as far as can be, in CIELAB, from all before it; those of fewer are the first of them.

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
    found = colours[chosen]
    found.flags.writeable = False
    return found
