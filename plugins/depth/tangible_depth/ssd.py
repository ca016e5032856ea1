"""Dense sums of squared differences."""

from typing import TYPE_CHECKING

from tangible_core.data import DisparityMap, Views

from .matching.methods import WindowMatcher

if TYPE_CHECKING:
    from .matching.chain import Matcher, Search


class Ssd(WindowMatcher):
    """Window matching by squared differences, with sub-pixel refinement, left-right check and filling.

    The simplest measure, for pairs of equal exposure; `zncc` allows for different ones.
    Colour is reduced to grey.
    Memory above the pictures: about 25 bytes a pixel, and 8 bytes a column and disparity for each thread.
    Source: the report "Tangible Images", ch. 2.
    """

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate disparity in pixels, float32 (h, w), and its confidence; a filled map is finite if anything matched.

        Confidence: 0.2 up to exp(-(mean squared difference of grey levels) / 400) where a match was found; 0 up to 0.1
        where the value was filled or decided by a neighbour; less in either range next to depth steps and in gaps;
        0 where nothing changes along the rows.
        Raises: PictureError if there is no right view or the range is empty.
        """
        return self._estimate(views)

    def _named_search_and_matcher(self) -> "tuple[str, Search, Matcher]":
        from .matching.window_matching import match_by_difference

        return self._named("ssd", match_by_difference)
