"""Legibility: what pictures break before and after they are simplified, and how long that takes."""

from functools import cache
from typing import NamedTuple

import cv2
import numpy as np

from tangible_core import load_method
from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import SimplifyChoice, find_parts
from tangible_legibility import legibility, simplify
from tangible_legibility.grid import on_grid
from tangible_legibility.widths import measure

from .figures import Figure, judged, part, table
from .tests_path import colour_parts, drawn_parts
from .turns import processor_s

PICTURES = ("astronaut", "coffee", "motorcycle")
WIDTH_M, GAP_M = 0.16, 0.0032
CHOICE = SimplifyChoice()
MAX_S, MANY_S, RUNS = 1.0, 5.0, 3
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
    exact = part("many", _many)
    return "\n".join([head, "", *rows, "", *judged([*figures, *exact])])


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
        seconds = processor_s(lambda case=case, picture=picture, made=made: made.append(
            simplify(case.parts, WIDTH_M, CHOICE, case.names, picture)
        ), RUNS)  # fmt: skip
        found = made[-1]
        again = simplify(found, WIDTH_M, CHOICE, case.names, cv2.resize(picture, found.labels.shape[::-1]))
        same = np.array_equal(again.labels, found.labels) and again.segments == found.segments
        what = f"{case.name}, {case.how}"
        rows.append(
            (case.name, case.how, *_broken(case.parts), *_broken(found), _changed(case, found), f"{seconds:.2f}")
        )
        passes = _passes(found, case.names)
        figures += [
            Figure(
                f"{what}: passes when simplified, and twice is once",
                "yes",
                "yes" if passes and same else "no",
                passes and same,
            ),
            Figure(f"{what}: seconds", f"<= {MAX_S:g} s", f"{seconds:.2f} s", seconds <= MAX_S),
        ]
    heads = ("parts", "narrow", "border")
    before, after = ([f"{head} {when}" for head in heads] for when in ("before", "after"))
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


def _many() -> list[Figure]:
    picture = drawn_parts.drawn("coffee").picture
    whole = cv2.resize(np.arange(160, dtype=np.int32).reshape(10, 16), (600, 400), interpolation=cv2.INTER_NEAREST)
    fine = cv2.resize(np.arange(10_000, dtype=np.int32).reshape(100, 100), (800, 800), interpolation=cv2.INTER_NEAREST)
    figures: list[Figure] = []
    for labels in (whole, fine):
        parts = find_parts(SegmentMap(labels))
        seen = cv2.resize(picture, labels.shape[::-1])
        seconds = processor_s(lambda parts=parts, seen=seen: simplify(parts, WIDTH_M, CHOICE, (), seen), RUNS)
        judging = processor_s(lambda parts=parts: legibility("swell", parts, WIDTH_M), RUNS)
        what = f"{parts.count:,} segments that tile a picture"
        figures += [
            Figure(f"{what}: simplified", f"<= {MANY_S:g} s", f"{seconds:.2f} s", seconds <= MANY_S),
            Figure(f"{what}: judged", f"<= {MAX_S:g} s", f"{judging:.2f} s", judging <= MAX_S),
        ]
    return figures
