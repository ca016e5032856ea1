"""By ear: what the page says while a hand explores pictures, and what of them can be rebuilt from that alone."""

import json
import subprocess
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tangible_core.parts.neighbours import neighbours

from .by_ear_pictures import PITCH_M, Picture, pictures
from .by_ear_rebuild import Rebuilt, rebuild
from .figures import Figure, judged, mean_and_error, table
from .tests_path import page_files

STROKES, FEWER = 60, (10, 20)
SHARES = ("precision", "recall", "order")
LEAST = 0.9
# Border from which two parts are neighbours that are to be found: a fingertip is five times as wide.
MIN_BORDER_M = 0.002
MIN_STEP_M = 0.0003  # difference from which the order of two heights is to be found


class Score(NamedTuple):
    """The shares of a picture that were rebuilt."""

    kind: str
    parts: int
    pairs: int
    precision: float  # of the pairs that were said to touch, the share of those that do
    recall: float  # of the pairs that touch, the share of those that were said to
    order: float  # of all pairs of parts of different heights, the share of those whose order is right
    words: int  # words that were spoken


def section() -> str:
    """Return the section as Markdown."""
    scores = measure()
    rows = table(
        ("picture", "parts", "neighbours", "precision", "recall", "order", "words spoken"),
        [
            (each.kind, f"{each.parts}", f"{each.pairs}", *(f"{one:.2f}" for one in each[3:6]), f"{each.words}")
            for each in scores
        ],
    )
    fewer = table(
        ("strokes", *SHARES),
        [(f"{strokes}", *map(mean_and_error, _shares(measure(strokes)).values())) for strokes in FEWER],
    )
    means = _shares(scores)
    figures = [
        Figure(
            f"{what}, mean of {len(scores)} pictures", f">= {LEAST}", mean_and_error(means[name]),
            float(np.mean(means[name])) >= LEAST,
        )
        for name, what in (
            ("precision", "pairs said to touch that do"),
            ("recall", "touching pairs that are said to"),
            ("order", "pairs of parts whose order in height is right"),
        )
    ]  # fmt: skip
    head = (
        f"A hand explores ten pictures of parts, 80 mm wide, by {STROKES} strokes of the arrow keys each, through the "
        "page's own narration on a clock of its own. A program that reads the announcements alone, in English, says "
        f"which parts touch (along {1000 * MIN_BORDER_M:.0f} mm or more) and how high they are (by "
        f"{1000 * MIN_STEP_M:.1f} mm or more). After ±: the standard error."
    )
    return "\n".join([head, "", *rows, "", *judged(figures), "", "With fewer strokes:", "", *fewer])


def _shares(scores: list[Score]) -> dict[str, list[float]]:
    return {name: [getattr(each, name) for each in scores] for name in SHARES}


def measure(strokes: int = STROKES) -> list[Score]:
    """Explore every picture, rebuild it from what was said, and compare."""
    made = pictures()
    return [score(picture, rebuild(said), said) for picture, said in zip(made, announced(made, strokes), strict=True)]


def announced(made: list[Picture], strokes: int) -> list[list[str]]:
    """Return what the page's narration announces in each picture."""
    asked = json.dumps({"strokes": strokes, "pictures": [each.as_data() for each in made]})
    done = page_files.node(Path("test/explore.mjs"), cwd=page_files.WEB, stdin=asked)
    if done.returncode:
        raise subprocess.CalledProcessError(done.returncode, done.args, done.stdout, done.stderr)
    return json.loads(done.stdout)


def score(picture: Picture, found: Rebuilt, said: list[str]) -> Score:
    """Compare what was rebuilt with the picture."""
    names = picture.names or tuple(f"part {number}" for number in range(1, picture.parts.count + 1))
    borders = neighbours(picture.parts)
    pairs = [frozenset((names[low], names[high])) for low, high in zip(borders.low, borders.high, strict=True)]
    long = {pair for pair, sides in zip(pairs, borders.sides, strict=True) if sides * PITCH_M >= MIN_BORDER_M}
    height_m = [float(np.median(picture.height_m[picture.parts.labels == each])) for each in range(len(names))]
    order = [
        names[a] in found.height_mm
        and names[b] in found.height_mm
        and (height_m[a] < height_m[b]) == (found.height_mm[names[a]] < found.height_mm[names[b]])
        for a, b in combinations(range(len(names)), 2)
        if abs(height_m[a] - height_m[b]) >= MIN_STEP_M
    ]
    return Score(
        picture.kind,
        len(names),
        len(long),
        len(found.touching & set(pairs)) / max(1, len(found.touching)),
        len(found.touching & long) / len(long),
        float(np.mean(order)),
        sum(len(each.split()) for each in said),
    )
