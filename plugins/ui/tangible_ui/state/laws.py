"""Which two laws are compared, and how."""

import math
from dataclasses import dataclass
from typing import Any

from ..feeling.comparison import Rival
from ..feeling.feeling import ALONE, Beside, Feeling
from .blind import Tally


@dataclass
class Laws:
    """The document's law and another one; none while one law alone is felt."""

    rival: Rival
    other: dict[str, Any] | None = None
    """The other law, as `render:` has it."""
    named: tuple[str, str] = ("", "")
    felt: int = 0
    """Which of the two is felt."""
    tally: Tally | None = None
    """Of a blind comparison that goes on."""
    called: int = 1
    """What the law that is felt is called there."""

    def alone(self) -> None:
        """One law again; what was counted is lost."""
        self.other, self.tally, self.felt = None, None, 0

    def follow(self, feeling: Feeling) -> None:
        """Hand the hand that is felt on to the law beside. To be called often; returns at once."""
        servo = feeling.servo
        if not self.rival.running or servo is None or (row := servo.ring.latest()) is None:
            return
        x, y, z = row[2:5].tolist()
        self.rival.follow((x, y, z if feeling.running else math.inf))

    def beside(self) -> Beside:
        """What pages are shown of the other law."""
        if self.tally is not None:
            return Beside(blind=True)
        return ALONE if self.other is None else Beside(self.rival.force_n)

    def told(self) -> dict[str, Any]:
        """What pages may know."""
        if self.tally is not None:
            trials = len(self.tally.trials)
            return {"state": "blind", "called": self.called, "trials": trials, "question": self.tally.question}
        if self.other is not None:
            return {"state": "two", "named": list(self.named), "felt": self.felt}
        return {"state": "one"}
