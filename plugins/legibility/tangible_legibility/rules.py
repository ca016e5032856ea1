"""The rules of tactile graphics in one table, with value, unit and source, and the sizes of a braille cell."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from tangible_core.plugins import Medium
from tangible_core.preflight import Grade, Unit

# NLS Specification 800, "Braille Books and Pamphlets", section 3.2, Library of Congress.
DOT_DIAMETER_M = 0.00144  # at its base
DOT_HEIGHT_M = 0.00048
DOT_PITCH_M = 0.00234  # from dot to dot of a cell, down and across
CELL_PITCH_M = 0.0062  # from a dot to the same dot of the next cell
LINE_PITCH_M = 0.010  # from a dot to the same dot of the next line

GRAPHICS = "tactilegraphics.org"
ROUND_TABLE = "Round Table on Information Access for People with Print Disabilities"
APH = "American Printing House, 1997"
WIKI = "the wiki of tactile-graphics"
NLS = "NLS Specification 800"
JND = "differences that hands notice: friction 20 %, stiffness 45 %, grain and roughness 10 %"
OURS = "a convention of ours"


@dataclass(frozen=True)
class Rule:
    """A bound of one property, in one medium."""

    check: str
    """Name of the check, such as `gap`."""
    says: str
    """The property in words."""
    bound: float
    unit: Unit
    relation: Literal["<=", ">="]
    source: str
    ours: bool = False
    """True for a value that is our convention; `source` then states its reason."""
    worse: Grade = "illegible"
    """Grade if the rule is not met."""

    @property
    def citation(self) -> str:
        """The source, preceded by OURS for our conventions."""
        return ", ".join(filter(None, [OURS if self.ours else "", self.source]))


class Profile(NamedTuple):
    """The rules of one medium, by the names of their checks."""

    medium: Medium
    text: str
    """The medium in words, as the place where a picture is read."""
    rules: Mapping[str, Rule]


def _gap(source: str, ours: bool = False, worse: Grade = "illegible") -> Rule:
    return Rule("gap", "smallest width of a part", 0.0032, "m", ">=", source, ours, worse)


def _part(source: str, ours: bool = False, worse: Grade = "illegible") -> Rule:
    return Rule("part", "diameter of the largest disc in a part", 0.0064, "m", ">=", source, ours, worse)


_SHAPE = Rule("shape", "longer side of a part, for its shape to be recognised", 0.0127, "m", ">=", APH, worse="warn")
_TEXTURES = Rule("textures", "textures to tell apart", 5, "textures", "<=", WIKI)
_PARTS = Rule("parts", "parts of the picture", 2, "parts", ">=", "one part has no border to feel", True)
_STEP = Rule("step", "step of height between neighbouring parts", 0.0005, "m", ">=", f"{ROUND_TABLE}: felt")
_IMPORTANT = Rule(
    "named step",
    "the same step, if both parts have a name",
    0.001,
    "m",
    ">=",
    f"{ROUND_TABLE}: important",
    worse="warn",
)
_HEIGHT = Rule("height", "height of the relief", 0.0005, "m", ">=", f"{ROUND_TABLE}: felt")
_UNFELT = Rule(
    "unfelt borders",
    "share of the borders' length without a noticeable step",
    0.2,
    "share",
    "<=",
    "no number found",
    True,
    "warn",
)
_BRAILLE = (
    Rule("braille dot", "diameter of a braille dot", DOT_DIAMETER_M, "m", ">=", NLS),
    Rule("braille height", "height of a braille dot", DOT_HEIGHT_M, "m", ">=", NLS),
    Rule("braille dots", "distance from dot to dot in a braille cell", DOT_PITCH_M, "m", ">=", NLS),
    Rule("braille cells", "distance from braille cell to cell", CELL_PITCH_M, "m", ">=", NLS),
    Rule("braille lines", "distance from braille line to line", LINE_PITCH_M, "m", ">=", NLS),
)


def _profile(medium: Medium, text: str, *rules: Rule) -> Profile:
    return Profile(medium, text, {each.check: each for each in rules})


PROFILES: dict[Medium, Profile] = {
    "swell": _profile(
        "swell",
        "on swell paper",
        _PARTS,
        _gap(f"{GRAPHICS}, which advises 6.4 mm on capsule paper"),
        _part(GRAPHICS),
        _SHAPE,
        _TEXTURES,
        Rule("line", "width of an outline", 0.001, "m", ">=", "none found for swell paper", True),
        *(each for each in _BRAILLE if each.check != "braille height"),
    ),
    "print": _profile(
        "print",
        "on a 3-D print",
        _PARTS,
        _HEIGHT,
        _gap(f"as on swell paper; {ROUND_TABLE}: 2 mm in a double line, 5 mm between lines", ours=True),
        _part("as on swell paper", ours=True),
        _SHAPE,
        _TEXTURES,
        _STEP,
        _IMPORTANT,
        _UNFELT,
        Rule("line", "width of a raised line", 0.0011, "m", ">=", f"{ROUND_TABLE}, tactiles.eu: 1.1 to 3 mm"),
        Rule("base", "thickness of the plate below", 0.0008, "m", ">=", f"{ROUND_TABLE}; better 1.5 mm"),
        *_BRAILLE,
    ),
    "pins": _profile(
        "pins",
        "on a pin display",
        _PARTS,
        Rule("pins", "pins of a part", 4, "pins", ">=", "two by two are the fewest that are not a line", True),
        Rule("kept borders", "share of the borders' length within a pin of a border shown", 0.99, "share", ">=",
             "parts that are separate must feel separate", True),
    ),
    "force": _profile(
        "force",
        "on a force device",
        _PARTS,
        _gap("as on swell paper, though a tip is finer than a finger", ours=True, worse="warn"),
        _part("as on swell paper, though a tip is finer than a finger", ours=True, worse="warn"),
        _SHAPE,
        Rule("materials", "difference between the materials of neighbours without a step", 1, "JND", ">=", JND),
        _UNFELT,
    ),
}  # fmt: skip
