"""What the checks look at: parts on a grid in metres, with what is known of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Int64

from ..data import Material, MaterialMap, PartMap, Relief
from ..preflight.verdict import Cure, Verdict, held
from .neighbours import Steps, sampled, steps_between
from .rules import Profile
from .simplifying.simplify import textures_of
from .widths import Widths, measure
from .words import called, where

MOST_EACH = 4
"""Verdicts of one kind that fail; the others are gathered into one."""
MOST_PLACES = 64


@dataclass(frozen=True, eq=False)
class Looked:
    """One map of parts in one medium."""

    profile: Profile
    parts: PartMap
    """On a grid in metres."""
    pitch_m: float
    width_m: float
    relief: Relief | None
    given_materials: MaterialMap | None
    names: Sequence[str]
    given_textures: int | None

    @cached_property
    def widths(self) -> Widths:
        """By the gap of the medium."""
        return measure(self.parts.labels, self.pitch_m, self.profile.rules["gap"].bound)

    @cached_property
    def steps(self) -> Steps:
        """Between neighbours."""
        here = None if self.relief is None else sampled(self.relief, self.parts.labels.shape)
        return steps_between(self.parts, self.pitch_m, here)

    @property
    def textures(self) -> int:
        """How many are to be told apart."""
        return textures_of(self.parts, self.names) if self.given_textures is None else self.given_textures

    def material(self, number: int) -> Material | None:
        """Of a part, or of its segment."""
        known = () if self.given_materials is None else self.given_materials.materials
        at = number if len(known) == self.parts.count else self.parts.segments[number]
        return known[at] if at < len(known) else None

    def called(self, number: int) -> str:
        """A part with its name."""
        return called(number, self.names)

    def has_name(self, number: int) -> bool:
        """Whether somebody named this part."""
        return number < len(self.names) and bool(self.names[number])

    def at(self, row: int, column: int) -> tuple[float, float]:
        """A cell as shares of the picture: from the left, and from the top."""
        rows, columns = self.parts.labels.shape
        return round((column + 0.5) / columns, 4), round((row + 0.5) / rows, 4)

    def judged(
        self,
        check: str,
        found: "Sequence[Found]",
        cure: Callable[[float], Cure],
        *,
        none: float,
        worse: str = "",
        of: str,
    ) -> list[Verdict]:
        """One verdict where all keep the rule; else one for each of the worst that do not, and one for all others.

        none: the value where there is nothing to look at. of: what all of them are. cure: by the value. worse: what is
        wrong, after the name of a part.
        """
        rule = self.profile.rules[check]
        wrong = [each for each in found if not _keeps(each.value, rule.relation, rule.bound)]
        wrong.sort(key=lambda each: each.value, reverse=rule.relation == "<=")
        least = max if rule.relation == "<=" else min
        if not wrong:
            value = least((each.value for each in found), default=none)
            return [self._held(check, of, value, cure, "", ())]
        single = wrong if len(wrong) <= MOST_EACH + 1 else wrong[:MOST_EACH]
        verdicts = [
            self._held(
                *(check, ", ".join(filter(None, [each.of, each.place])), each.value, cure),
                " ".join(filter(None, [each.of, worse, each.place])),
                (each.at,) if each.at else (),
            )
            for each in single
        ]
        if rest := wrong[len(single) :]:
            places = tuple(dict.fromkeys(each.at for each in rest if each.at))[:MOST_PLACES]
            said = f"{len(rest)} more {of}"
            verdicts.append(
                self._held(check, said, rest[0].value, cure, f"{said} {worse.replace('is', 'are', 1)}", places)
            )
        return verdicts

    def _held(
        self,
        check: str,
        of: str,
        value: float,
        cure: Callable[[float], Cure],
        says: str,
        at: tuple[tuple[float, float], ...],
    ) -> Verdict:
        rule = self.profile.rules[check]
        found = held(
            *(check, of, float(value), rule.relation, rule.bound, rule.unit, rule.cited),
            cure=cure(float(value)),
            says=says,
            worse=rule.worse,
        )
        return replace(found, at=at)


@dataclass(frozen=True)
class Found:
    """A value of one thing, and where that is."""

    of: str
    value: float
    at: tuple[float, float] | None = None
    """Shares of the picture, from the left and from the top; None for all of it."""

    @property
    def place(self) -> str:
        """Where it is, in words."""
        return where(*self.at) if self.at else ""


def _keeps(value: float, relation: str, bound: float) -> bool:
    near = abs(value - bound) <= 1e-6 * bound
    return near or (value <= bound if relation == "<=" else value >= bound)


def deepest(wide: Widths, pieces: Int64[np.ndarray, "k"]) -> dict[int, tuple[int, int]]:
    """Of each of these pieces, row and column of a cell that is as far from its border as any of it."""
    chosen = np.zeros(wide.part.size, np.bool_)
    chosen[pieces] = True
    on = np.flatnonzero(chosen[wide.pieces.reshape(-1)])
    order = np.argsort(wide.depth[1::2, 1::2].reshape(-1)[on], kind="stable")
    cell = np.zeros(wide.part.size, np.int64)
    cell[wide.pieces.reshape(-1)[on[order]]] = on[order]
    columns = wide.pieces.shape[1]
    return {each: divmod(int(cell[each]), columns) for each in pieces.tolist()}
