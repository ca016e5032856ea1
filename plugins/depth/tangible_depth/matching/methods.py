"""What methods share that compare square windows along the rows of two views."""

from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator, Following

if TYPE_CHECKING:
    from ..dense.refinement import DenseMatches
    from ..dense.span import Span
    from ..search.pairs import Pair
    from .chain import Matcher, Search


def _check_odd(value: int) -> int:
    if value % 2 == 0:
        raise ValueError(f"the side of a window must be odd, not {value}; take {value - 1} or {value + 1}")
    return value


class WindowMatcher(DepthEstimator, Following):
    """A method that compares square windows; 19 pixels wide at most, so that the sums of `correlation` fit 32 bits."""

    needs_pair: ClassVar[bool] = True

    window_px: Annotated[int, Field(ge=3, le=19), AfterValidator(_check_odd)] = 7
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
        """Estimate disparity in pixels, float32 (h, w), and its confidence; a filled map is finite if anything matched.

        Confidence: 0.2 up to that of `window_matching` where a match was found; 0 up to 0.1 where the value was filled
        or decided by a neighbour; less in either range next to depth steps and in gaps; 0 where nothing changes along
        the rows.
        Raises: PictureError if there is no right view or the range is empty.
        """
        from .chain import disparity_map

        return disparity_map(views, *self._named_search_and_matcher())

    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """Return `estimate` for a film: it rectifies by these views and follows the range of recent frames."""
        from .chain import FilmMatcher

        return FilmMatcher(views, *self._named_search_and_matcher())

    @abstractmethod
    def _named_measure(self) -> "tuple[str, Callable[[Pair, Span, int], DenseMatches]]":
        """Return the method's name, and the matching by its measure of windows of some width."""

    def _named_search_and_matcher(self) -> "tuple[str, Search, Matcher]":
        from .chain import Search

        name, match = self._named_measure()
        search = Search(self.min_disparity_px, self.max_disparity_px, self.rectify, self.fill)
        return name, search, lambda pair, span: match(pair, span, self.window_px)
