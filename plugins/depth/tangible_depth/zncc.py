"""Dense zero-mean normalised cross-correlation."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins.interfaces import DepthEstimator, Following

from .windows.odd import WindowSide

if TYPE_CHECKING:
    from .matching.chain import Matcher, Search


class Zncc(DepthEstimator, Following):
    """Window matching by normalised cross-correlation, with sub-pixel refinement, left-right check and filling.

    Local, so that it does not guess where there is no texture; indifferent to gain and offset of exposure.
    Colour is reduced to grey.
    Memory above the pictures: about 25 bytes a pixel, and 8 bytes a column and disparity for each thread.
    Source: the report "Tangible Images", ch. 2, matching value (2.14).
    """

    needs_pair: ClassVar[bool] = True
    version: ClassVar[int] = 5

    window_px: WindowSide = 7
    """Side of the square matching window; odd."""
    max_disparity_px: Annotated[int, Field(ge=1, le=512)] | Literal["auto"] = "auto"
    """Upper end of the search range, exclusive; auto: estimated from a few bands of the pair."""
    min_disparity_px: int | Literal["auto"] = "auto"
    """Lower end of the search range; auto: 0 if the upper end is given, otherwise estimated with it, of either sign."""
    rectify: Literal["auto", "never"] = "auto"
    """auto: rectify a pair whose rows do not correspond; never: take every pair as rectified."""
    fill: bool = True
    """Fill pixels without a match with the disparity that both views and the picture's edges suggest; if false they are
    NaN."""

    def estimate(self, views: Views) -> DisparityMap:
        """Disparity in pixels, float32 (h, w), and its confidence; a filled map is finite unless nothing matched.

        Confidence: 0.2 up to the correlation where a match was found; 0 up to 0.1 where the value was filled or decided
        by a neighbour; less in either range beside steps of depth and in gaps; 0 where nothing changes along the rows.
        Raises: PictureError if there is no right view or the range is empty.
        """
        from .matching.chain import disparity_map

        return disparity_map(views, "zncc", *self._how())

    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """`estimate` for a film: rectified as these views need it, over the range of what was seen of late."""
        from .matching.film import FollowedPair

        return FollowedPair(views, "zncc", *self._how())

    def _how(self) -> "tuple[Search, Matcher]":
        """What the chain is told, and what matches."""
        from .matching.chain import Search
        from .matching.window_matching import match_by_correlation

        search = Search(self.min_disparity_px, self.max_disparity_px, self.rectify, self.fill)
        return search, lambda pair, span: match_by_correlation(pair, span, self.window_px)
