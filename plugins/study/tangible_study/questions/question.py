"""A kind of question: all in which it differs from other kinds."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from typing import ClassVar, NamedTuple

import numpy as np

from ..design import Comparison, Stimulus, Trial
from ..measures.functions import CHOICE, EQUALITY, Function, Threshold, analyse_levels
from ..measures.rows import ByParticipant, Result, Row, is_sure, odds, share
from ..measures.shares import DIFFERENCE, SCALE, analyse_pairs


class Score(NamedTuple):
    """A response in numbers: None where the question has no such answer."""

    chosen: int | None = None  # 1 if the comparison was chosen over the other, 0 if not
    correct: int | None = None  # 1 or 0, where an answer can be right


class Percept(NamedTuple):
    """What an observer who is a model feels in a trial."""

    strengths: np.ndarray  # each interval, with noise of standard deviation 1
    # How strong a stimulus is without noise, in standard deviations of it.
    magnitude: Callable[[Stimulus], float]
    base: float  # d' between the parts that are named, where the magnitude is 0


class Question(ABC):
    """A kind of question; its name is that of its file."""

    sentence: ClassVar[str]
    """The question to a participant."""
    about: ClassVar[str]
    """The question in the description of the table of answers."""
    procedures: ClassVar[tuple[str, ...]]
    """Our procedures that can ask it; the first is that of a comparison that names none."""
    intervals: ClassVar[int] = 2
    """Intervals of a trial in which QUEST+ places a level."""
    function: ClassVar[Function | None] = None
    """Function of the level, if the answers have one."""
    has_threshold: ClassVar[bool] = False
    """True if an observer who is a psychometric function can answer it."""
    names_parts: ClassVar[bool] = False
    """True if the hand is led to a part, whose name is the right answer; one condition suffices then."""
    nouns: ClassVar[Mapping[str, str]] = {}
    """Measures in sentences about how conditions differ, where they have other words than `the MEASURE`."""

    @property
    def name(self) -> str:
        """Name of the kind in a study file."""
        return type(self).__module__.rpartition(".")[2]

    def ask(self, comparison: Comparison) -> str:
        """Return the question after a trial."""
        return self.sentence

    def choices(self, trial: Trial, comparison: Comparison) -> dict[str, str]:
        """Return the keys that answer a trial, each with its meaning."""
        return dict.fromkeys(trial.choices, "")

    def response(self, trial: Trial, key: str, level: float | None) -> str:
        """Return the response of a key. level: that of the last interval."""
        return key

    def next_level(self, trial: Trial, key: str, level: float | None) -> float | None:
        """Return the level at which the last interval is felt again before the key counts; None if it counts."""
        return None

    def right_answer(self, trial: Trial) -> str:
        """Return the right response; "" if there is none."""
        return trial.target or ""

    def score(self, trial: Trial, response: str) -> Score:
        """Return what a response means: the condition or level that it chose, and whether it is right."""
        right = self.right_answer(trial)
        return Score(None, int(response == right) if right else None)

    def part(self, trial: Trial) -> str | None:
        """Return the name of the part to which the hand is led; None if it goes where it likes."""
        return trial.target if self.names_parts else None

    @abstractmethod
    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        """Return the response of an observer who feels this."""

    def draw(self, trial: Trial, comparison: Comparison, truth: Threshold, generator: np.random.Generator) -> str:
        """Return the response of an observer who is a psychometric function."""
        assert self.function is not None
        if generator.random() < self.function.share(trial.level or 0.0, comparison, truth):
            return str(trial.position)
        return str(generator.choice([choice for choice in trial.choices if choice != str(trial.position)]))

    def analyse(self, comparison: Comparison, answers: ByParticipant) -> Result:
        """Analyse the answers of a comparison, whichever procedure asked."""
        varies = any(answer.level is not None for some in answers.values() for answer in some)
        if varies and self.function is not None:
            return analyse_levels(comparison, answers, self.function)
        return self.analyse_conditions(comparison, answers)

    @abstractmethod
    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        """Analyse answers that have no function of a level."""

    def conclude(self, result: Result, who: str) -> Iterator[str]:
        """Yield what was found about each condition, or pair of them. who: the participants."""
        for row in result.of_all(result.main):
            if self.function is not None and result.main == self.function.main:
                yield from self.function.describe(result, row)
            else:
                yield self.describe(row, who)
            if rare := odds(row):
                yield rare

    @abstractmethod
    def describe(self, row: Row, who: str) -> str:
        """Return what was found without a function, of a row of the main measure."""


class More(Question):
    """Which of two intervals has more; the name is the comparative of what they have."""

    procedures: ClassVar[tuple[str, ...]] = ("2afc", "constant", "quest")
    function: ClassVar[Function | None] = CHOICE
    has_threshold = True
    nouns: ClassVar[Mapping[str, str]] = {EQUALITY: "the level that feels equal"}

    def right_answer(self, trial: Trial) -> str:
        if trial.level is None or trial.standard is None or trial.position is None or trial.level == trial.standard:
            return ""
        return str(trial.position if trial.level > trial.standard else 3 - trial.position)

    def score(self, trial: Trial, response: str) -> Score:
        choice = None if trial.position is None else int(response == str(trial.position))
        return super().score(trial, response)._replace(chosen=choice)

    def decide(self, trial: Trial, percept: Percept, generator: np.random.Generator) -> str:
        return str(int(np.argmax(percept.strengths)) + 1)

    def analyse_conditions(self, comparison: Comparison, answers: ByParticipant) -> Result:
        return analyse_pairs(comparison, answers)

    def conclude(self, result: Result, who: str) -> Iterator[str]:
        if result.main != SCALE:
            yield from super().conclude(result, who)
            return
        values = sorted(result.of_all(SCALE), key=lambda row: -row.estimate.value)
        yield f"From most to least {self.name.removesuffix('er')}: {', '.join(row.what.condition for row in values)}."
        open_pairs = [row.what for row in result.of_all(DIFFERENCE) if not is_sure(row)]
        if open_pairs:
            pairs = "; ".join(f"{open_pair.condition} and {open_pair.other}" for open_pair in open_pairs)
            yield f"Which of these is more is open: {pairs}."
        else:
            yield "Each of them differs from each other one: 0 is outside the 95 % interval of every difference."

    def describe(self, row: Row, who: str) -> str:
        one, other = row.what.condition, row.what.other
        more, less = (one, other) if row.estimate.value >= 0.5 else (other, one)
        claim, chose = f"{more} is {self.name} than {less}", f"{who} chose {one} in {share(row)}"
        if is_sure(row):
            return f"{claim}: {chose}; no difference gives 50 %."
        return f"It is open whether {claim}: {chose}, and no difference gives 50 %."
