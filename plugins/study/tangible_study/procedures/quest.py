"""QUEST+, which places each trial where it tells most about the threshold."""

from functools import cached_property
from typing import Annotated, Any, final

import numpy as np
from pydantic import Field

from tangible_core.errors import ConfigError
from tangible_core.runtime import need

from ..design import Comparison, Stimulus, Trial
from ..measures.functions import Function
from ..questions import load_question
from .listed import odd_one, standard_among_levels
from .procedure import (
    Cell,
    Course,
    Procedure,
    asks,
    cell_stimuli,
    compared_cells,
    comparison_trial,
    score,
    without_levels,
)


@final
class Quest(Procedure):
    """QUEST+: the next level is where the answer is expected to tell most (Watson 2017, J. Vision 17(3):10).

    Two intervals and the question for more give the point of equality and the slope; three and the question for the odd
    one (`same`) a threshold of the difference. The trials of several conditions take turns.
    """

    lapses: Annotated[tuple[float, ...], Field(min_length=1, max_length=5)] = (0.02,)
    """Shares of the trials in which a participant answers without attention, each as likely."""

    def refusal(self, comparison: Comparison) -> str:
        itself = standard_among_levels(comparison) if _asks_for_odd_one(comparison) else ""
        return itself or asks(comparison, "quest") or without_levels(comparison) or _twice_as_far(comparison)

    def course(self, comparison: Comparison, generator: np.random.Generator) -> Course:
        return _Tracks(self, comparison, generator)

    def stimuli(self, comparison: Comparison) -> tuple[Stimulus, ...]:
        return cell_stimuli(compared_cells(comparison))


@final
class _Tracks(Course):
    """Tracks of several conditions, in rounds."""

    def __init__(self, options: Quest, comparison: Comparison, generator: np.random.Generator) -> None:
        self._comparison = comparison
        self._tracks = {name: _Track(options.lapses, comparison) for name in comparison.conditions}
        names, turns = comparison.conditions, comparison.repetitions
        starts = generator.integers(0, 6, len(names)).tolist()
        self._order = [
            (names[index], starts[index] + turn)
            for turn in range(turns)
            for index in generator.permutation(len(names)).tolist()
        ]
        self._at = 0
        self._trial: Trial | None = None

    def next(self) -> Trial | None:
        if self._trial is None and self._at < len(self._order):
            name, number = self._order[self._at]
            cell = Cell(Stimulus(name, self._tracks[name].level()), Stimulus(name, self._comparison.standard))
            if _asks_for_odd_one(self._comparison):
                self._trial = odd_one(self._comparison, "quest", cell, number)
            else:
                self._trial = comparison_trial(self._comparison, "quest", cell, 1 + number % 2)
        return self._trial

    def take(self, trial: Trial, response: str) -> None:
        assert trial.level is not None
        each = score(trial, response)
        self._tracks[trial.condition].update(trial.level, bool(each.correct if each.chosen is None else each.chosen))
        self._at, self._trial = self._at + 1, None


@final
class _Track:
    """The knowledge about one condition."""

    def __init__(self, lapses: tuple[float, ...], comparison: Comparison) -> None:
        self._lapses, self._comparison = lapses, comparison
        self._levels = _function(comparison).intensities(np.array(comparison.levels), comparison.standard)

    @cached_property
    def _quest(self) -> Any:
        function, domain = _function(self._comparison).grid(self._levels, self._lapses)
        return need("questplus", "questplus psignifit", ConfigError).QuestPlus(
            stim_domain={"intensity": self._levels},
            param_domain={**domain, "lapse_rate": list(self._lapses)},
            outcome_domain={"response": [1, 0]},
            func=function,
            stim_scale="linear",
        )

    def level(self) -> float:
        """Return the level of the next trial."""
        where = int(np.argmin(np.abs(self._levels - self._quest.next_stim["intensity"])))
        return self._comparison.levels[where]

    def update(self, level: float, yes: bool) -> None:
        intensity = self._levels[self._comparison.levels.index(level)]
        self._quest.update(stim={"intensity": intensity}, outcome={"response": int(yes)})


def _twice_as_far(comparison: Comparison) -> str:
    """Return a complaint if two levels are the same intensity, as 700 and 900 are from 800; "" if none are."""
    intensities = _function(comparison).intensities(np.array(comparison.levels), comparison.standard)
    if len(np.unique(intensities)) == len(intensities):
        return ""
    return "cannot tell levels apart that are equally far from the standard; leave out those on one side of it"


def _function(comparison: Comparison) -> Function:
    function = load_question(comparison.question).function
    assert function is not None, "refused before"
    return function


def _asks_for_odd_one(comparison: Comparison) -> bool:
    return load_question(comparison.question).intervals == 3
