"""The colours of our label pictures, by which they are known whatever program saved them."""

from functools import cache

import numpy as np
from jaxtyping import Int32, UInt8

from ...errors import PictureError
from ...runtime.opencv import plain_opencv

MOST_IN_PALETTE = 256
"""Largest number of colours in the palette of a PNG."""
SPARE = 24
"""Number of unused colours in the palette, for new parts in a paint program that keeps to the palette."""
STEPS = 21
"""Levels of red, green and blue among which colours are chosen: more colours than a label picture may have labels."""
DARKEST, LIGHTEST, MOST_CHROMA = 30.0, 92.0, 85.0
"""Bounds of the colours in CIELAB: black and white are a paint program's defaults, and strong colours glare."""


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


def labels_by_colour(picture: UInt8[np.ndarray, "h w c"], name: str) -> Int32[np.ndarray, "h w"] | None:
    """Return the labels of a picture in the colours of a palette of ours, in its order; None for any other picture.

    Raises: PictureError for one whose colours were mixed.
    """
    codes, places = np.unique(_codes(picture), return_inverse=True)
    ours = {int(code): number for number, code in enumerate(_codes(distinct_colours(MOST_IN_PALETTE)))}
    numbers = np.array([ours.get(int(code), -1) for code in codes[: 2 * MOST_IN_PALETTE]])
    known = numbers >= 0
    if known.sum() < 2 or numbers.max() >= 2 * known.sum() + SPARE:
        return None
    if len(codes) == known.sum():
        return np.argsort(np.argsort(numbers)).astype(np.int32)[places].reshape(picture.shape[:2])
    pixels = np.bincount(places.ravel())
    share = 1 - pixels[: len(numbers)][known].sum() / pixels.sum()
    if share > 0.5 or len(codes) < 2 * known.sum():
        return None
    raise PictureError(
        f"{name}: in {100 * share:.2g} % of its pixels, colours of parts are mixed: another program smoothed, scaled "
        "or compressed it; save it as PNG, without smoothing and at its own size"
    )


def _codes(colours: UInt8[np.ndarray, "*n c"]) -> Int32[np.ndarray, "*n"]:
    red, green, blue = np.moveaxis(colours[..., :3].astype(np.int32), -1, 0)
    return red << 16 | green << 8 | blue
