"""Values that tell textures apart, made of the features by a small network fitted to many textures."""

from collections.abc import Iterable
from functools import cache
from importlib.resources import as_file, files
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.compiled import in_turns
from tangible_core.runtime import cv2, plain_opencv

from ..clusters.planes import add_planes, combine_planes
from ..features.cells import window_means
from ..features.features import Features, Window
from ..features.patterns import PATTERNS

FILTERS = 24
# The least side of the narrow grid, in cells: the weights were fitted to pictures of 256 pixels or more.
MIN_CELLS = 64
# The number of planes that are reduced, or averaged in windows, at once: all of them would take too much memory.
GROUP = 16
# The standard deviations of the further windows, in cells of 8 pixels: with 5 px before, some 5, 10 and 18 px.
WINDOWS = 0.0, 1.09, 2.16


class Weights(NamedTuple):
    """The weights of each layer: one row a value that it gives."""

    first: Float64[np.ndarray, "h d"]
    first_bias: Float32[np.ndarray, "h"]
    second: Float64[np.ndarray, "g 3h"]
    second_bias: Float32[np.ndarray, "g"]
    last: Float64[np.ndarray, "e g"]


@cache
def _weights() -> Weights:
    with as_file(files("tangible_texture.learned") / "weights.npz") as path, np.load(path) as arrays:
        first, first_bias, second, second_bias, last = (arrays[name] for name in Weights._fields)
    return Weights(
        first.astype(np.float64),
        first_bias.astype(np.float32),
        second.astype(np.float64),
        second_bias.astype(np.float32),
        last.astype(np.float64),
    )


def learned_values(features: Features) -> Window | None:
    """Compute the values of each cell of 8 pixels, centred; None for a picture smaller than MIN_CELLS."""
    if min(features.narrow.shape) < MIN_CELLS:
        return None
    filters, shape = features.filters, features.middle.shape
    usable = [at for at, number in enumerate(filters) if number < FILTERS]
    numbers = [*usable, *range(len(filters), len(filters) + PATTERNS)]
    weights, columns = _weights(), [*(filters[at] for at in usable), *range(FILTERS, FILTERS + PATTERNS)]
    # Fitted by `benchmarks.texture_fit` to prototypes, one class a texture (Snell, Swersky & Zemel, NIPS 2017). Weights
    # are tied so that a flip or a quarter turn exchanges values, and no distance changes. A filter that was left out
    # counts as one without differences.
    layer = np.zeros((len(weights.first), shape[0] * shape[1]), np.float32)
    for start in range(0, len(numbers), GROUP):
        own = columns[start : start + GROUP]
        add_planes(weights.first[:, own].copy(), _reduce(features.narrow, numbers[start : start + GROUP], shape), layer)
    _rectify(layer, weights.first_bias)
    rest = np.zeros((len(weights.second), layer.shape[1]), np.float32)
    for index, sigma in enumerate(WINDOWS):
        own = weights.second[:, index * len(layer) :]
        for start in range(0, len(layer), GROUP):
            values = layer[start : start + GROUP]
            around = window_means(values.reshape(-1, *shape), sigma).reshape(values.shape) if sigma else values
            add_planes(own[:, start : start + len(values)].copy(), around, rest)
    result = combine_planes(weights.last, _rectify(rest, weights.second_bias))
    return Window(result - result.mean(axis=1, keepdims=True), shape)


def _reduce(narrow: Window, numbers: list[int], shape: tuple[int, int]) -> Float32[np.ndarray, "k n"]:
    planes, means = narrow.planes.reshape(-1, *narrow.shape), np.empty((len(numbers), *shape), np.float32)

    @plain_opencv()
    def work(share: Iterable[int]) -> None:
        for i in share:
            cv2.resize(planes[numbers[i]], shape[::-1], dst=means[i], interpolation=cv2.INTER_AREA)

    in_turns(list(range(len(numbers))), work)
    return means.reshape(len(numbers), -1)


def _rectify(values: Float32[np.ndarray, "k n"], bias: Float32[np.ndarray, "k"]) -> Float32[np.ndarray, "k n"]:
    values += bias[:, None]
    return np.maximum(values, 0, out=values)
