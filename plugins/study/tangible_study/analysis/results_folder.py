"""The folder of a study as the analysis reads it: the design, and the answers that count."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tangible_core.errors import ResultsError

from ..design import Comparison, Study
from ..study_file import read_design
from ..trials import Answer, read_answers


@dataclass(frozen=True)
class Kept:
    """The answers of a study that count, and how many others there are."""

    study: Study
    answers: Mapping[str, list[Answer]]
    """Answers of test trials that the device rendered, by participant."""
    training: int
    """Number of training trials."""
    not_rendered: int
    """Number of test trials in which the device did not render what was requested."""

    @property
    def trials(self) -> int:
        """Number of trials that count."""
        return sum(map(len, self.answers.values()))

    def of(self, comparison: Comparison) -> dict[str, list[Answer]]:
        """Return the answers of one comparison, by participant, in the order of its conditions and levels."""

        def place(answer: Answer) -> tuple[int, float]:
            known = answer.condition in comparison.conditions
            index = comparison.conditions.index(answer.condition) if known else len(comparison.conditions)
            return index, -1.0 if answer.level is None else answer.level

        found = {
            name: sorted((each for each in answers if each.comparison == comparison.name), key=place)
            for name, answers in self.answers.items()
        }
        return {name: answers for name, answers in found.items() if answers}


def read_results(folder: Path) -> Kept:
    """Read the folder that `tangible study run` or `simulate` wrote. Raises: ResultsError, ConfigError."""
    if not (folder / "study.yaml").is_file():
        raise ResultsError(f"{folder}: is not the folder of a study; name one that `tangible study run` wrote")
    if renamed := next(folder.glob("sub-*/beh/*_beh.csv"), None):
        raise ResultsError(f"{renamed}: is a table under another name; rename it to {renamed.stem}.tsv, or remove it")
    tables = {
        path.parts[-3].removeprefix("sub-"): read_answers(path) for path in sorted(folder.glob("sub-*/beh/*_beh.tsv"))
    }
    everything = [each for answers in tables.values() for each in answers]
    answers = {
        name: [each for each in found if each.phase == "test" and each.rendered] for name, found in tables.items()
    }
    kept = Kept(
        read_design(folder / "study.yaml"),
        {name: found for name, found in answers.items() if found},
        sum(each.phase == "training" for each in everything),
        sum(each.phase == "test" and not each.rendered for each in everything),
    )
    if not kept.answers:
        raise ResultsError(
            f"{folder}: has no answer that counts yet; run a participant to the end of the training first"
        )
    return kept
