"""The observer with the noise of a hand."""

from math import log, log1p
from typing import Annotated, Literal, Self, final

import numpy as np
from pydantic import Field

from ..design import Comparison, Stimulus, Trial
from .observer import Observer, decide

JND_FORCE = 0.07
"""Just noticeable difference of force, as a share of it (Pang, Tan & Durlach 1991, Percept. Psychophys. 49:531)."""
JND_HEIGHT_M = 0.13e-3
"""Height of a bump 10 mm wide that a bare finger notices, metres (Gaussian profiles, VU Amsterdam)."""
NOTICED = 0.9538726
"""d' of a just noticeable difference, with 75 % right answers in two intervals: the square root of 2 times 0.6745."""


@final
class Hand(Observer):
    """Hand: the noise stands in just noticeable differences of force or height, from the literature."""

    quantity: Literal["force", "height"] = "force"
    """Quantity that is felt: force in newtons, of which the noise is a share, or height in metres."""
    jnd: Annotated[float, Field(gt=0)] | None = None
    """Just noticeable difference, by default 0.07 of the force, or 0.00013 m of height."""
    first: Annotated[float, Field(gt=0)] = 1.0
    """Force or height of the first condition, where no level varies."""
    difference: float = 0.1
    """Force or height from each condition to the next, where no level varies."""
    base: Annotated[float, Field(ge=0)] = 1.5
    """d' of the parts that are to be named, in the first condition."""

    def participant(self, generator: np.random.Generator) -> Self:
        """Return a participant with a just noticeable difference of their own."""
        jnd = self.jnd or (JND_FORCE if self.quantity == "force" else JND_HEIGHT_M)
        return self.model_copy(update={"jnd": jnd * float(np.exp(self.spread * generator.standard_normal()))})

    def refusal(self, comparison: Comparison) -> str:
        """Return which levels are not forces."""
        if self.quantity == "force" and any(level <= 0 for level in (comparison.standard or 1.0, *comparison.levels)):
            return "has levels that are not forces above 0; set quantity=height"
        return ""

    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        """Return the response by the decision rule that the question asks for."""
        jnd = self.jnd or (JND_FORCE if self.quantity == "force" else JND_HEIGHT_M)

        def magnitude(stimulus: Stimulus) -> float:
            amount = self.first + self.difference * comparison.conditions.index(stimulus.condition)
            amount = amount if stimulus.level is None else stimulus.level
            if self.quantity == "height":
                return NOTICED * (amount - self.first) / jnd
            return NOTICED * log(max(amount, 1e-6) / self.first) / log1p(jnd)

        return decide(trial, magnitude, self.base, generator)
