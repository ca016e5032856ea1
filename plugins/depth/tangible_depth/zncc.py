"""Dense zero-mean normalised cross-correlation."""

from typing import Any

from .matching.methods import WindowMatcher


class Zncc(WindowMatcher):
    """Window matching by normalised cross-correlation, with sub-pixel refinement, left-right check and filling.

    Local, so that it does not guess without texture; independent of gain and offset of the exposure.
    Colour is reduced to grey.
    Memory above the pictures: about 25 bytes a pixel, and 8 bytes a column and disparity for each thread.
    Source: the report "Tangible Images", ch. 2, matching value (2.14).
    """

    def _named_measure(self) -> tuple[str, Any]:
        from .matching.window_matching import match_by_correlation

        return "zncc", match_by_correlation
