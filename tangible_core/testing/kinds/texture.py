"""Checks of a texture segmenter."""

import numpy as np

from ...data import SegmentMap
from ...errors import PictureError
from ...plugins.interfaces import Segmenter
from ..checks import TINY, Check, checks_in, coarse_variants, demand, exact_variants, refuses
from ..synthetic.scenes import two_textures


def labels_are_well_formed(method: Segmenter) -> None:
    """Check that labels are read-only int32 of the picture's size, 0..n-1 without a gap, and confidence in 0..1."""
    picture, _ = two_textures()
    result = method.segment(picture)
    demand(type(result) is SegmentMap, f"segment returns {type(result).__name__}, not SegmentMap")
    demand(result.labels.dtype == np.int32, f"labels are {result.labels.dtype}, not int32")
    demand(not result.labels.flags.writeable, "labels can be written to")
    _demand_labels(result.labels, picture.shape[:2], "the picture")
    demand(result.confidence.dtype == np.float32, f"confidence is {result.confidence.dtype}, not float32")
    low, high = float(result.confidence.min()), float(result.confidence.max())
    demand(low >= 0 and high <= 1, f"confidence runs from {low:g} to {high:g}, not within 0..1")  # NaN fails too


def two_textures_are_told_apart(method: Segmenter) -> None:
    """Check that 95 % of the pixels of two halves, which differ in brightness and texture, are separated."""
    picture, truth = two_textures()
    right = _accuracy(method.segment(picture).labels, truth)
    demand(right >= 0.95, f"{right:.1%} of the pixels are in a segment of their own half; 95 % are required")


def same_picture_same_labels(method: Segmenter) -> None:
    """Check that two runs on equal pictures agree to the last bit: results are cached, compared and repeated."""
    picture, _ = two_textures()
    first, second = method.segment(picture), type(method)(**dict(method)).segment(picture.copy())
    demand(first.digest() == second.digest(), "two runs on equal pictures differ; seed what is random")


def picture_is_not_written_to(method: Segmenter) -> None:
    """Check that the input picture is not changed, and may be read-only: other stages read it too."""
    picture, _ = two_textures()
    before = picture.tobytes()
    method.segment(picture)
    demand(picture.tobytes() == before, "segment writes to its input; work on a copy")
    picture.flags.writeable = False
    method.segment(picture)


def one_colour_is_one_segment(method: Segmenter) -> None:
    """Check that a picture of one colour is one segment, whatever the number of segments requested."""
    for name, colour in (("black", (0, 0, 0)), ("grey", (128, 128, 128)), ("blue", (20, 40, 250))):
        result = method.segment(np.full((48, 64, 3), colour, np.uint8))
        demand(result.count == 1, f"a picture all {name} is divided into {result.count} segments")


def every_picture_type_is_segmented(method: Segmenter) -> None:
    """Check that 8 and 16 bits, floats, RGBA and any memory layout give nearly the same segments."""
    picture, _ = two_textures()
    first = method.segment(picture).labels
    for name, variant in exact_variants(picture):
        same = _accuracy(method.segment(variant).labels, first)
        demand(same >= 0.95, f"as {name}, only {same:.1%} of the pixels stay in their segment")
    for name, variant in coarse_variants(picture):
        _demand_labels(method.segment(variant).labels, picture.shape[:2], f"the picture as {name}")


def any_size_is_segmented(method: Segmenter) -> None:
    """Check that a picture of any size, even one pixel, gets labels of its size, and no more segments than pixels."""
    for shape in TINY:
        picture = two_textures(shape)[0]
        _demand_labels(method.segment(picture).labels, shape, f"a picture of {shape}")


def what_is_no_picture_is_refused(method: Segmenter) -> None:
    """Check that NaN, infinity, an empty picture and a wrong number of channels raise PictureError and nothing else."""
    for bad in (np.nan, np.inf):
        picture = np.asarray(two_textures()[0] / 255, np.float32)
        picture[3, 5] = bad
        refuses(PictureError, f"a picture with {bad}", lambda picture=picture: method.segment(picture))
    for shape in ((0, 8), (8, 8, 2), (4, 8, 8, 3)):
        picture = np.zeros(shape, np.uint8)
        refuses(PictureError, f"an array of shape {shape}", lambda picture=picture: method.segment(picture))


def _demand_labels(labels: np.ndarray, shape: tuple[int, ...], name: str) -> None:
    demand(labels.shape == shape, f"{name} is {shape}, its labels {labels.shape}")
    present = np.unique(labels)
    demand(
        np.array_equal(present, np.arange(present.size)),
        f"labels of {name} run from {present[0]} to {present[-1]}, of which {present.size} occur; use 0..n-1, each",
    )


def _accuracy(labels: np.ndarray, truth: np.ndarray) -> float:
    """Return the share of pixels that are right if each segment of 1 % or more stands for the class it covers most."""
    table = np.zeros((int(labels.max()) + 1, int(truth.max()) + 1), np.int64)
    np.add.at(table, (labels.ravel(), truth.ravel()), 1)
    large = table.sum(axis=1) * 100 >= labels.size
    return float(table[large].max(axis=1).sum() / labels.size)


CHECKS: tuple[Check, ...] = checks_in(__name__)
