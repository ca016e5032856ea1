"""Verdicts on parts: whether fingers can read them, by the rules of one medium."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Self

from ..data import MaterialMap, PartMap, Relief
from ..errors import GeometryError
from ..plugins.interfaces import Medium
from ..preflight.preflight import agreed, reasons, worst
from ..preflight.verdict import Grade, Verdict, held
from ..preflight.wording import as_data
from .checks import CHECKS, height
from .grid import on_grid
from .legibility_input import Looked
from .rules import PROFILES, Rule
from .words import mm


class Legibility(tuple[Verdict, ...]):
    """The verdicts in the order of the rules, one sentence on all of them, and cures that agree with each other."""

    __slots__ = ()

    @classmethod
    def of(cls, verdicts: Iterable[Verdict]) -> Self:
        """Of verdicts each of which knows nothing of the others: where several change one key, all say the same."""
        return cls(agreed(verdicts))

    @property
    def grade(self) -> Grade:
        """The worst of them: `illegible`, `warn` or `ok`."""
        return worst(self)

    @property
    def readable(self) -> bool:
        """Whether nothing is illegible."""
        return self.grade != "illegible"

    @property
    def sentence(self) -> str:
        """Legible, legible but, or illegible because: in plain words.

        >>> Legibility().sentence
        'Legible: fingers can read it.'
        """
        if self.grade == "ok":
            return "Legible: fingers can read it."
        return f"{'Legible, but' if self.readable else 'Illegible, because'} {reasons(self)}."

    def as_data(self) -> dict[str, Any]:
        """All of it as JSON says it, for a program that shows it: see `preflight.wording.as_data`."""
        said = {"grade": self.grade, "readable": self.readable, "sentence": self.sentence}
        return {**said, "verdicts": [as_data(each) for each in self]}

    def __repr__(self) -> str:
        wrong = [each for each in self if each.verdict != "ok"]
        lines = (f"{each.verdict:<9} {each.check} of {each.of}: {each.cure}" for each in wrong)
        return "\n".join([self.sentence, *lines])


def legibility(
    medium: Medium,
    parts: PartMap | None,
    width_m: float,
    *,
    relief: Relief | None = None,
    materials: MaterialMap | None = None,
    names: Sequence[str] = (),
    textures: int | None = None,
) -> Legibility:
    """Whether fingers can read these parts in this medium, the whole being width_m wide; a verdict a rule.

    What fails is named part by part, the worst ones first, and all others together. A rule of what is not known here is
    left out, such as steps without a relief.
    parts: None where the picture is not divided. relief, materials: of the whole, on any grid; materials one a part or
    a segment. names: of parts, by number. textures: how many are to be told apart, where that is not one a segment.
    Raises: GeometryError if width_m is not positive.
    """
    profile = PROFILES[medium]
    if parts is None:
        if not width_m > 0:
            raise GeometryError(f"width_m must be a positive length in metres, not {width_m}")
        return Legibility.of(_undivided(medium, relief, width_m))
    grid = on_grid(parts, width_m)
    looked = Looked(profile, grid.parts, grid.pitch_m, width_m, relief, materials, names, textures)
    return Legibility.of(verdict for check in CHECKS[medium] for verdict in check(looked))


def _undivided(medium: Medium, relief: Relief | None, width_m: float) -> Iterator[Verdict]:
    """Of a scene that has no parts: a relief may be felt all the same."""
    rule, cure = PROFILES[medium].rules["parts"], "add `parts: {}` to the file, and a method for `texture:`"
    says = "the picture is not divided into parts"
    worse: Grade = "warn" if medium in ("print", "force") else rule.worse
    yield held(
        *("parts", "the picture", 0.0, rule.relation, rule.bound, rule.unit, rule.cited),
        cure=cure, says=says, worse=worse,
    )  # fmt: skip
    if relief is not None and "height" in PROFILES[medium].rules:
        import numpy as np

        one = PartMap(np.zeros(relief.height_m.shape, np.int32), (0,))
        pitch_m = relief.pitch_m[0]
        yield from height(Looked(PROFILES[medium], one, pitch_m, width_m, relief, None, (), None))


def sizes(medium: Medium, **sizes_m: float) -> Legibility:
    """Verdicts on what an exporter decides itself, by the names of rules: `line`, `base`, `braille_dot` and the like.

    >>> sizes("print", base=0.0005).sentence
    'Illegible, because the base is 0.5 mm, and at least 0.8 mm are needed.'
    """
    rules: Mapping[str, Rule] = {check.replace(" ", "_"): rule for check, rule in PROFILES[medium].rules.items()}
    return Legibility.of(_size(rules[name], value) for name, value in sizes_m.items())


def _size(rule: Rule, size_m: float) -> Verdict:
    most = "at most" if rule.relation == "<=" else "at least"
    return held(
        *(rule.check, rule.says, size_m, rule.relation, rule.bound, rule.unit, rule.cited),
        says=f"the {rule.check} is {mm(size_m)}, and {most} {mm(rule.bound)} are needed",
        cure=f"{most} {mm(rule.bound)}",
        worse=rule.worse,
    )
