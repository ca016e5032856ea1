"""Studies: intervals against observers whose truth is known, and power that is kept."""

from collections.abc import Iterator
from math import log
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from scipy import stats

from tangible_study.analysis.analysing import analyse_answers, analyse_comparison
from tangible_study.measures.rows import ALL, Result, What, is_sure
from tangible_study.simulation.observers import make_observer
from tangible_study.simulation.power import count_answers, plan, shorten_study, simulate
from tangible_study.statistics import sensitivity
from tangible_study.statistics.psychometric import JND
from tangible_study.study_file import StudyFile, parse_study

from .figures import Figure, judged, part

OBSERVERS = 500
STUDIES = 200
QUEST_TRIALS = 120
LEVELS = "vary: render.stiffness_n_per_m, levels: [140, 160, 180, 200, 220, 240, 260], standard: 200"
DISTANCES = "vary: render.stiffness_n_per_m, levels: [210, 220, 230, 245, 260, 280, 300], standard: 200"
HEAD = """\
study: s
pipeline: feel.yaml
conditions: {a: {}, b: {set: {render.use: penalty}}, c: {set: {render.use: proxy}}}
"""

Held = tuple[str, bool]


def section() -> str:
    """Return the section as Markdown."""
    with TemporaryDirectory() as folder:
        Path(folder, "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
        start = process_time()
        held = part("curves", lambda: list(_curves(Path(folder))))
        seconds = (process_time() - start) / (3 * OBSERVERS)
        held += part("counts", lambda: list(_counts(Path(folder))))
        held += part("groups", lambda: list(_groups(Path(folder))))
        power = part("power", lambda: _power(Path(folder)))
    figures = [_coverage(name, [hit for other, hit in held if other == name]) for name in dict.fromkeys(dict(held))]
    lines = [
        f"Intervals of 95 % against the truth of {OBSERVERS} simulated observers a row, who went through the",
        "procedures and the analysis of `tangible study`; the standard error of a share is 1 point. A function of one",
        f"condition, with its trials, took {seconds:.2f} s of a processor.",
        "",
        *judged(figures),
        "",
        "Exact intervals hold the truth at least as often as they say, by construction, and more often where trials",
        "are few; so does the mean over participants, whose interval holds both the exact one and Student's.",
        "",
        f"Power: {power[0]} participants were planned to find d' = 1.6 between two conditions in 80 % of the studies",
        f"(odd one of three, 12 trials each); of {STUDIES} simulated studies with as many, {100 * power[1]:.0f} %",
        f"found it. Without a difference, {100 * power[2]:.1f} % found one.",
    ]
    return "\n".join(lines)


def _coverage(name: str, hits: list[bool]) -> Figure:
    share = float(np.mean(hits))
    return Figure(name, "93 to 97 %", f"{100 * share:.1f} %", 0.93 <= share <= 0.97)


def _study(folder: Path, comparison: str) -> StudyFile:
    return parse_study(f"{HEAD}comparisons:\n- {{{comparison}}}\n", folder / "study.yaml")


def _one(file: StudyFile, model: str, number: int, **options: float) -> Result:
    observer = make_observer(model, [f"{key}={value!r}" for key, value in options.items()], file)
    return analyse_answers(count_answers(file, [simulate(file, observer, number, 11)])).results[0]


def _holds(result: Result, what: What, truth: float) -> bool:
    return next(row for row in result.rows if row.what == what).estimate.holds(truth)


def _curves(folder: Path) -> Iterator[Held]:
    generator = np.random.default_rng(1)
    choices = _study(
        folder, f"name: x, question: higher, procedure: constant, conditions: [a], {LEVELS}, repetitions: 40"
    )
    quest = _study(
        folder, f"name: x, question: higher, procedure: quest, conditions: [a], {LEVELS}, repetitions: {QUEST_TRIALS}"
    )
    odd = _study(folder, f"name: x, question: same, conditions: [a], {DISTANCES}, repetitions: 40")
    for number in range(OBSERVERS):
        threshold, width, lapse = (float(each) for each in generator.uniform((185, 30, 0), (215, 120, 0.06)))
        for file, trials in ((choices, "7 levels of 40 trials"), (quest, f"QUEST+, {QUEST_TRIALS} trials")):
            found = _one(
                file, "psychometric", number, threshold=threshold, width=width, lapse=lapse, personal=0.0, spread=0.0
            )
            yield f"point of equality, {trials}", _holds(found, What("point of equality", "a"), threshold)
            noticed = What("just noticeable difference", "a")
            yield f"just noticeable difference, {trials}", _holds(found, noticed, JND * width)
        distance, slope = (float(each) for each in generator.uniform((25, 1.5), (60, 3.0)))
        found = _one(odd, "psychometric", number, threshold=distance, slope=slope, lapse=0.02, personal=0.0, spread=0.0)
        yield "threshold of the odd one, 7 levels of 40 trials", _holds(found, What("threshold", "a"), distance)


def _counts(folder: Path) -> Iterator[Held]:
    generator = np.random.default_rng(2)
    odd = _study(folder, "name: x, question: same, conditions: [a, b], repetitions: 60")
    pairs = _study(folder, "name: x, question: rougher, repetitions: 40")
    for number in range(OBSERVERS):
        dprime = float(generator.uniform(0.8, 3.0))
        found = _one(odd, "detection", number, difference=dprime, lapse=0.0, spread=0.0)
        share = sensitivity.oddity_correct(dprime)
        yield "share of odd ones found, 60 trials", _holds(found, What("proportion correct", "a", "b"), share)
        yield "d' of it", _holds(found, What("d'", "a", "b"), dprime)
        step = float(generator.uniform(0.0, 0.8))
        found = _one(pairs, "detection", number, difference=step, lapse=0.0, spread=0.0)
        above = float(stats.norm.cdf(step / 2**0.5))
        truth = log(above / (1 - above))
        yield (
            "distance on the scale of 3 conditions, 120 trials",
            _holds(found, What("difference of scale value", "b", "a"), truth),
        )


def _groups(folder: Path) -> Iterator[Held]:
    odd = _study(folder, "name: x, question: same, conditions: [a, b], repetitions: 30")
    rating = _study(folder, "name: x, question: rating, conditions: [a, b], repetitions: 8")
    draws = np.random.default_rng(3).normal(1.6, 0.3 * 1.6, 100_000)
    expected = np.interp(
        np.abs(draws), np.linspace(0, 6, 601), [*map(sensitivity.oddity_correct, np.linspace(0, 6, 601))]
    )
    truth = float(expected.mean())
    for number in range(OBSERVERS):
        for file, what, value in (
            (odd, What("proportion correct", "a", "b"), truth),
            (rating, What("difference of mean rating", "b", "a"), 0.6),
        ):
            observer = make_observer(
                "detection", ["difference=1.6" if file is odd else "difference=0.6", "lapse=0"], file
            )
            kept = count_answers(file, [simulate(file, observer, each, 100 + number) for each in range(8)])
            [result] = analyse_answers(kept).results
            row = next(row for row in result.rows if row.what == what and row.participant == ALL)
            yield f"{what.measure}, 8 participants who differ", row.estimate.holds(value)


def _power(folder: Path) -> tuple[int, float, float]:
    """Return the planned participants, and the shares of studies that found a difference that is, and is not, there."""
    file = _study(folder, "name: x, question: same, conditions: [a, b], repetitions: 12")
    need = next(
        each for each in plan(file, make_observer("detection", ["difference=1.6"], file)) if each.repetitions == 12
    )
    assert need.participants is not None
    one = shorten_study(file, file.study.comparisons[0], 12)
    found = [
        [_finds(one, need.participants, difference, study) for study in range(STUDIES)] for difference in (1.6, 0.0)
    ]
    return need.participants, float(np.mean(found[0])), float(np.mean(found[1]))


def _finds(file: StudyFile, participants: int, difference: float, study: int) -> bool:
    observer = make_observer("detection", [f"difference={difference}"], file)
    kept = count_answers(file, [simulate(file, observer, number, 5000 + study) for number in range(participants)])
    [odd] = file.study.comparisons
    [row] = analyse_comparison(odd, kept.of(odd)).of_all("proportion correct")
    return is_sure(row) and row.estimate.value > 1 / 3
