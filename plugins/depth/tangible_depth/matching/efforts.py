"""What either effort of `semi-global` tries first, trusts and spends."""

from typing import NamedTuple

from ..dense.speckles import ISLAND_PX
from ..sgm.costs import LEVELS, SHARP, Cost
from ..sgm.strips import WARM_ROWS


class Effort(NamedTuple):
    """How much is spent on a pair."""

    first: Cost
    """The cost that is tried first."""
    doubt: float
    """Loss from which `sharp` gives way to a cost for noise."""
    least_differing: float
    """Share of differing bits from which it does."""
    warm_rows: int
    """Rows by which the paths of a strip begin early: the smaller the islands kept, the farther a seam is seen."""
    small_islands: bool
    """Islands are kept from a size on that the cost says, rather than from ISLAND_PX."""
    eight_sides: bool
    """Gaps are filled from eight sides in place of four."""

    def largest_speck_px(self, cost: Cost, factor: int = 1) -> int:
        """Islands up to here are errors, in a picture made smaller by `factor`."""
        return (cost.largest_speck_px if self.small_islands else ISLAND_PX) // factor**2


BALANCED = Effort(SHARP, 0.06, 0.28, WARM_ROWS, small_islands=False, eight_sides=False)
BEST = Effort(LEVELS, 0.11, 0.315, 48, small_islands=True, eight_sides=True)
EFFORTS = {"balanced": BALANCED, "best": BEST}
