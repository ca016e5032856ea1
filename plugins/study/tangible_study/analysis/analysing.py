"""The analysis of a study's folder: each comparison by the question that it asks."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..design import Comparison
from ..measures.rows import ByParticipant, Result, as_record
from ..questions import load_question
from .results_folder import Kept, read_results
from .sentences import sentences


@dataclass(frozen=True)
class Analysis:
    """The results of a study."""

    kept: Kept
    results: list[Result]

    @property
    def sentences(self) -> dict[str, list[str]]:
        """What was found, by comparison."""
        return {each.comparison: sentences(each) for each in self.results}

    def document(self) -> dict[str, Any]:
        """Return the results as `--json` prints them."""
        return {
            "study": self.kept.study.study,
            "participants": list(self.kept.answers),
            "trials": self.kept.trials,
            "left_out": {"training": self.kept.training, "not_rendered": self.kept.not_rendered},
            "comparisons": [
                {
                    "name": each.comparison,
                    "question": each.question,
                    "found": sentences(each),
                    "rows": [as_record(row) for row in each.rows],
                }
                for each in self.results
            ],
        }


def analyse(folder: Path) -> Analysis:
    """Analyse the folder of a study. Raises: ResultsError, ConfigError; ConfigError without the extra `study`."""
    return analyse_kept(read_results(folder))


def analyse_kept(kept: Kept) -> Analysis:
    """Analyse answers; a comparison without any is left out."""
    return Analysis(kept, [analyse_comparison(each, kept.of(each)) for each in kept.study.comparisons if kept.of(each)])


def analyse_comparison(comparison: Comparison, answers: ByParticipant) -> Result:
    """Analyse the answers of one comparison."""
    return load_question(comparison.question).analyse(comparison, answers)
