"""The kind of a picture: a photograph, a flat drawing, line art, or a page of text."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from ..data import PartMap, PictureText
from ..runtime.opencv import cv2, plain_opencv
from .ink import eight_bits, find_ink, noise_level, reduce_to_side
from .text import find_texts

SIDE = 800  # the most pixels of a side on which a kind is measured
PATCH_PX = 5  # the side of a square that is flat or not, px
QUIET = 1.8  # the greatest standard deviation in a flat square, by that of the noise
SHADES = 24  # the width of a bin of colour, of 255
MAX_NOISE = 25.0  # the greatest noise of a scan, of 255
NOISE, STEPS, INK = 4, 5, 6  # the places of three measures
FEW = 6  # the number of colours that most of a flat drawing has


WEIGHTS = np.array([
    (-2.7, 2.56, 0.07, 0.06),
    (-0.55, 0.53, 0.01, 0.01),
    (-0.43, 0.35, 0.07, 0),
    (0.43, -0.73, 0.06, 0.24),
    (1.95, 0.13, -1.07, -1.01),
    (2.28, 1.82, -3.26, -0.84),
    (3.13, -2.12, -0.74, -0.27),
    (0.51, -0.62, -0.67, 0.79),
    (-0.73, 0.96, -1.61, 1.38),
    (-3.92, 2.14, 1.5, 0.29),
    (-0.75, 2.62, 0.42, -2.29),
    (16.31, -2.65, -7.69, -5.96),
])  # fmt: skip
"""The weights of each measure of `measure_kind` in the score of each kind; the last row is constants."""


LIKELY = 0.5  # the least confidence with which a picture is taken for a drawing


class PictureKind(StrEnum):
    """Kinds of pictures."""

    photograph = "photograph"
    drawing = "drawing"
    lines = "lines"
    text = "text"


class KindFound(NamedTuple):
    """A kind and its probability."""

    kind: PictureKind
    confidence: float

    @property
    def likely(self) -> PictureKind:
        """The kind if it is more likely than all others together, else a photograph."""
        return self.kind if self.confidence >= LIKELY else PictureKind.photograph


class DrawnPicture(NamedTuple):
    """A drawing, and what a medium shows of it."""

    kind: PictureKind
    picture: np.ndarray
    lines: bool  # true where its lines are drawn or raised as lines
    whole: PartMap | None = None  # all its parts, before any was left out
    lost_texts: tuple[PictureText, ...] = ()  # those that are neither shown nor the title nor names of parts
    text_count: int = 0


def measure_kind(picture: np.ndarray) -> Float64[np.ndarray, "n"]:
    """Return what tells kinds apart.

    On the ground, without strokes, the shares that are flat, flat or at a step, and of the six and the one commonest
    colour; the noise; the shares at steps and of ink; the share of ink in letters, their number, the darkness of ink,
    and the share of ink in lines. Most are logarithms.
    """
    colours = reduce_to_side(eight_bits(picture), SIDE)
    ink = find_ink(colours, every=True)
    texts = find_texts(ink)
    noise = max(noise_level(colours), 0.5)
    with plain_opencv():
        grey, window = cv2.cvtColor(ink.ground, cv2.COLOR_RGB2GRAY).astype(np.float32), (PATCH_PX, PATCH_PX)
        mean, square = cv2.blur(grey, window), cv2.blur(grey * grey, window)
        step = cv2.dilate(ink.ground, np.ones((7, 7))) - cv2.erode(ink.ground, np.ones((7, 7)))
        smooth = cv2.GaussianBlur(ink.ground, (0, 0), 1.5)
    flat = np.sqrt(np.maximum(square - mean * mean, 0)) < QUIET * noise + 1
    at_step = step.max(axis=2) > 8 * noise + 16
    bins = smooth[flat] // SHADES
    counts = (
        np.sort(np.bincount(np.einsum("ij,j->i", bins, [1, 16, 256]), minlength=1))[::-1] if flat.any() else np.ones(1)
    )
    size, inked = max(1, counts.sum()), max(1, np.count_nonzero(ink.mask))
    letters = sum(text.letters for text in texts.boxes)
    lined = np.count_nonzero(ink.mask & ~texts.ink)
    return np.array(
        [
            flat.mean(),
            (flat | at_step).mean(),
            counts[:FEW].sum() / size,
            counts[0] / size,
            np.log10(noise),
            np.log10(1e-3 + at_step.mean()),
            np.log10(1e-3 + ink.mask.mean()),
            np.log10(1e-2 + texts.ink.sum() / inked),
            np.log10(1 + letters),
            ink.darkness[ink.mask].mean() if ink.mask.any() else 0,
            np.log10(1e-2 + lined / inked),
        ]
    )


def picture_kind(picture: np.ndarray) -> KindFound:
    """Return the likeliest kind of a picture, and its probability, by a logistic regression on `measure_kind`."""
    # Where nothing is drawn, or noise would hide it, the picture counts as a photograph.
    measures = measure_kind(picture)
    if measures[NOISE] > np.log10(MAX_NOISE) or max(measures[STEPS], measures[INK]) < -2.99:
        return KindFound(PictureKind.photograph, 0.5)
    scores = np.einsum("i,ij->j", measures, WEIGHTS[:-1]) + WEIGHTS[-1]
    shares = np.exp(scores - scores.max())
    best = int(shares.argmax())
    return KindFound(list(PictureKind)[best], float(shares[best] / shares.sum()))


NAMES = {
    PictureKind.photograph: "a photograph",
    PictureKind.drawing: "a flat drawing",
    PictureKind.lines: "a line drawing",
    PictureKind.text: "a page of text, which fingers cannot read as a picture",
}


def kind_sentence(found: KindFound) -> str:
    """Return a sentence on the kind of a picture.

    >>> kind_sentence(KindFound(PictureKind.lines, 0.98))
    'this is a line drawing (confidence 0.98; if not, give `kind` under `scene:`)'
    """
    return f"this is {NAMES[found.kind]} (confidence {found.confidence:.2f}; if not, give `kind` under `scene:`)"
