"""A blind comparison of two laws: which one is called 1 is drawn anew for each trial, and choices are counted."""

import math
import secrets
from dataclasses import dataclass, field
from typing import Any, Literal

Choice = Literal[0, 1, 2]
"""The one that is called 1, or 2; 0 for neither."""


@dataclass
class Tally:
    """Trials of two laws. `draw` begins one, `choose` ends it."""

    laws: tuple[str, str]
    question: str
    """What is asked in each trial."""
    trials: list[tuple[str, str, str]] = field(default_factory=list[tuple[str, str, str]])
    """Of each: the law that was called 1, the one called 2, and the one that was chosen, empty for neither."""
    first: int = 0
    """Which of the laws is called 1 now."""

    def draw(self) -> None:
        """Another trial."""
        self.first = secrets.randbelow(2)

    def law(self, called: int) -> int:
        """Which of the laws is called 1, or 2."""
        return self.first if called == 1 else 1 - self.first

    def choose(self, choice: Choice) -> None:
        """What was chosen in this trial; another one is drawn."""
        named = self.laws[self.law(1)], self.laws[self.law(2)]
        self.trials.append((*named, self.laws[self.law(choice)] if choice else ""))
        self.draw()

    @property
    def counts(self) -> tuple[int, int, int]:
        """How often each was chosen, and neither."""
        chosen = [trial[2] for trial in self.trials]
        one, two = (sum(1 for each in chosen if each == law) for law in self.laws)
        return one, two, len(chosen) - one - two

    @property
    def chance(self) -> float:
        """How likely it is that who feels no difference chooses so one-sidedly, or more; exact.

        The two-sided sign test, trials without a choice left out. Source: Dixon and Mood, J. Am. Stat. Assoc. 41
        (1946), 557.

        >>> Tally(("a", "b"), "", [("a", "b", "a")] * 5).chance
        0.0625
        """
        one, two, _ = self.counts
        trials, fewer = one + two, min(one, two)
        tail = sum(math.comb(trials, k) for k in range(fewer + 1)) / 2**trials
        return min(1.0, 2 * tail)

    def told(self) -> dict[str, Any]:
        """All of it, as JSON has it."""
        one, two, neither = self.counts
        return {
            "question": self.question,
            "laws": list(self.laws),
            "chosen": [one, two],
            "neither": neither,
            "trials": [list(each) for each in self.trials],
            "chance": self.chance,
        }
