"""Gaps between the marks of a drawn page, measured in pixels: which are too narrow for a finger."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64, UInt8
from scipy.ndimage import distance_transform_edt, find_objects

from ..sheet import GAP_MM
from .reading import Mark, Marks
from .rendering import black

PIXELS_PER_MM = 10
# Tolerance of the first search: OpenCV's distances are off by 2 % at most, and each gap is the sum of two.
_INEXACT = 1.04


@dataclass(frozen=True, eq=False)
class Near:
    """Two marks with a gap below GAP_MM; 0 where they touch."""

    marks: tuple[Mark, Mark]
    gap_mm: float
    place_mm: tuple[float, float]

    @property
    def between_outlines(self) -> bool:
        """True if both are outlines, so that neither moving a letter nor thinning out a fill helps."""
        return all(mark.what == "outline" for mark in self.marks)

    def __str__(self) -> str:
        one, other = (f"the {mark.what} of {mark.label}" for mark in self.marks)
        x, y = self.place_mm
        return f"{one} and {other} are {self.gap_mm:.2g} mm apart at {x:.0f}, {y:.0f} mm"


def too_near(page: Marks) -> list[Near]:
    """Return all pairs of marks that are too near; outlines that touch count as one, dots of one text do not count."""
    ink = black(page, PIXELS_PER_MM)
    rows = np.flatnonzero(ink.any(axis=1))
    ink = ink[: rows[-1] + 1] if rows.size else ink
    distances = cv2.distanceTransformWithLabels(
        (~ink).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_CCOMP
    )
    far, nearest = np.asarray(distances[0], np.float32), np.asarray(distances[1], np.int32)
    blots = _marks_of_blots(page, nearest)
    touching = [
        Near(pair, 0.0, pair[0].place_mm)
        for marks in blots.values()
        for pair in combinations(_with_one_outline(marks), 2)
        if not _may_be_near(*pair)
    ]
    is_line = np.zeros(int(nearest.max()) + 1, np.bool_)
    is_line[[number for number, marks in blots.items() if marks[0].what == "outline"]] = True
    lines = is_line[nearest[::2, ::2]] & ink[::2, ::2]
    return touching + list(_gaps(ink, far, nearest, blots)) + list(_narrow(page, lines))


def narrow_places(page: Marks) -> list[Near]:
    """Return the places where outlines run too near to each other, on a page of outlines alone, at half resolution."""
    return list(_narrow(page, black(page, PIXELS_PER_MM // 2)))


def _marks_of_blots(page: Marks, nearest: Int32[np.ndarray, "r c"]) -> dict[int, list[Mark]]:
    blots = defaultdict[int, list[Mark]](list)
    for mark in page.marks:
        x, y = (int(PIXELS_PER_MM * at) for at in mark.place_mm)
        if 0 <= y < nearest.shape[0] and 0 <= x < nearest.shape[1]:
            blots[int(nearest[y, x])].append(mark)
    return dict(blots)


def _with_one_outline(marks: list[Mark]) -> list[Mark]:
    return list({("outline" if mark.what == "outline" else id(mark)): mark for mark in marks}.values())


def _may_be_near(one: Mark, other: Mark) -> bool:
    """Tell whether two marks are dots of one text, or outlines of parts that touch."""
    return one.what == other.what and (one.what == "outline" or (one.what == "braille" and one.group == other.group))


def _gaps(
    ink: Bool[np.ndarray, "r c"],
    far: Float32[np.ndarray, "r c"],
    nearest: Int32[np.ndarray, "r c"],
    blots: Mapping[int, list[Mark]],
) -> Iterator[Near]:
    """Yield the pairs that are too near but do not touch. far, nearest: distance and number of the nearest blot."""
    places = dict[tuple[int, int], tuple[float, int, int]]()
    for down, right in ((0, 1), (1, 0)):
        rows, columns = ink.shape[0] - down, ink.shape[1] - right
        meet = np.flatnonzero(nearest[:rows, :columns] != nearest[down:, right:])
        row, column = np.divmod(meet, columns)
        between = far[row, column] + far[row + down, column + right]
        close = between < GAP_MM * PIXELS_PER_MM * _INEXACT
        row, column = row[close], column[close]
        one, other = nearest[row, column], nearest[row + down, column + right]
        _keep_least(places, (row, column), one, other, between[close])
    for (one, other), (_, row, column) in places.items():
        pair = blots[one][0], blots[other][0]
        if pair[0].what == "braille" and _may_be_near(*pair):
            continue
        if (gap_mm := _gap_mm(ink, nearest, one, other, row, column)) < GAP_MM - 1e-6:
            yield Near(pair, gap_mm, (column / PIXELS_PER_MM, row / PIXELS_PER_MM))


def _keep_least(
    places: dict[tuple[int, int], tuple[float, int, int]],
    at: tuple[Int64[np.ndarray, " n"], ...],
    one: Int32[np.ndarray, " n"],
    other: Int32[np.ndarray, " n"],
    between: Float32[np.ndarray, " n"],
) -> None:
    order = np.argsort(-between)
    for i in order.tolist():
        pair = (min(int(one[i]), int(other[i])), max(int(one[i]), int(other[i])))
        if pair not in places or between[i] < places[pair][0]:
            places[pair] = (float(between[i]), int(at[0][i]), int(at[1][i]))


def _gap_mm(
    ink: Bool[np.ndarray, "r c"], nearest: Int32[np.ndarray, "r c"], one: int, other: int, row: int, column: int
) -> float:
    """Return the exact gap between the edges of two blots around this place; infinite where one is missing."""
    reach = 2 * int(GAP_MM * PIXELS_PER_MM)
    window = slice(max(0, row - reach), row + reach), slice(max(0, column - reach), column + reach)
    here, there = (ink[window] & (nearest[window] == number) for number in (one, other))
    if not here.any() or not there.any():
        return np.inf
    return (float(np.asarray(distance_transform_edt(~there))[here].min()) - 1) / PIXELS_PER_MM


def _narrow(page: Marks, lines: Bool[np.ndarray, "r c"]) -> Iterator[Near]:
    """Yield the places where lines of one net, at half resolution, run too near: where no disc GAP_MM wide reaches."""
    pixel_mm = 2 / PIXELS_PER_MM
    free = (~lines).astype(np.uint8)
    far = pixel_mm * (cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) - 0.5)
    beyond = pixel_mm * _distance_to_centres(free, far >= GAP_MM / 2 - pixel_mm) - GAP_MM / 2
    tips = (free > 0) & (beyond > pixel_mm)
    count, places = cv2.connectedComponents(tips.astype(np.uint8), connectivity=4)
    if count == 1:
        return
    numbers, longest = np.arange(count), np.zeros(count, np.float32)
    np.maximum.at(longest, np.asarray(places, np.int64)[tips], beyond[tips])
    # The tip of a corner is accepted: it meets the open space on one side alone, and is not longer than GAP_MM.
    wrong = (longest > GAP_MM) | (_sides(places, (free > 0) & ~tips, count) > 1)
    for number in numbers[1:][wrong[1:]].tolist():
        row, column = (int(at) for at in np.unravel_index(np.where(places == number, far, -1).argmax(), far.shape))
        place = (column * pixel_mm, row * pixel_mm)
        mark = _outline_around(page, place)
        yield Near((mark, mark), max(0.0, 2 * float(far[row, column])), place)


def _distance_to_centres(
    free: UInt8[np.ndarray, "r c"], centres: Bool[np.ndarray, "r c"]
) -> Float32[np.ndarray, "r c"]:
    """Return the distance in pixels from each pixel to the nearest centre of a disc in the same connected region."""
    regions = cv2.connectedComponents(free, connectivity=4)[1]
    distance = np.zeros(free.shape, np.float32)
    for number, box in enumerate(find_objects(regions), 1):
        region = regions[box] == number
        outside = (~(centres[box] & region)).view(np.uint8)
        distance[box][region] = cv2.distanceTransform(outside, cv2.DIST_L2, 5)[region]
    return distance


def _sides(places: Int32[np.ndarray, "r c"], rest: Bool[np.ndarray, "r c"], count: int) -> Int64[np.ndarray, " n"]:
    adjacent = np.where(rest, cv2.dilate(places.astype(np.float32), np.ones((3, 3), np.uint8)), 0).astype(np.int32)
    _, sides = cv2.connectedComponents((adjacent > 0).astype(np.uint8), connectivity=8)
    pairs = np.unique(np.stack([sides[adjacent > 0], adjacent[adjacent > 0]]), axis=1)
    return np.bincount(np.asarray(pairs[1], np.int64), minlength=count)


def _outline_around(page: Marks, place_mm: tuple[float, float]) -> Mark:
    outlines = [mark for mark in page.marks if mark.what == "outline"]
    around = [mark for mark in outlines if mark.shape.contains_point(place_mm)] or outlines
    return min(around, key=lambda mark: float(np.prod(np.ptp(mark.shape.vertices, axis=0))))
