"""Two force laws compared: which one acts, and the trials of a blind comparison."""

import math
import secrets
from dataclasses import dataclass, field
from typing import Any, Literal

from tangible_web.state_frame import ALONE, OtherLaw

from ..feeling.comparison import ComparisonLoop
from ..feeling.feeling import Feeling

Choice = Literal[0, 1, 2]
"""The law named 1 or 2; 0 for neither."""


@dataclass
class Tally:
    """Trials of two laws. `draw` begins one, `choose` ends it."""

    laws: tuple[str, str]
    question: str
    """The question of each trial."""
    trials: list[tuple[str, str, str]] = field(default_factory=list[tuple[str, str, str]])
    """Trials: the law named 1, the law named 2, and the chosen law, "" for neither."""
    first: int = 0
    """Index of the law that is named 1 now."""

    def draw(self) -> None:
        """Begin another trial."""
        self.first = secrets.randbelow(2)

    def law(self, called: int) -> int:
        """Return the index of the law that is named 1, or 2."""
        return self.first if called == 1 else 1 - self.first

    def choose(self, choice: Choice) -> None:
        """Count the choice of this trial, and draw the next one."""
        named = self.laws[self.law(1)], self.laws[self.law(2)]
        self.trials.append((*named, self.laws[self.law(choice)] if choice else ""))
        self.draw()

    @property
    def counts(self) -> tuple[int, int, int]:
        """Numbers of choices: of each law, and of neither."""
        chosen = [trial[2] for trial in self.trials]
        one, two = (sum(1 for each in chosen if each == law) for law in self.laws)
        return one, two, len(chosen) - one - two

    @property
    def chance(self) -> float:
        """Probability of a result at least this one-sided without any difference between the laws; exact.

        The two-sided sign test, trials without a choice left out. Source: Dixon and Mood, J. Am. Stat. Assoc. 41
        (1946), 557.

        >>> Tally(("a", "b"), "", [("a", "b", "a")] * 5).chance
        0.0625
        """
        one, two, _ = self.counts
        trials, fewer = one + two, min(one, two)
        tail = sum(math.comb(trials, k) for k in range(fewer + 1)) / 2**trials
        return min(1.0, 2 * tail)

    def as_data(self) -> dict[str, Any]:
        """Return all of it as JSON data."""
        one, two, neither = self.counts
        return {
            "question": self.question,
            "laws": list(self.laws),
            "chosen": [one, two],
            "neither": neither,
            "trials": [list(each) for each in self.trials],
            "chance": self.chance,
        }


@dataclass
class Laws:
    """The document's law and a second one; without a comparison, the document's alone."""

    comparison: ComparisonLoop
    other: dict[str, Any] | None = None
    """The second law, as `render:` has it."""
    named: tuple[str, str] = ("", "")
    felt: int = 0
    """Index of the law that acts."""
    tally: Tally | None = None
    """Trials of a blind comparison in progress."""
    called: int = 1
    """Name of the acting law in the trial, 1 or 2."""

    def alone(self) -> None:
        """End the comparison; its trials are lost."""
        self.other, self.tally, self.felt = None, None, 0

    def follow(self, feeling: Feeling) -> None:
        """Move the hand of the second law's loop to that of the first. Meant to be polled; returns at once."""
        servo = feeling.servo
        if not self.comparison.running or servo is None or (row := servo.ring.latest()) is None:
            return
        x, y, z = row[2:5].tolist()
        self.comparison.follow((x, y, z if feeling.running else math.inf))

    def other_law(self) -> OtherLaw:
        """Return what frames show of the second law."""
        if self.tally is not None:
            return OtherLaw(blind=True)
        return ALONE if self.other is None else OtherLaw(self.comparison.force_n)

    @property
    def shown_name(self) -> str:
        """The name of the law that does not act."""
        return self.named[1 - self.felt]

    def message(self) -> dict[str, Any]:
        """Return the message `laws`: what pages may know."""
        if self.tally is not None:
            trials = len(self.tally.trials)
            return {"state": "blind", "called": self.called, "trials": trials, "question": self.tally.question}
        if self.other is not None:
            return {"state": "two", "named": list(self.named), "felt": self.felt}
        return {"state": "one"}
