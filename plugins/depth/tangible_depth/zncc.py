"""Dense zero-mean normalised cross-correlation."""

from typing import Any

from .matching.methods import WindowMatcher


class Zncc(WindowMatcher):
    """Window matching by normalised cross-correlation, with sub-pixel refinement, left-right check and filling.

    For surfaces with texture everywhere, and for views of different exposure, of whose gain and offset it is
    independent. It is local: without texture it does not guess. A window blurs depth edges, which `semi-global` keeps.
    Colour is reduced to grey.

    >>> import numpy as np
    >>> from tangible import Views, Zncc
    >>> left = np.random.default_rng(0).integers(0, 256, (64, 96), np.uint8)
    >>> right = np.roll(left, -5, axis=1)
    >>> float(Zncc().estimate(Views(left, right)).disparity_px[32, 48])
    5.0

    Memory above the pictures: about 25 bytes a pixel, and 8 bytes a column and disparity for each thread.
    Source: the report "Tangible Images", ch. 2, matching value (2.14).
    """

    def _named_measure(self) -> tuple[str, Any]:
        from .matching.window_matching import match_by_correlation

        return "zncc", match_by_correlation
