"""Verdicts on the legibility of parts for fingers, by the rules of one medium."""

from collections.abc import Iterator, Mapping, Sequence

from tangible_core.data import MaterialMap, PartMap, Relief
from tangible_core.drawing import DrawnPicture, PictureKind
from tangible_core.errors import GeometryError
from tangible_core.plugins import Medium
from tangible_core.preflight import Grade, Legibility, Verdict, check_bound

from .checks import CHECKS, height
from .drawings import judge_drawing
from .grid import on_grid
from .legibility_input import LegibilityInput
from .rules import PROFILES, Rule
from .words.places import millimetres


def legibility(
    medium: Medium,
    parts: PartMap | None,
    width_m: float,
    *,
    relief: Relief | None = None,
    materials: MaterialMap | None = None,
    names: Sequence[str] = (),
    textures: int | None = None,
    drawing: DrawnPicture | None = None,
) -> Legibility:
    """Check by the rules of a medium whether fingers can read these parts; return a verdict a rule.

    Parts that fail have a verdict each, the worst ones first, and the rest one together. Rules on data that is missing,
    such as steps without a relief, are left out.
    parts: None for a picture that is not divided. width_m: of the whole. relief, materials: of the whole, on any grid;
    one material a part or a segment. names: of parts, by number. textures: their number, if it is not one a segment.
    drawing: a picture that is a drawing, of which what matters must be left; line art drawn as lines needs no parts.
    Raises: GeometryError if width_m is not positive.
    """
    profile = PROFILES[medium]
    verdicts = list[Verdict]()
    if drawing is not None:
        if drawing.kind == PictureKind.text or (drawing.kind == PictureKind.lines and drawing.lines and not any(names)):
            return Legibility.of(judge_drawing(drawing, profile, None, width_m, names))
        verdicts += judge_drawing(drawing, profile, parts, width_m, names)
    if parts is None:
        if not width_m > 0:
            raise GeometryError(f"width_m must be a positive length in metres, not {width_m}")
        return Legibility.of([*verdicts, *_judge_undivided(medium, relief, width_m)])
    grid = on_grid(parts, width_m)
    data = LegibilityInput(profile, grid.parts, grid.pitch_m, width_m, relief, materials, names, textures)
    return Legibility.of([*verdicts, *(verdict for check in CHECKS[medium] for verdict in check(data))])


def _judge_undivided(medium: Medium, relief: Relief | None, width_m: float) -> Iterator[Verdict]:
    rule, cure = PROFILES[medium].rules["parts"], "add `parts: {}` to the file, and a method for `texture:`"
    says = "the picture is not divided into parts"
    worse: Grade = "warn" if medium in ("print", "force") else rule.worse
    yield check_bound(
        *("parts", "the picture", 0.0, rule.relation, rule.bound, rule.unit, rule.citation),
        cure=cure, says=says, worse=worse,
    )  # fmt: skip
    if relief is not None and "height" in PROFILES[medium].rules:
        import numpy as np

        one = PartMap(np.zeros(relief.height_m.shape, np.int32), (0,))
        pitch_m = relief.pitch_m[0]
        yield from height(LegibilityInput(PROFILES[medium], one, pitch_m, width_m, relief, None, (), None))


def sizes(medium: Medium, **sizes_m: float) -> Legibility:
    """Check sizes that an exporter chooses, by the names of rules: `line`, `base`, `braille_dot` and the like.

    >>> sizes("print", base=0.0005).sentence
    'Illegible, because the base is 0.5 mm, and at least 0.8 mm are needed.'
    """
    rules: Mapping[str, Rule] = {check.replace(" ", "_"): rule for check, rule in PROFILES[medium].rules.items()}
    return Legibility.of(_size(rules[name], value) for name, value in sizes_m.items())


def _size(rule: Rule, size_m: float) -> Verdict:
    bound = millimetres(rule.bound)
    limit = f"at most {bound}" if rule.relation == "<=" else f"at least {bound}"
    return check_bound(
        *(rule.check, rule.says, size_m, rule.relation, rule.bound, rule.unit, rule.citation),
        says=f"the {rule.check} is {millimetres(size_m)}, and {limit} are needed",
        cure=limit,
        worse=rule.worse,
    )
