"""Local binary patterns, counted directly into cells of 4 x 4 pixels. Compiled by numba."""

from collections.abc import Iterable, Iterator

import cv2
import numpy as np
from jaxtyping import Float32, UInt64

from tangible_core.compiled import in_blocks, njit
from tangible_core.runtime import plain_opencv

CELL_PX = 4
CLASSES = 10
AGREEMENTS = 12
COUNTERS = CLASSES + AGREEMENTS
# The distances of the neighbours, px, and the standard deviations of the smoothing before, px.
RADII = ((1, 0.0), (3, 0.0), (5, 1.5))
PATTERNS = len(RADII) * COUNTERS
# The largest difference of equal greys, as a share of the picture's standard deviation: that of rounding.
ALIKE = 1e-3


def pattern_frequencies(
    grey: Float32[np.ndarray, "h w"], out: Float32[np.ndarray, "counters rows columns"] | None = None
) -> Float32[np.ndarray, "counters rows columns"]:
    """Compute the frequency, 0..1, of each class and agreement in each cell, for every radius of RADII in turn."""
    shape = tuple(-(-side // CELL_PX) for side in grey.shape)
    frequencies = np.empty((PATTERNS, *shape), np.float32) if out is None else out
    for planes, (radius, sigma) in zip(frequencies.reshape(len(RADII), COUNTERS, *shape), RADII, strict=True):
        with plain_opencv():
            smooth = cv2.GaussianBlur(grey, (0, 0), sigma, borderType=cv2.BORDER_REFLECT_101) if sigma else grey
        frame = np.pad(smooth, radius, mode="edge")
        in_blocks(
            shape[0], lambda a, b, f=frame, r=radius, p=planes: _count(f, r, a, b, grey.shape, _FIRST, _SECOND, p), 4
        )
    return frequencies


def _agreeing_pairs(code: int) -> Iterator[tuple[bool, ...]]:
    bits = [bool(code >> i & 1) for i in range(8)]
    axes = [(bits[i], bits[i + 4]) for i in range(4)]
    quarters = [[bits[(i + j) % 8] == bits[(i + j + 2) % 8] for j in (0, 4)] for i in range(4)]
    yield tuple(not (one or other) for one, other in axes)
    yield tuple(one and other for one, other in axes)
    yield from zip(*quarters, strict=True)


def _rotation_class(code: int) -> int:
    bits = [code >> i & 1 for i in range(8)]
    return sum(bits) if sum(bits[i] != bits[i - 1] for i in range(8)) <= 2 else CLASSES - 1


def _pack_bits(flags: Iterable[bool], first_bit: int, width: int) -> int:
    return sum(1 << (first_bit + width * i) for i, flag in enumerate(flags) if flag)


def _agreement_word(code: int) -> int:
    dark, bright, *quarters = _agreeing_pairs(code)
    return _pack_bits(dark, 0, 5) + _pack_bits(bright, 20, 5) + sum(_pack_bits(quarter, 40, 6) for quarter in quarters)


_FIRST: UInt64[np.ndarray, "256"] = np.array([1 << 5 * _rotation_class(code) for code in range(256)], np.uint64)
_SECOND: UInt64[np.ndarray, "256"] = np.array([_agreement_word(code) for code in range(256)], np.uint64)


@njit(cache=True, nogil=True)
def _count(grey, radius, start, stop, shape, first_words, second_words, planes):
    """Fill the rows of cells from start to stop; grey is framed by `radius` pixels."""
    # The bits of a code mark the neighbours, of eight, that are at least as bright as the pixel. It adds one to one of
    # 10 rotation-invariant classes (Ojala, Pietikainen & Maenpaa, IEEE TPAMI 24, 2002) and to some of 12 agreements by
    # direction: both neighbours of an axis dark, both bright, a quarter turn apart alike. A cell has 16 pixels, so that
    # a counter fits 5 bits (6 for quarter turns, two a pixel), and two additions count a pixel.
    height, width = shape
    codes, shares = np.empty(width, np.uint8), np.empty(planes.shape[2], np.float32)
    for cell_row in range(start, stop):
        first, second = np.zeros(planes.shape[2], np.uint64), np.zeros(planes.shape[2], np.uint64)
        end = min((cell_row + 1) * CELL_PX, height)
        for row in range(cell_row * CELL_PX, end):
            _codes(grey, row, radius, codes)
            whole = width // CELL_PX
            for cell in range(whole):  # the cell's sums stay in registers: each word is written once a row
                one, other = first[cell], second[cell]
                for column in range(cell * CELL_PX, (cell + 1) * CELL_PX):
                    one += first_words[codes[column]]
                    other += second_words[codes[column]]
                first[cell], second[cell] = one, other
            for column in range(whole * CELL_PX, width):
                first[whole] += first_words[codes[column]]
                second[whole] += second_words[codes[column]]
        tall = end - cell_row * CELL_PX
        for cell in range(planes.shape[2]):
            shares[cell] = 1 / (tall * (min((cell + 1) * CELL_PX, width) - cell * CELL_PX))
        _unpack(first, second, shares, planes[:, cell_row])


@njit(cache=True, nogil=True)
def _codes(grey, row, radius, codes):
    """Write the codes of one row; neighbours are numbered counter-clockwise from the right."""
    near = round(radius * 0.70710678)
    up, down, above, below = grey[row], grey[row + 2 * radius], grey[row + radius - near], grey[row + radius + near]
    own = grey[row + radius]
    for column in range(codes.size):
        at = column + radius
        level = own[at] - np.float32(ALIKE)
        codes[column] = (
            (own[at + radius] >= level)
            | ((above[at + near] >= level) << 1)
            | ((up[at] >= level) << 2)
            | ((above[at - near] >= level) << 3)
            | ((own[at - radius] >= level) << 4)
            | ((below[at - near] >= level) << 5)
            | ((down[at] >= level) << 6)
            | ((below[at + near] >= level) << 7)
        )


@njit(cache=True, nogil=True)
def _unpack(first, second, shares, counters):
    """Write counter after counter, as their planes lie far apart in memory."""
    for i in range(CLASSES):
        for cell in range(shares.size):
            counters[i, cell] = np.float32((first[cell] >> np.uint64(5 * i)) & np.uint64(31)) * shares[cell]
    for i in range(8):
        for cell in range(shares.size):
            counters[CLASSES + i, cell] = np.float32((second[cell] >> np.uint64(5 * i)) & np.uint64(31)) * shares[cell]
    for i in range(4):
        for cell in range(shares.size):
            both = np.float32((second[cell] >> np.uint64(40 + 6 * i)) & np.uint64(63))
            counters[CLASSES + 8 + i, cell] = both * shares[cell] / 2
