"""Verdicts on parts: whether fingers can read them, by the rules of one medium."""

from collections.abc import Sequence
from typing import Any

from ..data import MaterialMap, PartMap, Relief
from ..plugins.interfaces import Medium
from ..preflight.verdict import Verdict, held
from ..preflight.wording import as_data
from .grid import on_grid
from .simplify import textures_of
from .widths import measure


class Legibility(tuple[Verdict, ...]):
    """The verdicts, in the order of the rules."""

    __slots__ = ()

    @property
    def grade(self) -> str:
        """The worst of them: `illegible`, `warn` or `ok`."""
        return next((each for each in ("illegible", "warn") if any(v.verdict == each for v in self)), "ok")

    @property
    def readable(self) -> bool:
        """Whether nothing is illegible."""
        return self.grade != "illegible"

    @property
    def sentence(self) -> str:
        """In plain words."""
        reasons = list(dict.fromkeys(each.says for each in self if each.verdict == self.grade and each.says))
        if self.grade == "ok":
            return "Fingers can read it."
        return f"{'Readable, but' if self.readable else 'Illegible, because'} {', '.join(reasons)}."

    def as_data(self) -> dict[str, Any]:
        """All of it as JSON says it."""
        said = {"grade": self.grade, "readable": self.readable, "sentence": self.sentence}
        return {**said, "verdicts": [as_data(each) for each in self]}


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
    """Whether fingers can read these parts in this medium."""
    if parts is None:
        return Legibility()
    grid = on_grid(parts, width_m)
    wide = measure(grid.parts.labels, grid.pitch_m, 0.0032)
    narrow, disc = min((p.width_m for p in wide.places), default=0.0032), float(wide.disc_m.min())
    count = textures_of(parts, names) if textures is None else textures
    return Legibility(
        [
            held("gap", "parts", narrow, ">=", 0.0032, "m", "", cure="larger", worse="illegible"),
            held("part", "parts", disc, ">=", 0.0064, "m", "", cure="larger", worse="illegible"),
            held("textures", "parts", float(count), "<=", 5, "", "", cure="fewer", worse="illegible"),
        ]
    )
