"""The verdicts on the legibility of parts for fingers."""

from collections.abc import Iterable
from typing import Any, Self

from .preflight import reasons, reconcile_cures, worst
from .verdict import Grade, Verdict
from .wording import as_data


class Legibility(tuple[Verdict, ...]):
    """The verdicts in the order of the rules, one sentence on all of them, and cures that agree with each other."""

    __slots__ = ()

    @classmethod
    def of(cls, verdicts: Iterable[Verdict]) -> Self:
        """Collect independent verdicts; cures that change the same key get the same value."""
        return cls(reconcile_cures(verdicts))

    @property
    def grade(self) -> Grade:
        """The worst grade: `illegible`, `warn` or `ok`."""
        return worst(self)

    @property
    def readable(self) -> bool:
        """True if nothing is illegible."""
        return self.grade != "illegible"

    @property
    def sentence(self) -> str:
        """A sentence on the result: legible, legible but ..., or illegible because ....

        >>> Legibility().sentence
        'Legible: fingers can read it.'
        """
        if self.grade == "ok":
            return "Legible: fingers can read it."
        return f"{'Legible, but' if self.readable else 'Illegible, because'} {reasons(self)}."

    def as_data(self) -> dict[str, Any]:
        """Return the verdicts as JSON data, for programs: see `preflight.wording.as_data`."""
        summary = {"grade": self.grade, "readable": self.readable, "sentence": self.sentence}
        return {**summary, "verdicts": [as_data(each) for each in self]}

    def __repr__(self) -> str:
        wrong = [each for each in self if each.verdict != "ok"]
        lines = (f"{each.verdict:<9} {each.check} of {each.of}: {each.cure}" for each in wrong)
        return "\n".join([self.sentence, *lines])
