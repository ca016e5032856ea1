"""The analysis of a study's folder: the answers that count, each comparison by its question, and plain sentences."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite, isinf
from pathlib import Path
from typing import Any

from tangible_core.errors import ResultsError

from ..design import Comparison, Study
from ..measures.rows import ByParticipant, Result, Row, as_record, interval, is_sure, odds, people
from ..measures.shares import CORRECT, SCALE
from ..questions import load_question
from ..study_file import read_design
from ..trials import Answer, read_answers


@dataclass(frozen=True)
class CountedAnswers:
    """The answers of a study that count, and how many others there are."""

    study: Study
    # Answers of test trials that the device rendered, by participant.
    by_participant: Mapping[str, list[Answer]]
    training: int
    not_rendered: int  # number of test trials in which the device did not render what was requested

    @property
    def trials(self) -> int:
        """Number of trials that count."""
        return sum(map(len, self.by_participant.values()))

    def of(self, comparison: Comparison) -> dict[str, list[Answer]]:
        """Return the answers of one comparison, by participant, in the order of its conditions and levels."""

        def place(answer: Answer) -> tuple[int, float]:
            is_listed = answer.condition in comparison.conditions
            index = comparison.conditions.index(answer.condition) if is_listed else len(comparison.conditions)
            return index, -1.0 if answer.level is None else answer.level

        by_participant = {
            name: sorted((answer for answer in answers if answer.comparison == comparison.name), key=place)
            for name, answers in self.by_participant.items()
        }
        return {name: answers for name, answers in by_participant.items() if answers}


def read_results(folder: Path) -> CountedAnswers:
    """Read the folder that `tangible study run` or `simulate` wrote. Raises: ResultsError, ConfigError."""
    if not (folder / "study.yaml").is_file():
        raise ResultsError(f"{folder}: is not the folder of a study; name one that `tangible study run` wrote")
    if stray := next(folder.glob("sub-*/beh/*_beh.csv"), None):
        raise ResultsError(f"{stray}: is a table under another name; rename it to {stray.stem}.tsv, or remove it")
    tables = {
        path.parts[-3].removeprefix("sub-"): read_answers(path) for path in sorted(folder.glob("sub-*/beh/*_beh.tsv"))
    }
    everything = [answer for answers in tables.values() for answer in answers]
    answers = {
        name: [answer for answer in table if answer.phase == "test" and answer.rendered]
        for name, table in tables.items()
    }
    results = CountedAnswers(
        read_design(folder / "study.yaml"),
        {name: own for name, own in answers.items() if own},
        sum(answer.phase == "training" for answer in everything),
        sum(answer.phase == "test" and not answer.rendered for answer in everything),
    )
    if not results.by_participant:
        raise ResultsError(
            f"{folder}: has no answer that counts yet; run a participant to the end of the training first"
        )
    return results


FEW = 6  # number of participants below which a result says little about other people
MANY = 3  # number of comparisons from which one may seem to differ by chance


def sentences(result: Result) -> list[str]:
    """Return what was found in one comparison, and how sure that is; notes come last."""
    who, question = people(len(result.participants)), load_question(result.question)
    texts = list(question.conclude(result, who))
    contrasts = [row for row in result.rows if row.what.measure == f"difference of {result.main}"]
    if result.main != SCALE:
        noun = question.nouns.get(result.main, f"the {result.main}")
        texts += [text for row in contrasts for text in _difference(result.main, noun, row)]
    against_chance = [] if result.main == CORRECT and contrasts else result.of_all(result.main)
    tests = len([row for row in against_chance if row.p == row.p]) + len(contrasts)
    if tests >= MANY:
        texts.append(
            f"{tests} differences were looked for: if there were none, about one in 20 would seem to be there."
        )
    if len(result.participants) < FEW:
        texts.append(f"The result is about {who}, and says little about other people.")
    return [*texts, *result.notes]


def counts(answers: CountedAnswers) -> str:
    """Return how many answers count, and which were left out."""
    return (
        f"{answers.trials} answers of {people(len(answers.by_participant))} count; "
        f"{answers.training} training trials and {answers.not_rendered} "
        "that the device did not render as requested are left out."
    )


def _difference(measure: str, what: str, row: Row) -> Iterator[str]:
    one, other = row.what.condition, row.what.other
    value, low, high = (100 * figure for figure in row.estimate) if measure == CORRECT else row.estimate
    unit = "percentage points" if measure == CORRECT else row.unit
    more = "greater" if value > 0 else "smaller"
    least, most = (low, high) if value > 0 else (-high, -low)
    amount, between = f"{abs(value):.3g} {unit}".rstrip(), interval(least, most)
    if not row.estimate.has_interval:
        yield f"With {one}, {what} is {amount} {more} than with {other}; one value each does not tell how sure that is."
    elif is_sure(row) and isinf(value):
        yield f"With {one}, {what} is {more} than with {other}, by {least:.3g} {unit} or more (95 %)."
    elif is_sure(row):
        yield f"With {one}, {what} is {amount} {more} than with {other} ({between})."
        if rare := odds(row):
            yield rare
    elif isfinite(value):
        yield (
            f"It is open whether {what} differs: with {one}, it is {amount} {more} than with {other} "
            f"({between}, which holds 0)."
        )
    else:
        yield f"It is open whether {what} differs between {one} and {other}: one of them has a bound, no estimate."


@dataclass(frozen=True)
class Analysis:
    """The results of a study."""

    answers: CountedAnswers
    results: list[Result]

    @property
    def sentences(self) -> dict[str, list[str]]:
        """Results by comparison."""
        return {result.comparison: sentences(result) for result in self.results}

    def document(self) -> dict[str, Any]:
        """Return the results as `--json` prints them."""
        return {
            "study": self.answers.study.study,
            "participants": list(self.answers.by_participant),
            "trials": self.answers.trials,
            "left_out": {"training": self.answers.training, "not_rendered": self.answers.not_rendered},
            "comparisons": [
                {
                    "name": result.comparison,
                    "question": result.question,
                    "found": sentences(result),
                    "rows": [as_record(row) for row in result.rows],
                }
                for result in self.results
            ],
        }


def analyse(folder: Path) -> Analysis:
    """Analyse the folder of a study. Raises: ResultsError, ConfigError; ConfigError without the extra `study`."""
    return analyse_answers(read_results(folder))


def analyse_answers(answers: CountedAnswers) -> Analysis:
    """Analyse answers; a comparison without any is left out."""
    return Analysis(
        answers,
        [
            analyse_comparison(comparison, answers.of(comparison))
            for comparison in answers.study.comparisons
            if answers.of(comparison)
        ],
    )


def analyse_comparison(comparison: Comparison, answers: ByParticipant) -> Result:
    """Analyse the answers of one comparison."""
    return load_question(comparison.question).analyse(comparison, answers)
