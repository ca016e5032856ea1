"""Responses to Gabor filters at a picture's full resolution."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import scipy.fft
from jaxtyping import Float32

from tangible_core.threads import thread_count

from .gabor_bank import Gabor, kernel

fft: Any = scipy.fft  # whose annotations are those of its dispatcher


def even_responses(grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor]) -> Iterator[Float32[np.ndarray, "h w"]]:
    """The picture convolved with each filter's even kernel; outside of the picture is its mirror image."""
    kernels = [np.real(kernel(each)).astype(np.float32) for each in filters]
    radius = max(len(each) // 2 for each in kernels)
    shape = [fft.next_fast_len(side + 2 * radius, real=True) for side in grey.shape]
    spectrum = fft.rfft2(np.pad(grey, radius, mode="symmetric"), shape, workers=thread_count())
    for even in kernels:
        response = fft.irfft2(spectrum * fft.rfft2(even, shape), shape, workers=thread_count())
        first = radius + len(even) // 2
        yield response[first : first + grey.shape[0], first : first + grey.shape[1]]
