"""All verdicts of one preflight: one sentence, and cures that agree with each other."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Self

from .verdict import Change, Grade, Verdict
from .wording import as_data

SAID = 3
"""So many reasons are named in a sentence; how many more there are is counted."""


class Preflight(tuple[Verdict, ...]):
    """The verdicts in the order of the checks, one sentence on all of them, and cures that agree with each other."""

    __slots__ = ()

    @classmethod
    def of(cls, verdicts: Iterable[Verdict]) -> Self:
        """Of verdicts each of which knows nothing of the others: where several change one key, all say the same value.

        A change that would undo that of another verdict is left out.
        """
        return cls(agreed(verdicts))

    @property
    def grade(self) -> Grade:
        """The worst of them."""
        return worst(self)

    @property
    def safe(self) -> bool:
        """Whether nothing is unsafe."""
        return self.grade != "unsafe"

    @property
    def sentence(self) -> str:
        """Safe, safe but, or unsafe because: in plain words.

        >>> Preflight().sentence
        'Safe: nothing is wrong.'
        """
        if self.grade == "ok":
            return "Safe: nothing is wrong."
        return f"{'Safe, but' if self.safe else 'Unsafe, because'} {reasons(self)}."

    def as_data(self) -> dict[str, Any]:
        """All of it as JSON says it, for a program that shows it: see `wording.as_data`."""
        said = {"grade": self.grade, "safe": self.safe, "sentence": self.sentence}
        return {**said, "verdicts": [as_data(each) for each in self]}

    def __repr__(self) -> str:
        wrong = [each for each in self if each.verdict != "ok"]
        lines = (f"{each.verdict:<6} {each.check} of {each.of}: {each.cure}" for each in wrong)
        return "\n".join([self.sentence, *lines])


GRADES: tuple[Grade, ...] = ("unsafe", "illegible", "warn", "ok")


def agreed(verdicts: Iterable[Verdict]) -> list[Verdict]:
    """With one value for each key that several change; a change that would undo that of another is left out."""
    found = list(verdicts)
    wanted: dict[str, Change] = {}
    for change in (change for each in sorted(found, key=_rank) for change in each.changes):
        wanted[change.key] = wanted[change.key].stricter(change) if change.key in wanted else change
    return [_agreed(each, wanted) for each in found]


def worst(verdicts: Iterable[Verdict]) -> Grade:
    """The worst grade of them; `ok` of none."""
    return GRADES[min(map(_rank, verdicts), default=-1)]


def reasons(verdicts: Iterable[Verdict]) -> str:
    """What the worst of them say, as the end of a sentence."""
    found = list(verdicts)
    grade = worst(found)
    said = list(dict.fromkeys(each.says for each in found if each.verdict == grade and each.says))
    more = len(said) - SAID
    named = said[:SAID] + ([f"{more} more thing{'s' * (more > 1)}"] if more > 0 else [])
    return " and ".join(filter(None, [", ".join(named[:-1]), named[-1]]))


def _rank(verdict: Verdict) -> int:
    return GRADES.index(verdict.verdict)


def _agreed(verdict: Verdict, wanted: dict[str, Change]) -> Verdict:
    """With the values that all verdicts agree on."""
    cure, kept = verdict.cure, list[Change]()
    for change in verdict.changes:
        best = wanted[change.key]
        if best.keeps(change):
            kept.append(best)
            cure = cure.replace(str(change), str(best))
        else:
            cure = cure.replace(
                str(change), f"(not by `{change.key}`, which another check wants {best.towards} {best.value})"
            )
    return replace(verdict, cure=cure, changes=tuple(kept))
