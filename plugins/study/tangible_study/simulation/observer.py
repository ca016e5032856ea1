"""The interface of observer models, and how an observer with noise decides."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Annotated, Self

import numpy as np
from pydantic import Field

from tangible_core.scene import Section

from ..design.study import Comparison
from ..design.trial import DIFFERENT, SAME, Stimulus, Trial

Share = Annotated[float, Field(ge=0, le=0.5)]


CRITERION = 1.5
"""Difference from which two intervals are called different, in standard deviations of the noise of one."""


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
    where the magnitude is 0. Most is the strongest interval; the odd one is farthest from the mean of the others.
    """
    felt = np.array([magnitude(each) for each in trial.intervals]) + generator.standard_normal(len(trial.intervals))
    match trial.question:
        case "same":
            others = (felt.sum() - felt) / (len(felt) - 1)
            return str(int(np.argmax(np.abs(felt - others))) + 1)
        case "different":
            return DIFFERENT if abs(felt[0] - felt[1]) > CRITERION else SAME
        case "name":
            evidence = generator.standard_normal(len(trial.choices))
            evidence[trial.choices.index(trial.target or "")] += max(base + magnitude(trial.intervals[0]), 0.0)
            return trial.choices[int(np.argmax(evidence))]
        case "rating":
            middle = (len(trial.choices) - 1) / 2
            return trial.choices[int(np.clip(round(middle + float(felt[0])), 0, len(trial.choices) - 1))]
        case "equal":
            wanted = float(felt[0]) + float(generator.standard_normal())
            return nearest(wanted, trial, lambda level: magnitude(Stimulus(trial.condition, level)))
        case _:
            return str(int(np.argmax(felt)) + 1)


def nearest(wanted: float, trial: Trial, scale: Callable[[float], float] = float) -> str:
    """Return the level that can be set that is nearest to what is wanted, on a scale of its own."""
    return min(trial.choices, key=lambda each: abs(scale(float(each)) - wanted))
