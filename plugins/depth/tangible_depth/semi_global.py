"""Semi-global matching of census codes: the default, for its time and its error."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator, Following

if TYPE_CHECKING:
    from .matching.chain import Matcher, Search


class SemiGlobal(DepthEstimator, Following):
    """Semi-global matching of census codes along four paths: precise at depth edges, robust to exposure and noise.

    The default for a pair of photographs. `zncc` does not guess where there is no texture, `opencv-sgbm` is a
    yardstick, and `onnx` runs a network of your own; for a single photograph take `cues`.

    >>> import numpy as np
    >>> from tangible import SemiGlobal, Views
    >>> left = np.random.default_rng(0).integers(0, 256, (64, 96), np.uint8)
    >>> right = np.roll(left, -5, axis=1)  # every point is seen five pixels further to the left
    >>> float(SemiGlobal().estimate(Views(left, right)).disparity_px[32, 48])
    5.0

    Steps that a pair does not need are skipped, with a note: disparities that do not occur, rows without texture, a
    second view that equals the first. A pair whose views are exchanged is matched as well: its disparities are
    negative, and a warning is logged. A constant vertical offset between the rows is corrected.
    Colour is reduced to grey.

    Memory above the pictures: about 25 bytes a pixel, measured to 18 megapixels, and at most 256 MiB for the cost
    volumes of all strips at work; with `effort: best` about 32 bytes a pixel.
    Source: Hirschmueller, IEEE PAMI 30(2), 2008; census after Zabih & Woodfill, ECCV 1994.
    """

    needs_pair: ClassVar[bool] = True

    max_disparity_px: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Upper end of the search range, exclusive; auto: estimated from a few bands of the pair."""
    min_disparity_px: int | Literal["auto"] = "auto"
    """Lower end of the search range; auto: 0 if the upper end is given, otherwise estimated with it, of either sign."""
    resolution: Literal["full", "half", "auto"] = "auto"
    """Resolution of the matching. auto: full, unless the search range is too large. half: a preview in a fraction of
    the time, without tests for noise and for vertical offset: `cost` auto is sharp, and rows are not realigned."""
    effort: Literal["balanced", "best"] = "balanced"
    """best: the right view is matched as well; its matches remove those of the left view that they contradict, and
    close some of its gaps. The other gaps are filled from eight directions instead of four, along the plane of each
    surface. About 7 % fewer wrong pixels than balanced for two and a half times the processor time."""
    cost: Literal["auto", "sharp", "levels", "light", "heavy"] = "auto"
    """Matching cost: sharp compares the order of grey values, levels the values as well, for clean pictures of the
    same exposure; light and heavy are for light and heavy noise; auto: chosen by a test on part of the picture."""
    rectify: Literal["auto", "never"] = "auto"
    """auto: rectify a pair whose rows do not correspond; never: take every pair as rectified."""
    check: Literal["soft", "strict"] = "soft"
    """Left-right check. soft: keep a match whose cost is within 8 % of the right pixel's best; strict: keep mutual best
    matches only."""
    fill: bool = True
    """Fill pixels without a match with the disparity that both views and the picture's edges suggest; if false they are
    NaN."""
    realign_rows: bool = True
    """Measure and correct a constant vertical offset between the views."""
    skip_identical: bool = True
    """Identical views: return 0 everywhere and skip the matching."""
    skip_flat: bool = True
    """Strips without any change along their rows: fill them and skip the matching."""

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate disparity in pixels, float32 (h, w), and its confidence; a filled map is finite if anything matched.

        Confidence: 0.2 up to 1 - (differing bits along the winner's four paths) / (all bits) where a match was found;
        0 up to 0.1 where the value was filled or decided by a neighbour; less in either range next to depth steps and
        in gaps; 0 where nothing changes along the rows.
        Raises: PictureError if there is no right view or the range is empty.
        """
        from .matching.chain import disparity_map

        return disparity_map(views, "semi-global", *self._search_and_matcher())

    def rehearse(self) -> None:
        """Fill the gaps of made-up matches: a quarter of what is compiled for `estimate`."""
        from .dense.filling.gaps import fill_gaps, made_up_matches

        fill_gaps(*made_up_matches(), self.effort)

    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """Return `estimate` for a film: it rectifies by these views and follows the range of recent frames."""
        from .matching.chain import FilmMatcher

        return FilmMatcher(views, "semi-global", *self._search_and_matcher())

    def _search_and_matcher(self) -> "tuple[Search, Matcher]":
        from .matching.adaptive import MAX_ROW_OFFSET_PX
        from .matching.chain import Search
        from .matching.scaling import Scaling, match_scaled

        search = Search(
            self.min_disparity_px,
            self.max_disparity_px,
            self.rectify,
            self.fill,
            most_row_offset_px=MAX_ROW_OFFSET_PX if self.realign_rows and self.resolution != "half" else 0.0,
            skip_identical=self.skip_identical,
        )
        options = Scaling(self.resolution, self.effort, self.cost, self.check, self.realign_rows, self.skip_flat)
        return search, lambda pair, span: match_scaled(pair, span, options)
