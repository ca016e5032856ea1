"""Participants who are models, by the procedures for people, and power: how many are needed to find a difference."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isfinite, nan
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats

from ..analysis.analysing import CountedAnswers, analyse_comparison
from ..design import Comparison
from ..measures.rows import ALL, Result
from ..questions import load_question
from ..session import folder
from ..session.order import StudyCourse, make_answer
from ..study_file import StudyFile
from ..trials import Answer, AnswerFile
from .observers import Observer

# Median of the simulated response times, seconds; they say nothing about people.
MEDIAN_S = 1.2


def simulate(file: StudyFile, observer: Observer, number: int, seed: int) -> list[Answer]:
    """Return the answers of one participant to the whole study. number: of the participant, from 0."""
    generator = np.random.default_rng([seed, number, 1])
    individual = observer.participant(generator)
    course, answers = StudyCourse(file, number), list[Answer]()
    while (trial := course.next()) is not None:
        response = individual.answer(trial, file.study.comparison(trial.comparison), generator)
        seconds = MEDIAN_S * float(np.exp(0.4 * generator.standard_normal()))
        answers.append(make_answer(trial, len(answers) + 1, response, seconds))
        course.take(trial, response)
    return answers


def participant_names(participants: int) -> list[str]:
    """Return the names of simulated participants."""
    return [f"S{number + 1:02d}" for number in range(participants)]


def count_answers(file: StudyFile, answers: Sequence[Sequence[Answer]]) -> CountedAnswers:
    """Return answers as the analysis reads them from a folder, without writing them."""
    tests = {
        name: [answer for answer in some if answer.phase == "test"]
        for name, some in zip(participant_names(len(answers)), answers, strict=True)
    }
    training = sum(answer.phase == "training" for some in answers for answer in some)
    return CountedAnswers(file.study, tests, training, 0)


def write_folder(root: Path, file: StudyFile, observer: Observer, participants: int, seed: int) -> int:
    """Simulate participants into a folder like that of `study run`; return the number of answers."""
    folder.prepare(root, file)
    count = 0
    for name in participant_names(participants):
        number = folder.enrol(root, name, file.study, resume=False)
        place = folder.Place(root, name, file.study.study)
        options = observer.model_dump(mode="json")
        folder.write_sidecar(place, file, {"Observer": {"Model": type(observer).__name__, "Seed": seed, **options}})
        answers = simulate(file, observer, number, seed)
        with AnswerFile(place.answers) as table:
            for answer in answers:
                table.add(answer)
        folder.finish(root, name)
        count += len(answers)
    return count


ALPHA = 0.05  # probability of finding a difference where there is none
MOST = 200  # largest number of participants that is looked for
TRIED = 100  # simulated participants from whom power is estimated
TRIED_CURVES = 24  # simulated participants where a function is fitted to each, which takes 0.3 s of a processor
# Numbers of repetitions that are tried, as multiples of those in the study file.
FACTORS = (0.5, 1.0, 2.0, 4.0)


class Need(NamedTuple):
    """The participants that a comparison needs with some number of repetitions."""

    comparison: str
    repetitions: int
    trials: int  # trials of each participant, without training
    effect: float  # mean difference over participants, of the pair of conditions that is hardest to tell apart
    spread: float  # standard deviation of this difference over participants
    participants: int | None  # participants needed; None if more than 200 are, or there is nothing to find


def plan(
    file: StudyFile,
    observer: Observer,
    power: float = 0.8,
    seed: int = 0,
    progress: Callable[[str, int], None] = lambda _, __: None,
) -> list[Need]:
    """Return how many participants each comparison needs at each number of repetitions, to find what is there.

    power: share of such studies that are to find the difference. progress: called with a comparison and repetitions.
    """
    needs: list[Need] = []
    for comparison in file.study.comparisons:
        for repetitions in dict.fromkeys(max(1, round(factor * comparison.repetitions)) for factor in FACTORS):
            progress(comparison.name, repetitions)
            needs.append(_need(file, comparison, repetitions, observer, power, seed))
    return needs


def shorten_study(file: StudyFile, comparison: Comparison, repetitions: int) -> StudyFile:
    """Return a study of one comparison alone, without training."""
    shorter = comparison.model_copy(update={"repetitions": repetitions, "training": 0})
    return replace(file, study=file.study.model_copy(update={"comparisons": (shorter,)}))


def participant_effects(result: Result) -> dict[tuple[str, str], list[float]]:
    """Return the difference that each participant shows, or its distance from chance, for each pair of conditions."""
    rows = [row for row in result.rows if row.participant != ALL]
    main = [row for row in rows if row.what.measure in (result.main, PAIRS.get(result.main, ""))]
    conditions = list(dict.fromkeys(row.what.condition for row in main))
    if any(row.what.other for row in main) or len(conditions) == 1:
        differences: dict[tuple[str, str], list[float]] = {}
        for row in main:
            if isfinite(row.chance):
                differences.setdefault(row.what[1:], []).append(row.estimate.value - row.chance)
        return differences
    values = {(row.participant, row.what.condition): row.estimate.value for row in main}
    return {
        (later, earlier): [
            values[name, later] - values[name, earlier]
            for name in result.participants
            if (name, later) in values and (name, earlier) in values
        ]
        for number, later in enumerate(conditions)
        for earlier in conditions[:number]
    }


PAIRS = {"scale value": "proportion chosen"}  # measures that are not of one participant, and those that are


def participants_needed(effects: Sequence[float], power: float) -> int | None:
    """Return the fewest participants with whom Student's t, two-sided at 5 %, finds a mean like theirs.

    None if more than 200 are needed, or the effects themselves are not clearly different from 0.

    >>> participants_needed([-1.0, 3.0] * 500, 0.8)  # half a standard deviation: 34 by the tables of Cohen (1988)
    34
    """
    mean, spread = float(np.mean(effects)), float(np.std(effects, ddof=1))
    if not abs(mean) > 2 * spread / len(effects) ** 0.5:
        return None
    for count in range(2, MOST + 1):
        if power_by_t_test(mean, spread, count) >= power:
            return count
    return None


def power_by_t_test(mean: float, spread: float, participants: int) -> float:
    """Return the share of studies with this many participants in which Student's t, two-sided at 5 %, finds a mean."""
    if spread == 0:
        return float(mean != 0)
    shift = abs(mean) / spread * participants**0.5
    limit = stats.t.ppf(1 - ALPHA / 2, participants - 1)
    return float(stats.nct.sf(limit, participants - 1, shift) + stats.nct.cdf(-limit, participants - 1, shift))


def _need(
    file: StudyFile, comparison: Comparison, repetitions: int, observer: Observer, power: float, seed: int
) -> Need:
    one = shorten_study(file, comparison, repetitions)
    curves = bool(comparison.levels) and load_question(comparison.question).function is not None
    answers = [simulate(one, observer, number, seed) for number in range(TRIED_CURVES if curves else TRIED)]
    [shorter], trials = one.study.comparisons, len(answers[0])
    effects = participant_effects(analyse_comparison(shorter, count_answers(one, answers).of(shorter)))
    if not all(isfinite(effect) for some in effects.values() for effect in some):
        return Need(comparison.name, repetitions, trials, nan, nan, None)
    worst = min(
        effects.values(),
        key=lambda effects_of_pair: abs(float(np.mean(effects_of_pair))) / (float(np.std(effects_of_pair)) or 1e-9),
        default=[],
    )
    if len(worst) < 2:
        return Need(comparison.name, repetitions, trials, nan, nan, None)
    mean, spread = float(np.mean(worst)), float(np.std(worst, ddof=1))
    return Need(comparison.name, repetitions, trials, mean, spread, participants_needed(worst, power))
