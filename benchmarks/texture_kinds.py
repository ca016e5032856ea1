"""Mosaics of six kinds of region, of two halves of the textures given: a tuning half and a reported one."""

from collections.abc import Callable, Iterator, Mapping
from functools import cache

import cv2
import numpy as np
from jaxtyping import Int32

from tangible_core.testing.synthetic.texture_scenes import (
    Family,
    KnownSegments,
    builtin_textures,
    curvy_regions,
    folder_textures,
    in_order,
    scatter_points,
    without_grey,
)

from .texture_scenes import folders

SEGMENTS = 2, 3, 4, 5, 6, 7, 8, 10, 12, 16
ROUNDS = 8  # the number of mosaics of each number of segments, every one of another kind and seed
SMALL_PX, LARGE_PX, FEW = 384, 512, 4  # the sides of mosaics of FEW segments at most, and of more
LETTERS = "AOBHERSTUXZK"
THICK = 0.2  # the width of a letter's strokes, as a share of its square
# The least share of the area of a segment; regions are drawn again until none is smaller.
MIN_SHARE = 0.006
TRIES = 50
TUNING_SEED, REPORTED_SEED = 1000, 3000

Labels = Int32[np.ndarray, "s s"]
Regions = Callable[[int, int, np.random.Generator], np.ndarray]


def tuning_half() -> dict[str, KnownSegments]:
    """Mosaics of every other texture, from the first on: methods may be tuned on these."""
    return _mosaics(0, TUNING_SEED)


def reported_half() -> dict[str, KnownSegments]:
    """Mosaics of the other textures, that no method was tuned on."""
    return _mosaics(1, REPORTED_SEED)


@cache
def _mosaics(first: int, seed: int) -> dict[str, KnownSegments]:
    textures = _textures()
    names = sorted(textures)[first::2]
    return dict(_draw({name: textures[name] for name in names}, seed))


def _textures() -> Mapping[str, Family]:
    given = folders()
    return {f"{at} {name}": each for at, path in enumerate(given) for name, each in folder_textures(path).items()} or (
        builtin_textures()
    )


def _draw(textures: Mapping[str, Family], seed: int) -> Iterator[tuple[str, KnownSegments]]:
    kinds = list(KINDS)
    for turn in range(ROUNDS):
        for index, segments in enumerate(each for each in SEGMENTS if each <= len(textures)):
            kind = _possible(kinds[(turn + index) % len(kinds)], segments)
            random = np.random.default_rng([seed, turn, segments])
            yield f"{kind} {segments} turn {turn}", _mosaic(kind, segments, textures, random)


def _mosaic(kind: str, segments: int, textures: Mapping[str, Family], random: np.random.Generator) -> KnownSegments:
    labels = regions_of(kind, segments, SMALL_PX if segments <= FEW else LARGE_PX, random)
    picture = np.zeros(labels.shape)
    for label, name in enumerate(random.permutation(sorted(textures))[: labels.max() + 1]):
        np.copyto(picture, without_grey(textures[name](labels.shape, random)), where=labels == label)
    return KnownSegments(np.rint(picture.clip(0, 255)).astype(np.uint8), labels)


def regions_of(kind: str, segments: int, side: int, random: np.random.Generator) -> Labels:
    """Draw the labels of a square mosaic of a kind, 0..segments-1; straight ones of too many for rings or letters."""
    return in_order(_large_enough(KINDS[_possible(kind, segments)], segments, side, random))


def _possible(kind: str, segments: int) -> str:
    return "straight" if (kind == "rings" and segments > 7) or (kind == "letters" and segments > 10) else kind


def _large_enough(regions: Regions, segments: int, side: int, random: np.random.Generator) -> np.ndarray:
    labels = regions(segments, side, random)
    for _ in range(TRIES):
        if _least_share(labels, segments) >= MIN_SHARE:
            break
        labels = regions(segments, side, random)
    return labels


def _least_share(labels: np.ndarray, segments: int) -> float:
    return float(np.bincount(labels.ravel(), minlength=segments).min() / labels.size)


def _straight(segments: int, side: int, random: np.random.Generator) -> np.ndarray:
    count = max(segments + 1, 3 * segments // 2)
    return random.permutation(np.arange(count) % segments)[
        _distances(scatter_points((side, side), count, random), side).argmin(axis=0)
    ]


def _curved(segments: int, side: int, random: np.random.Generator) -> np.ndarray:
    count = max(segments + 2, 8 * segments // 5)
    return random.permutation(np.arange(count) % segments)[curvy_regions((side, side), count, random)]


def _grid(segments: int, side: int, _: np.random.Generator) -> np.ndarray:
    rows = int(np.ceil(np.sqrt(segments)))
    columns = -(-segments // rows)
    row, column = np.indices((side, side))
    return np.minimum(row * rows // side * columns + column * columns // side, segments - 1)


def _rings(segments: int, side: int, random: np.random.Generator) -> np.ndarray:
    away = _distances(side * random.uniform(0.35, 0.65, (1, 2)), side)[0]
    return np.searchsorted(np.quantile(away, np.arange(1, segments) / segments), away)


def _unequal(segments: int, side: int, random: np.random.Generator) -> np.ndarray:
    sizes = (0.22 * side) ** 2 * random.uniform(0.2, 1.6, segments) ** 2
    points = side * random.uniform(0.05, 0.95, (segments, 2))
    return (_distances(points, side) - sizes[:, None, None]).argmin(axis=0)


def _letters(segments: int, side: int, random: np.random.Generator) -> np.ndarray:
    grounds = segments // 3 if segments >= 6 else 1
    labels = in_order(curvy_regions((side, side), grounds, random))
    grounds = int(labels.max()) + 1
    across = int(np.ceil(np.sqrt(segments - grounds)))
    square = side // across
    for index in range(segments - grounds):
        top, left = index // across * square, index % across * square
        inside = labels[top : top + square, left : left + square]
        inside[_letter(LETTERS[random.integers(len(LETTERS))], square)] = grounds + index
    return labels


def _letter(letter: str, square: int) -> np.ndarray:
    mask, scale, thick = np.zeros((square, square), np.uint8), square / 30, max(6, round(THICK * square))
    (width, height), _ = cv2.getTextSize(letter, cv2.FONT_HERSHEY_SIMPLEX, scale, thick)
    place = (square - width) // 2, (square + height) // 2
    cv2.putText(mask, letter, place, cv2.FONT_HERSHEY_SIMPLEX, scale, 1, thick)
    return mask > 0


def _distances(points: np.ndarray, side: int) -> np.ndarray:
    row, column = np.indices((side, side))
    return np.stack([(row - down) ** 2 + (column - right) ** 2 for down, right in points])


KINDS: Mapping[str, Regions] = {
    "straight": _straight,
    "curved": _curved,
    "letters": _letters,
    "grid": _grid,
    "rings": _rings,
    "unequal": _unequal,
}
