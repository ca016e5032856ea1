"""The checks of legibility, one a topic: each yields verdicts by the rules of a medium."""

from collections.abc import Callable, Iterator
from itertools import chain
from math import ceil

import numpy as np

from tangible_core.data import Material
from tangible_core.preflight import Change, Cure, Verdict, over

from .cells import boxes
from .legibility_input import LegibilityInput, Measurement, deepest_cells
from .neighbours import PIN_PITCH_M, apart, border_steps, sample_relief, show_on_pins
from .words.places import millimetres

WIDEST_M = 2.0  # no larger picture is proposed as a cure
FELT_STEP_M = 0.0005  # that of the rule `step`: neighbours' materials need not differ then
FEWER_PARTS = "or have fewer and larger parts"
HEIGHTEN: Cure = "make the relief of parts (`heights: {by: given}`), and give neighbours different heights"
LEVEL = "more pairs of neighbours are of hardly another height"
NEARLY_LEVEL = "more pairs of named neighbours are of nearly the same height"


def _widen_or_leave_out(data: LegibilityInput, bound: float, simplified: str = "") -> Callable[[float], Cure]:
    """Return the cure of a length below the bound. simplified: the key of a simplification that cures it as well."""

    def cure(length_m: float) -> Cure:
        width_m = data.width_m * bound / max(length_m, 1e-9)
        wider = [("workspace.width_m", width_m)] if width_m <= WIDEST_M else []
        bounds = [(simplified, bound), *wider] if simplified else wider
        changes = [[Change(key, over(value), "at least"), ", "] for key, value in bounds]
        return [*chain.from_iterable(changes), FEWER_PARTS]

    return cure


def parts(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that there is more than one part."""
    count = int(np.count_nonzero(np.bincount(data.parts.labels.reshape(-1))))
    measurements = [Measurement("the picture", float(count))]
    cure = "divide the picture: paint its parts (`tangible parts`), or choose another method for `texture:`"
    yield from data.judge("parts", measurements, lambda _: cure, none=0, of="the picture", worse="is one part")


def gap(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that no part is too narrow anywhere."""
    rule = data.profile.rules["gap"]
    measurements = [
        Measurement(
            data.describe_part(int(data.widths.part[place.piece])), place.width_m, data.share_of_picture(*place.at)
        )
        for place in data.widths.places
    ]
    cure = _widen_or_leave_out(data, rule.bound, "simplify.gap_m")
    worse, others = "is too narrow for a finger", "more places are too narrow for a finger"
    yield from data.judge("gap", measurements, cure, none=rule.bound, of="places", worse=worse, others=others)


def part(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that each piece holds a disc of the size of a fingertip."""
    wide, rule = data.widths, data.profile.rules["part"]
    small = np.flatnonzero(wide.disc_m < rule.bound)
    smallest = int(wide.disc_m.argmin())
    measurements = _measure_pieces(data, small, wide.disc_m) or [
        Measurement(data.describe_part(int(wide.part[smallest])), float(wide.disc_m[smallest]))
    ]
    cure = _widen_or_leave_out(data, rule.bound, "simplify.part_m")
    worse, others = "is smaller than a fingertip", "more parts are smaller than a fingertip"
    yield from data.judge("part", measurements, cure, none=rule.bound, of="parts", worse=worse, others=others)


def shape(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that pieces large enough to be felt are long enough for their shape to be recognised."""
    wide, rule = data.widths, data.profile.rules["shape"]
    large = np.flatnonzero(wide.disc_m >= data.profile.rules["part"].bound * (1 - 1e-6))
    longer = [max(side.stop - side.start for side in box) if box else 0 for box in boxes(wide.pieces + 1)]
    sides_m = data.pitch_m * np.array(longer, np.float64)
    measurements = _measure_pieces(data, large[sides_m[large] < rule.bound], sides_m)
    least = float(sides_m[large].min(initial=np.inf))
    cure = _widen_or_leave_out(data, rule.bound)
    none = least if np.isfinite(least) else rule.bound
    worse = "is so small that its shape is hard to recognise"
    others = "more parts are so small that their shape is hard to recognise"
    yield from data.judge("shape", measurements, cure, none=none, of="parts", worse=worse, others=others)


def _measure_pieces(data: LegibilityInput, pieces: np.ndarray, values: np.ndarray) -> list[Measurement]:
    places = deepest_cells(data.widths, pieces)
    return [
        Measurement(
            data.describe_part(int(data.widths.part[piece])),
            float(values[piece]),
            data.share_of_picture(*places[piece]),
        )
        for piece in pieces.tolist()
    ]


def textures(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that there are no more textures than fingers tell apart."""
    rule = data.profile.rules["textures"]
    measurements = [Measurement("the picture", float(data.textures))]
    cure = [Change("simplify.textures", f"{rule.bound:g}", "at most"), ", or name the parts that are to stay apart"]
    worse = "has more textures than fingers tell apart"
    yield from data.judge("textures", measurements, lambda _: cure, none=0, of="the picture", worse=worse)


def steps(data: LegibilityInput) -> Iterator[Verdict]:
    """Check the steps between parts with a long border, and the share of all borders without a noticeable step."""
    if data.relief is None:
        return
    steps, rules = data.steps, data.profile.rules
    long = np.flatnonzero((steps.length_m > rules["gap"].bound) & np.isfinite(steps.step_m))
    if "step" in rules:
        yield from _judge_steps(data, "step", long, "is hardly higher or lower than it", LEVEL)
        named_pairs = [
            pair for pair in long.tolist() if data.has_name(steps.low[pair]) and data.has_name(steps.high[pair])
        ]
        high_pairs = [pair for pair in named_pairs if steps.step_m[pair] >= rules["step"].bound]
        if named_pairs:
            pairs = np.array(high_pairs, np.int64)
            worse = "is not much higher or lower than it"
            yield from _judge_steps(data, "named step", pairs, worse, NEARLY_LEVEL)
    felt_share = border_steps(sample_relief(data.relief, data.parts.labels.shape), data.parts.labels)["borders_found"]
    if np.isfinite(felt_share):
        measurements = [Measurement("the borders of parts", 1 - felt_share)]
        worse = "are for the most part not felt as steps" if felt_share < 1 / 2 else "are partly not felt as steps"
        yield from data.judge(
            "unfelt borders", measurements, lambda _: HEIGHTEN, none=0, of="the borders of parts", worse=worse
        )


def _judge_steps(data: LegibilityInput, check: str, pairs: np.ndarray, worse: str, others: str) -> Iterator[Verdict]:
    steps, rule = data.steps, data.profile.rules[check]
    measurements = [_measure_pair(data, pair, float(steps.step_m[pair])) for pair in pairs.tolist()]

    def cure(step_m: float) -> Cure:
        more_m = 1e-4 * max(1, ceil(1e4 * (rule.bound - step_m)))
        return f"make one of them {millimetres(more_m)} higher (`height_m` under `parts:`, with `heights:`)"

    of = "pairs of neighbours"
    yield from data.judge(check, measurements, cure, none=rule.bound, of=of, worse=worse, others=others)


def _measure_pair(data: LegibilityInput, pair: int, value: float) -> Measurement:
    steps = data.steps
    high, low = (data.describe_part(int(numbers[pair])) for numbers in (steps.high, steps.low))
    return Measurement(f"{high} next to {low}", value, data.share_of_picture(*map(int, steps.at[pair])))


def height(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that the relief is high enough to be felt."""
    if data.relief is None:
        return
    measurements = [Measurement("the relief", float(np.ptp(data.relief.height_m)))]
    cure = [Change("workspace.relief_m", over(0.004), "at least"), ", if it comes from a picture; else higher parts"]
    yield from data.judge(
        "height", measurements, lambda _: cure, none=0, of="the relief", worse="is too low to be felt"
    )


def materials(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that neighbours without a noticeable step are of different materials."""
    if data.material_map is None:
        return
    steps, rule = data.steps, data.profile.rules["materials"]
    distance: dict[tuple[Material, Material], float] = {}
    measurements: list[Measurement] = []
    for pair in np.flatnonzero(steps.length_m > data.profile.rules["gap"].bound).tolist():
        one, other = data.material(int(steps.low[pair])), data.material(int(steps.high[pair]))
        if one is None or other is None or steps.step_m[pair] >= FELT_STEP_M:
            continue
        if (one, other) not in distance:
            distance[one, other] = apart(one, other)
        measurements.append(_measure_pair(data, pair, distance[one, other]))
    cure = "give one of them another material (`material` under `parts:`), or another height"
    worse, none = "is of nearly the same material and height", max(rule.bound, 1.0)
    of, others = "pairs of neighbours", "more pairs of neighbours are of nearly the same material and height"
    yield from data.judge("materials", measurements, lambda _: cure, none=none, of=of, worse=worse, others=others)


def pins(data: LegibilityInput) -> Iterator[Verdict]:
    """Check that each part has enough pins, and that pins show its borders."""
    display = show_on_pins(data.parts, data.pitch_m)
    measurements = [
        Measurement(data.describe_part(number), float(count), data.share_of_picture(row, column))
        for number, count, (row, column) in display.parts
    ]

    cure: Cure = [Change("simplify.part_m", over(2 * PIN_PITCH_M * 1.5), "at least"), ", ", FEWER_PARTS]
    worse, others = "has hardly a pin or two", "more parts have hardly a pin or two"
    yield from data.judge("pins", measurements, lambda _: cure, none=0, of="parts", worse=worse, others=others)
    borders = [Measurement("the borders of parts", display.kept)]
    finer: Cure = [Change("simplify.gap_m", over(2 * PIN_PITCH_M), "at least"), ", a larger display, " + FEWER_PARTS]
    worse = "are partly not shown by any pin"
    yield from data.judge("kept borders", borders, lambda _: finer, none=1, of="the borders of parts", worse=worse)


Check = Callable[[LegibilityInput], Iterator[Verdict]]
CHECKS: dict[str, tuple[Check, ...]] = {
    "swell": (parts, gap, part, shape, textures),
    "print": (parts, height, gap, part, shape, textures, steps),
    "pins": (parts, pins),
    "force": (parts, gap, part, shape, materials, steps),
}
