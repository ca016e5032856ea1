"""Dense sums of squared differences."""

from typing import Any

from .matching.methods import WindowMatcher


class Ssd(WindowMatcher):
    """Window matching by squared differences, with sub-pixel refinement, left-right check and filling.

    The simplest measure, for pairs of equal exposure; `zncc` allows for different ones.
    Colour is reduced to grey.
    Memory above the pictures: about 25 bytes a pixel, and 8 bytes a column and disparity for each thread.
    Source: the report "Tangible Images", ch. 2.
    """

    def _named_measure(self) -> tuple[str, Any]:
        from .matching.window_matching import match_by_difference

        return "ssd", match_by_difference
