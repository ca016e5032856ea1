"""The psychometric observer."""

from typing import Annotated, Self, final

import numpy as np
from pydantic import Field

from ..design import Comparison, Trial
from ..measures.functions import Threshold
from ..questions import load_question
from .observer import Observer


@final
class Psychometric(Observer):
    """Psychometric function: threshold, width and lapses, as `tangible study analyse` finds them."""

    threshold: float | None = None
    """Level that feels equal to the standard, by default the standard; of the odd one (`same`), the distance from the
    standard at which 67 % of the answers are right, by default half of the greatest."""
    width: Annotated[float, Field(gt=0)] | None = None
    """Distance of the levels at which 5 and 95 % of the way are done, by default half of the range of levels."""
    slope: Annotated[float, Field(gt=0)] = 2.0
    """Exponent of the Weibull function of the odd one."""
    difference: float = 0.0
    """Difference of the threshold from each condition to the next, in the unit of the levels."""
    personal: Annotated[float, Field(ge=0)] = 0.1
    """Standard deviation of the threshold over participants, as a share of the width."""
    shift: float = 0.0
    """Difference of one participant's threshold from that of others, as a share of the width."""

    def participant(self, generator: np.random.Generator) -> Self:
        """Return a participant with a threshold and a difference between conditions of their own."""
        difference = self.difference * (1 + self.spread * generator.standard_normal())
        shift = self.shift + self.personal * generator.standard_normal()
        return self.model_copy(update={"difference": float(difference), "shift": float(shift)})

    def refusal(self, comparison: Comparison) -> str:
        """Return what is missing: levels."""
        if not (comparison.levels and load_question(comparison.question).has_threshold):
            return "has no levels that are compared, which this observer needs; take the observer `detection`"
        return ""

    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        """Return a response by the function of the condition."""
        width = self.width or 0.5 * float(np.ptp(comparison.levels)) or 1.0
        shift = self.difference * comparison.conditions.index(trial.condition) + self.shift * width
        truth = Threshold(self.threshold, shift, width, self.slope)
        return load_question(trial.question).draw(trial, comparison, truth, generator)
