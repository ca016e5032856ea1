"""The interface of observer models, and how an observer with noise decides."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Annotated, Self

import numpy as np
from pydantic import Field

from tangible_core.scene import Section

from ..design import Comparison, Stimulus, Trial
from ..questions import load_question
from ..questions.question import Percept

Share = Annotated[float, Field(ge=0, le=0.5)]


class Observer(Section, ABC):
    """An observer model by its options, which are its fields."""

    lapse: Share = 0.02
    """Share of the trials that are answered without attention."""
    spread: Annotated[float, Field(ge=0)] = 0.3
    """Standard deviation over participants of the difference that they feel, as a share of it."""

    @abstractmethod
    def participant(self, generator: np.random.Generator) -> Self:
        """Return one participant of many."""

    @abstractmethod
    def refusal(self, comparison: Comparison) -> str:
        """Return why this observer cannot take part in a comparison, with the cure; "" if it can."""

    @abstractmethod
    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        """Return the response to a trial, with attention."""

    def answer(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        """Return the response to a trial; without attention, any of the choices."""
        if generator.random() < self.lapse:
            return str(generator.choice(trial.choices))
        return self.respond(trial, comparison, generator)


def decide(trial: Trial, magnitude: Callable[[Stimulus], float], base: float, generator: np.random.Generator) -> str:
    """Return the response of an observer who feels each interval with noise of standard deviation 1.

    magnitude: how strong a stimulus is, in standard deviations of the noise. base: d' between the parts that are named,
    where the magnitude is 0.
    """
    felt = np.array([magnitude(each) for each in trial.intervals]) + generator.standard_normal(len(trial.intervals))
    return load_question(trial.question).decide(trial, Percept(felt, magnitude, base), generator)
