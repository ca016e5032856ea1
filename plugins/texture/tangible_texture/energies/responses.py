"""Responses to Gabor filters at a picture's full resolution."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float32

from tangible_core.compiled.threads import thread_count

from .energy_kernels import complex_products
from .gabor_bank import Gabor, kernel
from .local_energy import fft


def even_responses(grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor]) -> Iterator[Float32[np.ndarray, "h w"]]:
    """Yield the picture convolved with each filter's even kernel; outside of the picture is its mirror image."""
    kernels = [np.real(kernel(each)).astype(np.float32) for each in filters]
    radius = max(len(each) // 2 for each in kernels)
    shape = [fft.next_fast_len(side + 2 * radius, real=True) for side in grey.shape]
    spectrum = fft.rfft2(np.pad(grey, radius, mode="symmetric"), shape, workers=thread_count())
    for even in kernels:
        response = fft.irfft2(complex_products(spectrum, fft.rfft2(even, shape)), shape, workers=thread_count())
        first = radius + len(even) // 2
        yield response[first : first + grey.shape[0], first : first + grey.shape[1]]
