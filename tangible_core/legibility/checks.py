"""The checks, one a topic: each says what it found by the rules of a medium."""

from collections.abc import Callable, Iterator
from math import ceil

import numpy as np

from ..data import Material
from ..metrics import border_steps
from ..preflight.verdict import Change, Cure, Verdict, over
from .cells import boxes
from .legibility_input import Found, Looked, deepest
from .neighbours import apart, sampled
from .pins import PIN_PITCH_M, pins_of
from .words import mm

WIDEST_M = 2.0
"""Nothing so large is made: then a larger one is no cure."""
NOT_ALONE = "or have fewer and larger parts"


def wider(looked: Looked, times: float) -> list[str | Change]:
    """How all becomes so many times as large; nothing where nobody makes it so large."""
    if times * looked.width_m > WIDEST_M:
        return []
    return [Change("workspace.width_m", over(times * looked.width_m), "at least"), ", "]


def parts(looked: Looked) -> Iterator[Verdict]:
    """Whether there is more than one."""
    count = int(np.count_nonzero(np.bincount(looked.parts.labels.reshape(-1))))
    middle = Found("the picture", float(count))
    cure = "divide the picture: paint its parts (`tangible parts`), or choose another method for `texture:`"
    yield from looked.judged("parts", [middle], lambda _: cure, none=0, of="the picture", worse="is one part")


def gap(looked: Looked) -> Iterator[Verdict]:
    """Where a part is too narrow."""
    rule = looked.profile.rules["gap"]
    found = [
        Found(looked.called(int(looked.widths.part[place.piece])), place.width_m, looked.at(*place.at))
        for place in looked.widths.places
    ]

    def cure(width_m: float) -> Cure:
        simplified = Change("simplify.gap_m", over(rule.bound), "at least")
        return [simplified, ", ", *wider(looked, rule.bound / max(width_m, 1e-9)), NOT_ALONE]

    yield from looked.judged("gap", found, cure, none=rule.bound, of="places", worse="is too narrow for a finger")


def part(looked: Looked) -> Iterator[Verdict]:
    """Which parts are too small, and which can hardly be recognised."""
    wide, rule = looked.widths, looked.profile.rules["part"]
    small = np.flatnonzero(wide.disc_m < rule.bound)
    places = deepest(wide, small)
    largest = int(wide.disc_m.argmin())
    found = [
        Found(looked.called(int(wide.part[each])), float(wide.disc_m[each]), looked.at(*places[each]))
        for each in small.tolist()
    ] or [Found(looked.called(int(wide.part[largest])), float(wide.disc_m[largest]))]

    def cure(disc_m: float) -> Cure:
        simplified = Change("simplify.part_m", over(rule.bound), "at least")
        return [simplified, ", ", *wider(looked, rule.bound / max(disc_m, 1e-9)), NOT_ALONE]

    yield from looked.judged("part", found, cure, none=rule.bound, of="parts", worse="is smaller than a fingertip")


def shape(looked: Looked) -> Iterator[Verdict]:
    """The longer side of the parts that are large enough to be felt."""
    wide, rule = looked.widths, looked.profile.rules["shape"]
    large = np.flatnonzero(wide.disc_m >= looked.profile.rules["part"].bound * (1 - 1e-6))
    sides_m = looked.pitch_m * _sides(wide.pieces, wide.part.size)
    short = large[sides_m[large] < rule.bound]
    places = deepest(wide, short)
    found = [
        Found(looked.called(int(wide.part[each])), float(sides_m[each]), looked.at(*places[each]))
        for each in short.tolist()
    ]
    least = float(sides_m[large].min(initial=np.inf))

    def cure(side_m: float) -> Cure:
        return [*wider(looked, rule.bound / max(side_m, 1e-9)), NOT_ALONE]

    none = least if np.isfinite(least) else rule.bound
    worse = "is so small that its shape is hard to recognise"
    yield from looked.judged("shape", found, cure, none=none, of="parts", worse=worse)


def _sides(pieces: np.ndarray, count: int) -> np.ndarray:
    """The longer side of the box of each piece, in cells."""
    found = np.zeros(count)
    for piece, box in enumerate(boxes(pieces + 1)):
        found[piece] = max(each.stop - each.start for each in box) if box else 0
    return found


def textures(looked: Looked) -> Iterator[Verdict]:
    """How many there are."""
    rule = looked.profile.rules["textures"]
    found = [Found("the picture", float(looked.textures))]
    cure = [Change("simplify.textures", f"{rule.bound:g}", "at most"), ", or name the parts that are to stay apart"]
    worse = "has more textures than fingers tell apart"
    yield from looked.judged("textures", found, lambda _: cure, none=0, of="the picture", worse=worse)


def steps(looked: Looked) -> Iterator[Verdict]:
    """The steps between parts that have a border worth feeling, and how much of all borders has one."""
    if looked.relief is None:
        return
    found, rules = looked.steps, looked.profile.rules
    long = np.flatnonzero((found.length_m > rules["gap"].bound) & np.isfinite(found.step_m))
    if "step" in rules:
        yield from _stepped(looked, "step", long, "is hardly higher or lower than it")
        named = [
            each
            for each in long.tolist()
            if looked.has_name(int(found.low[each])) and looked.has_name(int(found.high[each]))
        ]
        kept = [each for each in named if found.step_m[each] >= rules["step"].bound]
        if named:
            yield from _stepped(looked, "named step", np.array(kept, np.int64), "is not much higher or lower than it")
    felt = border_steps(sampled(looked.relief, looked.parts.labels.shape), looked.parts.labels)["borders_found"]
    if np.isfinite(felt):
        shown = [Found("the borders of parts", 1 - felt)]
        worse = "are for the most part not felt as steps" if felt < 1 / 2 else "are partly not felt as steps"
        yield from looked.judged(
            "unfelt borders", shown, lambda _: _heighten(looked), none=0, of="the borders of parts", worse=worse
        )


def _heighten(looked: Looked) -> Cure:
    return "make the relief of parts (`heights: {by: given}`), and give neighbours different heights"


def _stepped(looked: Looked, check: str, pairs: np.ndarray, worse: str) -> Iterator[Verdict]:
    steps, rule = looked.steps, looked.profile.rules[check]
    found = [
        Found(
            f"{looked.called(int(steps.high[each]))} beside {looked.called(int(steps.low[each]))}",
            float(steps.step_m[each]),
            looked.at(*map(int, steps.at[each])),
        )
        for each in pairs.tolist()
    ]

    def cure(step_m: float) -> Cure:
        more_m = 1e-4 * max(1, ceil(1e4 * (rule.bound - step_m)))
        return f"make one of them {mm(more_m)} higher (`height_m` under `parts:`, with `heights:`)"

    yield from looked.judged(check, found, cure, none=rule.bound, of="pairs of neighbours", worse=worse)


def height(looked: Looked) -> Iterator[Verdict]:
    """Whether the relief is high enough to be felt at all."""
    if looked.relief is not None:
        yield from heights(looked, float(np.ptp(looked.relief.height_m)))


def heights(looked: Looked, height_m: float) -> Iterator[Verdict]:
    """As `height`."""
    cure = [Change("workspace.relief_m", over(0.004), "at least"), ", if it comes of a picture; else higher parts"]
    found = [Found("the relief", height_m)]
    yield from looked.judged("height", found, lambda _: cure, none=0, of="the relief", worse="is too low to be felt")


def materials(looked: Looked) -> Iterator[Verdict]:
    """Neighbours that no step parts must be of materials that differ."""
    if looked.given_materials is None:
        return
    steps, rule = looked.steps, looked.profile.rules["materials"]
    distance: dict[tuple[Material, Material], float] = {}
    found: list[Found] = []
    felt_m = 0.0005
    for each in np.flatnonzero(steps.length_m > looked.profile.rules["gap"].bound).tolist():
        low, high = int(steps.low[each]), int(steps.high[each])
        one, other = looked.material(low), looked.material(high)
        if one is None or other is None or steps.step_m[each] >= felt_m:
            continue
        if (one, other) not in distance:
            distance[one, other] = apart(one, other)
        of = f"{looked.called(high)} beside {looked.called(low)}"
        found.append(Found(of, distance[one, other], looked.at(*map(int, steps.at[each]))))
    cure = "give one of them another material (`material` under `parts:`), or another height"
    worse = "is of nearly the same material and height"
    yield from looked.judged(
        "materials", found, lambda _: cure, none=max(rule.bound, 1.0), of="pairs of neighbours", worse=worse
    )


def pins(looked: Looked) -> Iterator[Verdict]:
    """Parts of a few pins, and borders that no pin shows."""
    shown = pins_of(looked.parts, looked.pitch_m)
    found = [
        Found(looked.called(number), float(count), looked.at(row, column))
        for number, count, (row, column) in shown.parts
    ]

    def cure(pins: float) -> Cure:
        return [Change("simplify.part_m", over(2 * PIN_PITCH_M * 1.5), "at least"), ", ", NOT_ALONE]

    yield from looked.judged("pins", found, cure, none=0, of="parts", worse="is hardly a pin or two")
    kept = [Found("the borders of parts", shown.kept)]

    def finer(share: float) -> Cure:
        return [Change("simplify.gap_m", over(2 * PIN_PITCH_M), "at least"), ", a larger display, " + NOT_ALONE]

    worse = "are partly shown by no pin"
    yield from looked.judged("kept borders", kept, finer, none=1, of="the borders of parts", worse=worse)


Check = Callable[[Looked], Iterator[Verdict]]
CHECKS: dict[str, tuple[Check, ...]] = {
    "swell": (parts, gap, part, shape, textures),
    "print": (parts, height, gap, part, shape, textures, steps),
    "pins": (parts, pins),
    "force": (parts, gap, part, shape, materials, steps),
}
"""The checks of each medium, in order."""
