"""Legibility: what pictures break before and after they are simplified, how long that takes, and how exact it is."""

from collections.abc import Callable
from functools import cache
from math import cos, radians, sin
from statistics import median
from time import process_time
from typing import Any, NamedTuple

import cv2
import numpy as np

from tangible_core import load_method
from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import SimplifyChoice, find_parts
from tangible_legibility import legibility, simplify
from tangible_legibility.grid import on_grid
from tangible_legibility.widths import measure

from .figures import Figure, MissedError, judged, part, table
from .tests_path import colour_parts, drawn_parts

PICTURES = ("astronaut", "coffee", "motorcycle")
WIDTH_M, GAP_M = 0.16, 0.0032
CHOICE = SimplifyChoice()
MOST_S, MANY_S, RUNS = 1.0, 5.0, 3
PITCHES_M, ANGLES_DEG = (5e-5, 7e-5, 8e-5, 1e-4), range(0, 46, 3)
RULES = ("gap", "part", "textures")


class Case(NamedTuple):
    """Parts of a picture, by one way."""

    name: str
    how: str
    parts: PartMap
    names: tuple[str, ...]


def section() -> str:
    """Return the section as Markdown."""
    head = (
        f"Pictures that come with scikit-image, {1000 * WIDTH_M:.0f} mm wide, by the rules of swell paper. Drawn: by "
        "hand, in `tests/helpers/drawn_parts.yaml`; colours: six, by k-means; `gradient`: 20 segments. Seconds of one "
        f"processor, median of {RUNS}. No reader was asked; parts that pass need not mean anything."
    )
    rows, figures = part("simplify", _simplified)
    exact = [*part("strips", _strips), *part("scale", _scale), *part("many", _many)]
    text = "\n".join([head, "", *rows, "", *judged([*figures, *exact])])
    if not all(each.met for each in (*figures, *exact)):
        raise MissedError(text)
    return text


@cache
def _cases() -> tuple[Case, ...]:
    found: list[Case] = []
    for name in PICTURES:
        drawn = drawn_parts.drawn(name)
        segments = load_method("texture", "gradient")(segments=20).segment(drawn.picture)
        found += [
            Case(name, "drawn", drawn.parts, drawn.names),
            Case(name, "colours", colour_parts.by_colour(drawn.picture), ()),
            Case(name, "`gradient`", find_parts(segments), ()),
        ]
    return tuple(found)


def _simplified() -> tuple[list[str], list[Figure]]:
    rows: list[tuple[str, ...]] = []
    figures: list[Figure] = []
    for case in _cases():
        picture = drawn_parts.drawn(case.name).picture
        made: list[PartMap] = []
        seconds = _seconds(lambda case=case, picture=picture, made=made: made.append(
            simplify(case.parts, WIDTH_M, CHOICE, case.names, picture)
        ))  # fmt: skip
        found = made[-1]
        again = simplify(found, WIDTH_M, CHOICE, case.names, cv2.resize(picture, found.labels.shape[::-1]))
        same = np.array_equal(again.labels, found.labels) and again.segments == found.segments
        what = f"{case.name}, {case.how}"
        rows.append(
            (case.name, case.how, *_broken(case.parts), *_broken(found), _changed(case, found), f"{seconds:.2f}")
        )
        passes = _passes(found, case.names)
        figures += [
            Figure(f"{what}: passes when simplified, and twice is once", "yes", _yes(passes and same), passes and same),
            Figure(f"{what}: seconds", f"<= {MOST_S:g} s", f"{seconds:.2f} s", seconds <= MOST_S),
        ]
    heads = ("parts", "narrow", "border")
    before, after = ([f"{each} {when}" for each in heads] for when in ("before", "after"))
    return table(("picture", "parts by", *before, *after, "pixels changed", "s"), rows), figures


def _broken(parts: PartMap) -> tuple[str, str, str]:
    """Return connected parts, the share that is too narrow, and centimetres of border a square centimetre."""
    grid = on_grid(parts, WIDTH_M)
    wide = measure(grid.parts.labels, grid.pitch_m, GAP_M)
    labels = wide.pieces
    sides = np.count_nonzero(labels[1:] != labels[:-1]) + np.count_nonzero(labels[:, 1:] != labels[:, :-1])
    border = sides * np.pi / 4 / (labels.size * 100 * grid.pitch_m)
    return f"{wide.part.size:,}", f"{100 * wide.narrow.mean():.2g} %", f"{border:.2f} cm/cm2"


def _changed(case: Case, found: PartMap) -> str:
    before = cv2.resize(case.parts.labels, found.labels.shape[::-1], interpolation=cv2.INTER_NEAREST)
    segments = np.array(found.segments)
    return f"{100 * (segments[before] != segments[found.labels]).mean():.1f} %"


def _passes(parts: PartMap, names: tuple[str, ...]) -> bool:
    found = legibility("swell", parts, WIDTH_M, names=names)
    return all(each.verdict == "ok" for each in found if each.check in RULES)


def _strips() -> list[Figure]:
    """Yield strips of 3.1 and 3.3 mm, at all pitches and angles."""
    found: dict[float, list[bool]] = {0.0031: [], 0.0033: []}
    for pitch_m in PITCHES_M:
        for angle_deg in ANGLES_DEG:
            for width_m, passed in found.items():
                strip = _strip(width_m, angle_deg, pitch_m)
                verdicts = legibility("swell", strip, pitch_m * strip.labels.shape[1])
                passed.append(all(each.verdict == "ok" for each in verdicts if each.check == "gap"))
    count = len(found[0.0031])
    fail, hold = count - sum(found[0.0031]), sum(found[0.0033])
    return [
        Figure("strips of 3.1 mm that fail, of all pitches and angles", f"{count}", f"{fail}", fail == count),
        Figure("strips of 3.3 mm that pass, of all pitches and angles", f"{count}", f"{hold}", hold == count),
    ]


def _strip(width_m: float, angle_deg: float, pitch_m: float) -> PartMap:
    y, x = (np.indices((round(0.040 / pitch_m), round(0.030 / pitch_m))) + 0.5) * pitch_m - [[[0.020]], [[0.015]]]
    far_m = y * cos(radians(angle_deg)) - x * sin(radians(angle_deg))
    side = np.where(far_m < 0, 0, 2)
    return PartMap(np.where(np.abs(far_m) < width_m / 2 - 1e-9, 1, side).astype(np.int32), (0, 1, 2))


def _scale() -> list[Figure]:
    """Return the same picture of twice the pixels."""
    figures: list[Figure] = []
    for name in PICTURES:
        drawn = drawn_parts.drawn(name)
        large = PartMap(drawn.parts.labels.repeat(2, 0).repeat(2, 1), drawn.parts.segments)
        one, two = (legibility("swell", each, WIDTH_M, names=drawn.names) for each in (drawn.parts, large))
        alike = [(each.check, each.verdict) for each in one] == [(each.check, each.verdict) for each in two]
        pixel_m = WIDTH_M / drawn.parts.labels.shape[1]
        lengths = [(a.value, b.value) for a, b in zip(one, two, strict=False) if a.unit == "m"]
        apart = max((abs(a - b) for a, b in lengths), default=0.0) / pixel_m
        figures.append(
            Figure(
                f"{name}, drawn, of twice the pixels: the same verdicts, values within",
                "<= 1 pixel",
                f"{_yes(alike)}, {apart:.2f} pixels",
                alike and apart <= 1,
            )
        )
    return figures


def _many() -> list[Figure]:
    """Segments in great number."""
    picture = drawn_parts.drawn("coffee").picture
    whole = cv2.resize(np.arange(160, dtype=np.int32).reshape(10, 16), (600, 400), interpolation=cv2.INTER_NEAREST)
    fine = cv2.resize(np.arange(10_000, dtype=np.int32).reshape(100, 100), (800, 800), interpolation=cv2.INTER_NEAREST)
    figures: list[Figure] = []
    for labels in (whole, fine):
        parts = find_parts(SegmentMap(labels))
        seen = cv2.resize(picture, labels.shape[::-1])
        seconds = _seconds(lambda parts=parts, seen=seen: simplify(parts, WIDTH_M, CHOICE, (), seen))
        judging = _seconds(lambda parts=parts: legibility("swell", parts, WIDTH_M))
        what = f"{parts.count:,} segments that tile a picture"
        figures += [
            Figure(f"{what}: simplified", f"<= {MANY_S:g} s", f"{seconds:.2f} s", seconds <= MANY_S),
            Figure(f"{what}: judged", f"<= {MOST_S:g} s", f"{judging:.2f} s", judging <= MOST_S),
        ]
    return figures


def _seconds(work: Callable[[], Any]) -> float:
    taken: list[float] = []
    for _ in range(RUNS):
        start = process_time()
        work()
        taken.append(process_time() - start)
    return median(taken)


def _yes(said: bool) -> str:
    return "yes" if said else "no"
