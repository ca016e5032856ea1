"""Parts: which steps of a relief are borders, what heights are worth, and how long parts take."""

from collections.abc import Callable
from functools import cache
from math import ceil
from statistics import fmean
from typing import Any

import cv2
import numpy as np

from tangible_authoring.first_parts import SEGMENTS_PER_PART
from tangible_core import DisparityMap, Views, load_method
from tangible_core.data import PartMap, Relief, SegmentMap
from tangible_core.parts import HeightChoice, Layering, depth_heights, find_parts, guess_heights
from tangible_core.scene.geometry import smooth
from tangible_core.scene.scene import Scene
from tangible_core.scene.workspace import SUITS, Workspace
from tangible_export.paper.borders import shared_borders
from tangible_legibility.neighbours import border_steps
from tangible_legibility.simplifying.large import large_parts
from tangible_texture import Hierarchy

from .figures import Figure, judged, mean_and_error, part, table
from .tests_path import drawn_parts
from .turns import processor_s

PICTURES = ("astronaut", "coffee", "motorcycle", "chelsea", "rocket", "camera")
WIDTH_M, TALL_M = 0.16, 0.006
GIVEN, GUESS = HeightChoice(by="given"), HeightChoice(by="guess")
TOP_M = TALL_M - GIVEN.bulge_m - GIVEN.detail_m
MIN_SHARE, MAX_PARTS, MIN_WIDTH = 0.89, 12, 1 / 16
# Of automatic parts: share of drawn borders that are felt, and share of what is felt that is a drawn border.
MIN_FOUND, MIN_TRUE = 0.75, 0.60
SIZES = {0.4: (500, 741), 5: (2000, 2667), 12: (3000, 4000)}  # rows and columns, by megapixels
RELIEF_MS, RUNS = 15, 7


def section() -> str:
    """Return the section as Markdown."""
    head = (
        f"Pictures that come with scikit-image, {1000 * WIDTH_M:.0f} mm wide, {1000 * TALL_M:.0f} mm high. A step is "
        "felt where heights differ by 0.5 mm within 2 mm, after a Gaussian of 0.5 mm. Drawn: by hand, in "
        "`tests/helpers/drawn_parts.yaml`. Automatic: as `tangible parts` finds them, at most 12. Layers win partly by "
        "construction: they have steps at the borders of the parts that they are made of. No reader was asked."
    )
    borders, shares = part("borders", _borders)
    heights = part("heights", _heights)
    times, figures = part("times", _times)
    return "\n".join([head, "", *borders, "", *heights, "", *times, "", *judged([*shares, *figures])])


def _borders() -> tuple[list[str], list[Figure]]:
    rows: list[tuple[str, ...]] = []
    figures: list[Figure] = []
    of_automatic: list[tuple[float, float]] = []
    for name in PICTURES:
        drawn, automatic = drawn_parts.drawn(name), _automatic(name)
        flat = Relief(_luminance(name) * np.float32(TALL_M), _extent_m(drawn.parts))
        given = _layers(name, drawn.parts, drawn.heights_m, GIVEN)
        felt = smooth(_layers(name, drawn.parts, drawn.heights_m, GIVEN, Workspace().width_m), SUITS["parts"][1])
        guessed = _layers(name, automatic, guess_heights(automatic, TOP_M).heights_m, GUESS)
        reliefs = (
            ("`luminance`", flat, "drawn", drawn.parts),
            ("`luminance`", flat, "automatic", automatic),
            ("layers, drawn, `given`", given, "drawn", drawn.parts),
            ("layers, automatic, `guess`", guessed, "automatic", automatic),
            ("layers, automatic, `guess`", guessed, "drawn", drawn.parts),
            ("layers, drawn, `given`, as a pipeline makes them: 80 mm wide, smoothed", felt, "drawn", drawn.parts),
        )
        shares = [border_steps(relief, parts.labels) for _, relief, _, parts in reliefs]
        for (relief, _, of, _), found in zip(reliefs, shares, strict=True):
            rows.append((name, relief, of, *(f"{value:.2f}" for value in found.values())))
        for made, before, after in (("drawn", shares[0], shares[2]), ("automatic", shares[1], shares[3])):
            was, share = before["steps_at_borders"], after["steps_at_borders"]
            told, bound = f"{was:.2f} -> {share:.2f}", f">= {MIN_SHARE}"
            what = f"{name}: felt steps that are borders of {made} parts, by luminance -> by layers"
            figures.append(Figure(what, bound, told, share >= MIN_SHARE))
        share = shares[5]["steps_at_borders"]
        what = f"{name}: the same, drawn, as a pipeline makes them by default"
        figures.append(Figure(what, f">= {MIN_SHARE}", f"{share:.2f}", share >= MIN_SHARE))
        of_automatic.append((shares[4]["borders_found"], shares[4]["steps_at_borders"]))
    found, true = zip(*of_automatic, strict=True)
    figures.append(
        Figure(
            f"drawn borders that automatic parts find, and felt steps that are drawn borders, mean of {len(PICTURES)}",
            f">= {MIN_FOUND:.2f}, >= {MIN_TRUE:.2f}",
            f"{mean_and_error(found)}, {mean_and_error(true)}",
            fmean(found) >= MIN_FOUND and fmean(true) >= MIN_TRUE,
        )
    )
    return table(("picture", "relief", "borders of", "found", "of felt steps", "area stepped"), rows), figures


def _heights() -> list[str]:
    rows: list[tuple[str, ...]] = []
    depth = Scene.builtin("motorcycle").truth
    assert depth is not None
    for name in PICTURES:
        drawn = drawn_parts.drawn(name)
        person = np.float32(drawn.heights_m)[drawn.parts.labels]
        for made, parts in (("drawn", drawn.parts), ("automatic", _automatic(name))):
            truth = depth if name == "motorcycle" else person
            best, guess = (
                np.float32(each.heights_m)[parts.labels]
                for each in (depth_heights(parts, DisparityMap(truth), TOP_M), guess_heights(parts, TOP_M))
            )
            values = (_alike(each, truth) for each in (_luminance(name), guess, best))
            rows.append((name, f"{parts.count} {made}", *(f"{value:.2f}" for value in values)))
    said = (
        "Rank correlation, over all pixels, of the heights of parts with the truth: the depth that was measured of the "
        "motorcycle, and the heights that a person gave of the others."
    )
    return [said, "", *table(("picture", "parts", "`luminance`", "guessed", "by the truth, the best there is"), rows)]


def _times() -> tuple[list[str], list[Figure]]:
    rows: list[tuple[str, ...]] = []
    figures: list[Figure] = []
    for size, shape in SIZES.items():
        took = {name: 1000 * processor_s(work, RUNS) for name, work in _works(shape).items()}
        rows.append((f"{size} ({shape[1]} x {shape[0]})", *(f"{each:.3g}" for each in took.values())))
        if size == min(SIZES):
            what, relief_ms = f"a relief of new heights, {shape[1]} x {shape[0]}", took["Layering.relief"]
            figures.append(Figure(what, f"<= {RELIEF_MS} ms", f"{relief_ms:.1f} ms", relief_ms <= RELIEF_MS))
    said = (
        f"Milliseconds of one processor, median of {RUNS}: the parts of the drawn motorcycle are found, made ready for "
        "a relief, made one with new heights, given heights by guess and by depth, and bounded by shared lines."
    )
    return [said, "", *table(("megapixels", *(f"`{name}`" for name in took)), rows)], figures


def _works(shape: tuple[int, int]) -> dict[str, Callable[[], Any]]:
    drawn = drawn_parts.drawn("motorcycle")
    segments = SegmentMap(cv2.resize(drawn.parts.labels, shape[::-1], interpolation=cv2.INTER_NEAREST))
    picture = cv2.resize(drawn.picture, shape[::-1])
    parts = find_parts(segments)
    heights_m = np.linspace(0, TOP_M, parts.count).tolist()
    layering = Layering(parts, WIDTH_M, GIVEN, picture)
    disparity = DisparityMap(layering.relief(heights_m).height_m)
    return {
        "find_parts": lambda: find_parts(segments),
        "Layering": lambda: Layering(parts, WIDTH_M, GIVEN, picture),
        "Layering.relief": lambda: layering.relief(heights_m),
        "guess_heights": lambda: guess_heights(parts, TOP_M),
        "depth_heights": lambda: depth_heights(parts, disparity, TOP_M),
        "shared_borders": lambda: shared_borders(parts, WIDTH_M, 0.0005),
    }


@cache
def _luminance(name: str) -> np.ndarray:
    return load_method("depth", "luminance")().estimate(Views(drawn_parts.drawn(name).picture)).disparity_px


@cache
def _automatic(name: str) -> PartMap:
    picture = drawn_parts.drawn(name).picture
    segments = Hierarchy(segments=ceil(SEGMENTS_PER_PART * MAX_PARTS)).segment(picture)
    return large_parts(segments, picture, MIN_WIDTH * max(picture.shape[:2]), MAX_PARTS)


def _layers(
    name: str, parts: PartMap, heights_m: tuple[float, ...], choice: HeightChoice, width_m: float = WIDTH_M
) -> Relief:
    return Layering(parts, width_m, choice, drawn_parts.drawn(name).picture).relief(heights_m)


def _extent_m(parts: PartMap) -> tuple[float, float]:
    rows, columns = parts.labels.shape
    return WIDTH_M, WIDTH_M * rows / columns


def _alike(heights: np.ndarray, truth: np.ndarray) -> float:
    from scipy.stats import spearmanr

    known = np.isfinite(truth)
    return float(spearmanr(heights[known], truth[known])[0])
