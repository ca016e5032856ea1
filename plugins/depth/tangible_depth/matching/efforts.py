"""What either effort of `semi-global` tries first, trusts and spends."""

from typing import NamedTuple

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
    """Rows by which the paths of a strip begin early: the more, the less a seam is seen."""
    eight_sides: bool
    """Gaps are filled from eight sides in place of four, and surfaces go on into them as they lie."""


BALANCED = Effort(SHARP, 0.06, 0.28, WARM_ROWS, eight_sides=False)
BEST = Effort(LEVELS, 0.11, 0.315, 48, eight_sides=True)
EFFORTS = {"balanced": BALANCED, "best": BEST}
