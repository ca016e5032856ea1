"""The range of nearness that spans the reliefs of a film: kept, so that the relief does not breathe."""

import math
from typing import final

from ...scene.geometry import ValueRange

ADAPTS_S = 10.0
"""Time constant in which the range follows what is seen: 10 mm of relief then move by 1 mm/s at most."""


@final
class Scale:
    """The range of the first frame, which follows that of later ones slowly."""

    def __init__(self, first: ValueRange, time_s: float = 0.0) -> None:
        self.spans = first
        self._time_s = time_s

    def look(self, seen: ValueRange, time_s: float) -> None:
        """What a frame at this time of the film shows.

        The first range that is not empty is taken as it is: a film may begin in the dark.
        """
        share = 1 - math.exp(-max(0.0, time_s - self._time_s) / ADAPTS_S)
        self._time_s = time_s
        if not self.spans.low < self.spans.high:
            self.spans = seen
        elif seen.low < seen.high:
            low, high = (then + share * (now - then) for then, now in zip(self.spans, seen, strict=True))
            self.spans = ValueRange(low, high)
