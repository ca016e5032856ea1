"""The observer models by name, their interface, and their options from a command line."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from math import log, log1p
from typing import Annotated, Any, Literal, Self, final

import numpy as np
from pydantic import Field

from tangible_core.errors import ConfigError, did_you_mean, quoted
from tangible_core.files.yaml import parse_override
from tangible_core.scene import Section

from ..design import Comparison, Stimulus, Trial
from ..measures.functions import Threshold
from ..questions import load_question
from ..questions.question import Percept
from ..study_file import StudyFile

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
    """Return the response of an observer who feels each interval with noise of standard deviation 1."""
    strengths = np.array([magnitude(interval) for interval in trial.intervals]) + generator.standard_normal(
        len(trial.intervals)
    )
    return load_question(trial.question).decide(trial, Percept(strengths, magnitude, base), generator)


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
        scale = 1 + self.spread * generator.standard_normal(2)
        base = max(self.base * float(scale[1]), 0.0)
        return self.model_copy(update={"difference": self.difference * float(scale[0]), "base": base})

    def refusal(self, comparison: Comparison) -> str:
        return ""

    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        noise = self.noise or (float(np.ptp(comparison.levels)) / 4 if comparison.levels else 0.0) or 1.0

        def magnitude(stimulus: Stimulus) -> float:
            if stimulus.level is not None:
                return stimulus.level / noise
            return self.difference * comparison.conditions.index(stimulus.condition)

        return decide(trial, magnitude, self.base, generator)


# Just noticeable difference of force, as a share of it (Pang, Tan & Durlach 1991, Percept. Psychophys. 49:531).
JND_FORCE = 0.07
JND_HEIGHT_M = 0.13e-3
"""Height of a bump 10 mm wide that a bare finger notices, metres (Gaussian profiles, VU Amsterdam)."""
# d' of a just noticeable difference, with 75 % right answers in two intervals: the square root of 2 times 0.6745.
NOTICED = 0.9538726


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
        jnd = self.jnd or (JND_FORCE if self.quantity == "force" else JND_HEIGHT_M)
        return self.model_copy(update={"jnd": jnd * float(np.exp(self.spread * generator.standard_normal()))})

    def refusal(self, comparison: Comparison) -> str:
        if self.quantity == "force" and any(level <= 0 for level in (comparison.standard or 1.0, *comparison.levels)):
            return "has levels that are not forces above 0; set quantity=height"
        return ""

    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        jnd = self.jnd or (JND_FORCE if self.quantity == "force" else JND_HEIGHT_M)

        def magnitude(stimulus: Stimulus) -> float:
            amount = self.first + self.difference * comparison.conditions.index(stimulus.condition)
            amount = amount if stimulus.level is None else stimulus.level
            if self.quantity == "height":
                return NOTICED * (amount - self.first) / jnd
            return NOTICED * log(max(amount, 1e-6) / self.first) / log1p(jnd)

        return decide(trial, magnitude, self.base, generator)


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
        difference = self.difference * (1 + self.spread * generator.standard_normal())
        shift = self.shift + self.personal * generator.standard_normal()
        return self.model_copy(update={"difference": float(difference), "shift": float(shift)})

    def refusal(self, comparison: Comparison) -> str:
        if not (comparison.levels and load_question(comparison.question).has_threshold):
            return "has no levels that are compared, which this observer needs; take the observer `detection`"
        return ""

    def respond(self, trial: Trial, comparison: Comparison, generator: np.random.Generator) -> str:
        width = self.width or 0.5 * float(np.ptp(comparison.levels)) or 1.0
        shift = self.difference * comparison.conditions.index(trial.condition) + self.shift * width
        truth = Threshold(self.threshold, shift, width, self.slope)
        return load_question(trial.question).draw(trial, comparison, truth, generator)


OBSERVERS: Mapping[str, type[Observer]] = {"psychometric": Psychometric, "detection": Detection, "hand": Hand}


def make_observer(name: str, sets: Sequence[str], file: StudyFile) -> Observer:
    """Return an observer for a study. sets: its options, `key=value` each. Raises: ConfigError."""
    if name not in OBSERVERS:
        names = ", ".join(OBSERVERS)
        raise ConfigError(
            f"--observer: no observer is called {quoted(name)}{did_you_mean(name, OBSERVERS)}; known: {names}"
        )
    options: dict[str, Any] = {".".join(keys): value for keys, value in map(parse_override, sets)}
    observer = OBSERVERS[name](**options)
    for comparison in file.study.comparisons:
        if refusal := observer.refusal(comparison):
            raise ConfigError(f"{comparison.name}: {refusal}")
    return observer
