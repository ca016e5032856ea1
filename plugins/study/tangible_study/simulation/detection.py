"""The observer of signal detection theory."""

from typing import Annotated, Self, final

import numpy as np
from pydantic import Field

from ..design import Comparison, Stimulus, Trial
from .observer import Observer, decide


@final
class Detection(Observer):
    """Signal detection: conditions differ by d', and each interval is felt with noise of standard deviation 1.

    Where a level varies, it alone is felt, alike in all conditions.
    """

    difference: float = 1.0
    """d' from each condition to the next."""
    base: Annotated[float, Field(ge=0)] = 1.5
    """d' of the parts that are to be named, in the first condition."""
    noise: Annotated[float, Field(gt=0)] | None = None
    """Standard deviation of the noise in the unit of the levels, by default a quarter of their range."""

    def participant(self, generator: np.random.Generator) -> Self:
        """Return a participant who feels differences of their own."""
        scale = 1 + self.spread * generator.standard_normal(2)
        base = max(self.base * float(scale[1]), 0.0)
        return self.model_copy(update={"difference": self.difference * float(scale[0]), "base": base})

    def refusal(self, comparison: Comparison) -> str:
        """Return "": this observer answers every question."""
        return ""

    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        """Return the response by the decision rule that the question asks for."""
        noise = self.noise or (float(np.ptp(comparison.levels)) / 4 if comparison.levels else 0.0) or 1.0

        def magnitude(stimulus: Stimulus) -> float:
            if stimulus.level is not None:
                return stimulus.level / noise
            return self.difference * comparison.conditions.index(stimulus.condition)

        return decide(trial, magnitude, self.base, generator)
