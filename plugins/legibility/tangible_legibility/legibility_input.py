"""The input of the checks: parts on a grid in metres, with their relief, materials and names."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Int64

from tangible_core.data import Material, MaterialMap, PartMap, Relief
from tangible_core.preflight import Cure, Verdict, check_bound

from .neighbours import Steps, sample_relief, steps_between
from .rules import Profile
from .simplifying.large import count_textures
from .widths import Widths, measure
from .words.places import describe_part, describe_place

MAX_EACH = 4  # failing verdicts of one check; further ones are gathered into one
MAX_PLACES = 64  # places in such a gathered verdict


@dataclass(frozen=True, eq=False)
class LegibilityInput:
    """A map of parts in one medium."""

    profile: Profile
    parts: PartMap  # on a grid in metres
    pitch_m: float
    width_m: float
    relief: Relief | None
    material_map: MaterialMap | None
    names: Sequence[str]
    texture_count: int | None  # None for one a segment

    @cached_property
    def widths(self) -> Widths:
        """Widths of the parts, by the gap of the medium."""
        return measure(self.parts.labels, self.pitch_m, self.profile.rules["gap"].bound)

    @cached_property
    def steps(self) -> Steps:
        """Steps between neighbours."""
        relief = None if self.relief is None else sample_relief(self.relief, self.parts.labels.shape)
        return steps_between(self.parts, self.pitch_m, relief)

    @property
    def textures(self) -> int:
        """Number of textures that a finger must tell apart."""
        return count_textures(self.parts, self.names) if self.texture_count is None else self.texture_count

    def material(self, number: int) -> Material | None:
        """Return the material of a part, or of its segment."""
        materials = () if self.material_map is None else self.material_map.materials
        at = number if len(materials) == self.parts.count else self.parts.segments[number]
        return materials[at] if at < len(materials) else None

    def describe_part(self, number: int) -> str:
        """Return a part's number and name."""
        return describe_part(number, self.names)

    def has_name(self, number: int) -> bool:
        """Test whether a part has a name."""
        return number < len(self.names) and bool(self.names[number])

    def share_of_picture(self, row: int, column: int) -> tuple[float, float]:
        """Return the place of a cell as shares of the picture, from the left and from the top."""
        rows, columns = self.parts.labels.shape
        return round((column + 0.5) / columns, 4), round((row + 0.5) / rows, 4)

    def judge(
        self,
        check: str,
        measurements: "Sequence[Measurement]",
        cure: Callable[[float], Cure],
        *,
        none: float,
        worse: str = "",
        others: str = "",
        of: str,
    ) -> list[Verdict]:
        """Return one verdict if all meet the rule; else one for each of the worst, and one for all others."""
        rule = self.profile.rules[check]
        wrong = [each for each in measurements if not _meets(each.value, rule.relation, rule.bound)]
        wrong.sort(key=lambda each: each.value, reverse=rule.relation == "<=")
        worst = max if rule.relation == "<=" else min
        single = wrong if len(wrong) <= MAX_EACH + 1 else wrong[:MAX_EACH]
        findings: list[tuple[str, float, str, tuple[tuple[float, float], ...]]] = [
            (
                ", ".join(filter(None, [each.of, each.place])),
                each.value,
                " ".join(filter(None, [each.of, worse, each.place])),
                (each.at,) if each.at else (),
            )
            for each in single
        ]
        if rest := wrong[len(single) :]:
            places = tuple(dict.fromkeys(each.at for each in rest if each.at))[:MAX_PLACES]
            findings.append((f"{len(rest)} more {of}", rest[0].value, f"{len(rest)} {others}", places))
        if not findings:
            findings = [(of, float(worst((each.value for each in measurements), default=none)), "", ())]
        bound = rule.relation, rule.bound, rule.unit, rule.citation
        return [
            replace(check_bound(check, name, value, *bound, cure=cure(value), says=says, worse=rule.worse), at=at)
            for name, value, says, at in findings
        ]


@dataclass(frozen=True)
class Measurement:
    """A value of one thing, and its place."""

    of: str
    value: float
    at: tuple[float, float] | None = None  # shares of the picture, from the left and from the top

    @property
    def place(self) -> str:
        """The place in words."""
        return describe_place(*self.at) if self.at else ""


def _meets(value: float, relation: str, bound: float) -> bool:
    near = abs(value - bound) <= 1e-6 * bound
    return near or (value <= bound if relation == "<=" else value >= bound)


def deepest_cells(wide: Widths, pieces: Int64[np.ndarray, "k"]) -> dict[int, tuple[int, int]]:
    """Return row and column of the cell that is farthest from the border, of each of these pieces."""
    selection = np.zeros(wide.part.size, np.bool_)
    selection[pieces] = True
    on = np.flatnonzero(selection[wide.pieces.reshape(-1)])
    order = np.argsort(wide.depth[1::2, 1::2].reshape(-1)[on], kind="stable")
    cell = np.zeros(wide.part.size, np.int64)
    cell[wide.pieces.reshape(-1)[on[order]]] = on[order]
    columns = wide.pieces.shape[1]
    return {piece: divmod(int(cell[piece]), columns) for piece in pieces.tolist()}
