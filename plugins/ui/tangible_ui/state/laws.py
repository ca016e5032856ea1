"""Two force laws compared: which one acts, and what pages see of the other."""

import math
from dataclasses import dataclass
from typing import Any

from tangible_web.state_frame import ALONE, OtherLaw

from ..feeling.comparison import ComparisonLoop
from ..feeling.feeling import Feeling


@dataclass
class Laws:
    """The document's law and a second one; without a comparison, the document's alone."""

    comparison: ComparisonLoop
    other: dict[str, Any] | None = None
    """The second law, as `render:` has it."""
    named: tuple[str, str] = ("", "")
    felt: int = 0
    """Index of the law that acts."""

    def alone(self) -> None:
        """End the comparison."""
        self.other, self.felt = None, 0

    def follow(self, feeling: Feeling) -> None:
        """Move the hand of the second law's loop to that of the first. Meant to be polled; returns at once."""
        servo = feeling.servo
        if not self.comparison.running or servo is None or (row := servo.ring.latest()) is None:
            return
        x, y, z = row[2:5].tolist()
        self.comparison.follow((x, y, z if feeling.running else math.inf))

    def other_law(self) -> OtherLaw:
        """Return what frames show of the second law."""
        return ALONE if self.other is None else OtherLaw(self.comparison.force_n)

    @property
    def shown_name(self) -> str:
        """The name of the law that does not act."""
        return self.named[1 - self.felt]

    def message(self) -> dict[str, Any]:
        """Return the message `laws`: what pages may know."""
        if self.other is None:
            return {"state": "one"}
        return {"state": "two", "named": list(self.named), "felt": self.felt}
