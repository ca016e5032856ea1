"""Which two laws are compared, and how."""

from dataclasses import dataclass
from typing import Any

from .rival import Rival
from .tally import Tally


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

    def told(self) -> dict[str, Any]:
        """What pages may know."""
        if self.tally is not None:
            return {"state": "blind", "called": self.called, "trials": len(self.tally.trials)} | {
                "question": self.tally.question
            }
        if self.other is not None:
            return {"state": "two", "named": list(self.named), "felt": self.felt}
        return {"state": "one"}
