"""Choices between two conditions: how often each was chosen, d', and the scale of Bradley & Terry."""

import numpy as np
from jaxtyping import Float64

from ..design import Comparison
from ..statistics.bradley_terry import fit_scale
from ..statistics.sensitivity import two_afc
from ..trials import Answer
from .rows import ALL, ByParticipant, Result, Row, What, of_each_and_all, proportion_row, together
from .shares import CHOSEN, share_rows, with_dprime

SCALE = "scale value"
DIFFERENCE = f"difference of {SCALE}"


def analyse_pairs(comparison: Comparison, answers: ByParticipant) -> Result:
    """Analyse how often each condition was chosen over each other one; three or more are placed on a scale."""

    def rows_of(name: str, some: list[Answer]) -> list[Row]:
        return share_rows(CHOSEN, name, some, lambda each: each.chosen, 0.5)

    rows, _ = of_each_and_all(rows_of, answers)
    dprimes = [with_dprime(row, two_afc) for row in rows]
    notes = note_on_order(together(answers))
    names = [each for each in comparison.conditions if any(each in (row.what[1:]) for row in rows)]
    if len(names) < 3:
        return Result(comparison.name, comparison.question, list(answers), [*rows, *dprimes], CHOSEN, notes=notes)
    scale = fit_scale([wins_of(list(some), names) for some in answers.values()])
    whom, trials = ALL if len(answers) > 1 else next(iter(answers)), sum(map(len, answers.values()))
    values = [Row(What(SCALE, each), whom, scale.estimate(index), "", trials) for index, each in enumerate(names)]
    between = [
        Row(What(DIFFERENCE, one, other), whom, scale.difference(first, second), "", trials, None, 0.0)
        for second, other in enumerate(names)
        for first, one in enumerate(names)
        if first > second
    ]
    if scale.was_completed:
        notes = [*notes, "One condition was always chosen over others, so that half a choice was added to each pair."]
    everything = [*rows, *dprimes, *values, *between]
    return Result(comparison.name, comparison.question, list(answers), everything, SCALE, notes=notes)


def wins_of(answers: list[Answer], names: list[str]) -> Float64[np.ndarray, "n n"]:
    """Return how often each condition (row) was chosen over each other one (column)."""
    wins = np.zeros((len(names), len(names)))
    for each in answers:
        if each.other is not None and each.chosen is not None:
            pair = names.index(each.condition), names.index(each.other)
            wins[pair if each.chosen else pair[::-1]] += 1
    return wins


def note_on_order(answers: list[Answer]) -> list[str]:
    """Return a note if the first of two intervals was chosen more or less often than the second."""
    first = proportion_row(What("first interval", ""), ALL, [int(each.response == "1") for each in answers], 0.5)
    if not answers or first.estimate.holds(0.5):
        return []
    share = first.estimate.value
    return [
        f"The first interval was chosen in {100 * share:.0f} % of the trials, whatever it was. Each condition comes "
        "first equally often, so that this adds noise and no bias."
    ]
