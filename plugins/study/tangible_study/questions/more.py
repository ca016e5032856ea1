"""Questions for the interval with more of something."""

from collections.abc import Iterator, Mapping
from typing import ClassVar

import numpy as np

from ..design import Comparison, Trial
from ..measures.functions import CHOICE, EQUALITY, Function
from ..measures.rows import ByParticipant, Result, Row, is_sure, share
from ..measures.shares import DIFFERENCE, SCALE, analyse_pairs
from .question import Percept, Question, Score


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
