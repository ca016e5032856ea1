"""The range of nearness that spans the reliefs of a film: it changes slowly, so that the relief does not pulsate."""

import math
from typing import final

from ...scene.geometry import ValueRange

ADAPTS_S = 10.0
"""Time constant with which the range follows the frames: a relief of 10 mm then moves by 1 mm/s at most."""


@final
class Scale:
    """The range of the first frame, which follows that of later ones slowly."""

    def __init__(self, first: ValueRange, time_s: float = 0.0) -> None:
        self.spans = first
        self._time_s = time_s

    def look(self, seen: ValueRange, time_s: float) -> None:
        """Follow the range of a frame at this time of the film; the first that is not empty is adopted at once.

        That is for films that begin in the dark.
        """
        share = 1 - math.exp(-max(0.0, time_s - self._time_s) / ADAPTS_S)
        self._time_s = time_s
        if not self.spans.low < self.spans.high:
            self.spans = seen
        elif seen.low < seen.high:
            low, high = (then + share * (now - then) for then, now in zip(self.spans, seen, strict=True))
            self.spans = ValueRange(low, high)
