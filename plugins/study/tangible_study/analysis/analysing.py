"""The analysis of a study's folder: each comparison by the question that it asks."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..design.study import Comparison
from ..measures.curves import analyse_levels
from ..measures.pairs import analyse_pairs
from ..measures.quantities import analyse_adjustments, analyse_ratings
from ..measures.right_answers import analyse_choices, analyse_differences
from ..measures.rows import ByParticipant, Result, as_record
from .results_folder import Kept, read_results
from .sentences import sentences

ANALYSES: Mapping[tuple[str, bool], Callable[[Comparison, ByParticipant], Result]] = {
    ("rougher", False): analyse_pairs,
    ("rougher", True): analyse_levels,
    ("higher", False): analyse_pairs,
    ("higher", True): analyse_levels,
    ("same", False): analyse_choices,
    ("same", True): analyse_levels,
    ("different", False): analyse_differences,
    ("equal", True): analyse_adjustments,
    ("name", False): analyse_choices,
    ("name", True): analyse_choices,
    ("rating", False): analyse_ratings,
    ("rating", True): analyse_ratings,
}
"""Analyses by the question, and whether a level varies; the procedure does not matter, so that those of other packages
are analysed as well."""


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
    varies = any(each.level is not None for some in answers.values() for each in some)
    return ANALYSES[comparison.question, varies](comparison, answers)
