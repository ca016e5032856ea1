"""All verdicts of a preflight, with one sentence and cures that agree with each other."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, ClassVar, Self

from .verdict import Change, Grade, Verdict, as_data

MAX_REASONS = 3


class Verdicts(tuple[Verdict, ...]):
    """The verdicts in the order of the checks, one sentence on all of them, and cures that agree with each other."""

    __slots__ = ()
    good: ClassVar[str]
    """Name of the property that is True without a verdict of the worst grade, `bad`."""
    bad: ClassVar[Grade]

    @classmethod
    def of(cls, verdicts: Iterable[Verdict]) -> Self:
        """Collect independent verdicts; changes of one key get one value, one that would undo another is left out."""
        return cls(reconcile_cures(verdicts))

    @property
    def grade(self) -> Grade:
        """The worst grade."""
        return worst(self)

    @property
    def sentence(self) -> str:
        """A sentence on the result."""
        raise NotImplementedError

    def as_data(self) -> dict[str, Any]:
        """Return the verdicts as JSON data, for programs: see `wording.as_data`."""
        summary = {"grade": self.grade, self.good: self.grade != self.bad, "sentence": self.sentence}
        return {**summary, "verdicts": [as_data(verdict) for verdict in self]}

    def __repr__(self) -> str:
        wrong = [verdict for verdict in self if verdict.verdict != "ok"]
        lines = (f"{one.verdict:<{len(self.bad)}} {one.check} of {one.of}: {one.cure}" for one in wrong)
        return "\n".join([self.sentence, *lines])


class Preflight(Verdicts):
    """The verdicts on a surface before a session."""

    __slots__ = ()
    good = "safe"
    bad: ClassVar[Grade] = "unsafe"

    @property
    def safe(self) -> bool:
        """True if nothing is unsafe."""
        return self.grade != self.bad

    @property
    def sentence(self) -> str:
        """A sentence on the result: safe, safe but ..., or unsafe because ....

        >>> Preflight().sentence
        'Safe: nothing is wrong.'
        """
        if self.grade == "ok":
            return "Safe: nothing is wrong."
        return f"{'Safe, but' if self.safe else 'Unsafe, because'} {reasons(self)}."


GRADES: tuple[Grade, ...] = ("unsafe", "illegible", "warn", "ok")


def reconcile_cures(verdicts: Iterable[Verdict]) -> list[Verdict]:
    """Give all changes of a key the strictest value; leave out a change that would undo that of a worse verdict."""
    verdicts = list(verdicts)
    strictest: dict[str, Change] = {}
    for change in (change for verdict in sorted(verdicts, key=_rank) for change in verdict.changes):
        strictest[change.key] = strictest[change.key].stricter(change) if change.key in strictest else change
    return [_reconcile(verdict, strictest) for verdict in verdicts]


def worst(verdicts: Iterable[Verdict]) -> Grade:
    """Return the worst grade; `ok` without a verdict."""
    return GRADES[min(map(_rank, verdicts), default=-1)]


def reasons(verdicts: Iterable[Verdict]) -> str:
    """Join the texts of the worst verdicts, as the end of a sentence."""
    verdicts = list(verdicts)
    grade = worst(verdicts)
    texts = list(dict.fromkeys(verdict.says for verdict in verdicts if verdict.verdict == grade and verdict.says))
    more = len(texts) - MAX_REASONS
    phrases = texts[:MAX_REASONS] + ([f"{more} more thing{'s' * (more > 1)}"] if more > 0 else [])
    return " and ".join(filter(None, [", ".join(phrases[:-1]), phrases[-1]]))


def _rank(verdict: Verdict) -> int:
    return GRADES.index(verdict.verdict)


def _reconcile(verdict: Verdict, strictest: dict[str, Change]) -> Verdict:
    cure, changes = verdict.cure, list[Change]()
    for change in verdict.changes:
        best = strictest[change.key]
        if best.keeps(change):
            changes.append(best)
            cure = cure.replace(str(change), str(best))
        else:
            cure = cure.replace(
                str(change), f"(not by `{change.key}`, which another check wants {best.towards} {best.value})"
            )
    return replace(verdict, cure=cure, changes=tuple(changes))


class Legibility(Verdicts):
    """The verdicts on parts, in the order of the rules."""

    __slots__ = ()
    good = "readable"
    bad: ClassVar[Grade] = "illegible"

    @property
    def readable(self) -> bool:
        """True if nothing is illegible."""
        return self.grade != self.bad

    @property
    def sentence(self) -> str:
        """A sentence on the result: legible, legible but ..., or illegible because ....

        >>> Legibility().sentence
        'Legible: fingers can read it.'
        """
        if self.grade == "ok":
            return "Legible: fingers can read it."
        return f"{'Legible, but' if self.readable else 'Illegible, because'} {reasons(self)}."
