"""Semi-global matching of census codes: the default, for its time and its error."""

from typing import Annotated, Literal

from pydantic import Field

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins.interfaces import DepthEstimator


class SemiGlobal(DepthEstimator):
    """Census codes matched along four paths; exact at depth edges and safe against exposure and noise.

    What a pair does not need is left out and said: the search of disparities that do not occur, rows without texture,
    a second view that equals the first. A pair whose views are exchanged is matched as well: its disparities are
    negative, and a warning says so. Rows that miss each other by a constant are put right.
    Colour is reduced to grey.

    Memory above the pictures: about 25 bytes a pixel, measured to 18 megapixels, and at most 256 MiB for the cost
    volumes of all strips at work.
    Source: Hirschmueller, IEEE PAMI 30(2), 2008; census after Zabih & Woodfill, ECCV 1994.
    """

    max_disparity_px: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Disparities from the least to one less than this are tried; auto: found in a few bands of the pair."""
    min_disparity_px: int | Literal["auto"] = "auto"
    """The least disparity tried; auto: 0 if the largest is given, else found with the range, of either sign."""
    resolution: Literal["full", "half", "auto"] = "auto"
    """Size at which is matched. auto: full, as long as the range allows. half: a preview in a fraction of the time, in
    which costs and rows are not tried: `cost` auto is sharp, and rows are taken as they are."""
    cost: Literal["auto", "sharp", "light", "heavy"] = "auto"
    """What is compared: sharp for clean pictures, light and heavy for noise; auto: tried on a part of the picture."""
    rectify: Literal["auto", "never"] = "auto"
    """auto: a pair whose rows do not correspond is rectified first; never: every pair is taken as rectified."""
    check: Literal["soft", "strict"] = "soft"
    """Left-right check. soft: a match within 8 % of the right pixel's best is kept; strict: only the best."""
    fill: bool = True
    """Whether pixels without a match take the disparity that both views and the picture's edges suggest, else NaN."""
    realign_rows: bool = True
    """Whether a constant vertical offset between the views is measured and put right."""
    skip_identical: bool = True
    """Whether a second view that equals the first is known by looking: every disparity is 0."""
    skip_flat: bool = True
    """Whether strips in which nothing changes along the rows are filled instead of matched."""

    def estimate(self, views: Views) -> DisparityMap:
        """Disparity in pixels, float32 (h, w), and its confidence; a filled map is finite unless nothing matched.

        Confidence: 1 - (differing bits along the winner's four paths) / (all bits) where a match was found, at least
        0.2; 0.1 where the value was filled or decided by a neighbour; 0 where nothing changes along the rows.
        Raises: PictureError if there is no right view or the range is empty.
        """
        from .matching.adaptive import MOST_ROW_OFFSET_PX
        from .matching.chain import Search, disparity_map
        from .matching.scaled import Scaling, match_scaled

        search = Search(
            self.min_disparity_px,
            self.max_disparity_px,
            self.rectify,
            self.fill,
            most_row_offset_px=MOST_ROW_OFFSET_PX if self.realign_rows and self.resolution != "half" else 0.0,
            skip_identical=self.skip_identical,
        )
        options = Scaling(self.resolution, self.cost, self.check, self.realign_rows, self.skip_flat)
        return disparity_map(views, "semi-global", search, lambda pair, span: match_scaled(pair, span, options))
