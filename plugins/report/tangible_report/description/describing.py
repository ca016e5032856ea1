"""A surface in a few sentences, for people who do not see it, and facts about its parts."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32, Int64

from tangible_core.data import HapticSurface, MaterialMap, PartMap, PictureText
from tangible_core.drawing import bar_values
from tangible_core.errors import shown, wrong_argument
from tangible_core.parts.neighbours import neighbours
from tangible_core.scene import SceneKind
from tangible_legibility.cells import resampled
from tangible_legibility.words.languages import LANGUAGES, Language, Words
from tangible_legibility.words.places import NOWHERE, place_of, place_of_counts

# The most cells along a side: surfaces are described on a grid of at most this size.
MAX_CELLS = 512


class PartFacts(NamedTuple):
    """Facts about one part."""

    number: int
    name: str  # the name; empty if the part has none
    place: str  # the place of most of the part, as a key of every language's words; `- -` for no side
    share: float
    size_m: tuple[float, float]  # the extent from left to right, and from far to near
    height_m: float  # the median height above the base plane
    material: str  # the material's name in the library; empty if none is known
    neighbours: tuple[int, ...]  # the numbers of the parts that it borders on, the longest border first
    value: float | None = None  # what it stands for on the scale of a chart


def facts(
    surface: HapticSurface,
    materials: MaterialMap | None = None,
    parts: PartMap | None = None,
    names: tuple[str, ...] = (),
    texts: Sequence[PictureText] = (),
) -> tuple[PartFacts, ...]:
    """Return facts about the parts of a surface, the highest first; parts, names: in place of the surface's own.

    texts: those of the picture, which say what the bars of a chart stand for.

    >>> bar = HapticSurface.from_heights(np.eye(2), 0.08, np.eye(2, dtype=np.int32))
    >>> [(fact.number, fact.height_m, fact.neighbours) for fact in facts(bar)]
    [(1, 1.0, (0,)), (0, 0.0, (1,))]
    """
    if (whole := surface.labels if parts is None else parts.labels) is None:
        return ()
    part_names = (surface.names or ()) if parts is None else names
    step = grid_step(whole)
    labels = whole[::step, ::step]
    unique, dense = np.unique(labels, return_inverse=True)
    numbers: list[int] = unique.tolist()
    count = len(numbers)
    dense = dense.reshape(labels.shape).astype(np.int32)
    height_m = median_heights_m(dense, resampled(surface.height_m, labels.shape), count)
    share = np.bincount(dense.ravel()) / dense.size
    down, across = _count_cells(dense, count, 0), _count_cells(dense, count, 1)
    material_of, neighbours_of = _materials(surface, materials, dense, count), _neighbours(dense, count)
    values = bar_values(whole, texts)
    all_facts = [
        PartFacts(
            number,
            part_names[number].strip() if number < len(part_names) else "",
            place_of_counts(down[index], across[index]),
            float(share[index]),
            (surface.extent_m[0] * _span(across[index]), surface.extent_m[1] * _span(down[index])),
            float(height_m[index]),
            material_of[index],
            tuple(numbers[other] for other in neighbours_of[index]),
            values.get(number),
        )
        for index, number in enumerate(numbers)
    ]
    return tuple(sorted(all_facts, key=lambda part: (-part.height_m, part.number)))


def grid_step(cells: np.ndarray) -> int:
    """Return the n such that every n-th row and column have at most MAX_CELLS cells a side."""
    return math.ceil(max(cells.shape) / MAX_CELLS)


def median_heights_m(
    labels: Int32[np.ndarray, "h w"], height_m: Float32[np.ndarray, "h w"], count: int
) -> Float64[np.ndarray, " n"]:
    """Return the median height of each of n parts; NaN for a part without cells."""
    order = np.argsort(labels, axis=None, kind="stable")
    ends = np.cumsum(np.bincount(labels.ravel(), minlength=count))
    parts = np.split(height_m.ravel()[order].astype(np.float64), ends[:-1])
    return np.array([np.median(part) if part.size else np.nan for part in parts])


def _count_cells(dense: Int32[np.ndarray, "h w"], count: int, axis: int) -> Int64[np.ndarray, "n k"]:
    """Return the number of cells that each part has in every row (axis 0) or column (axis 1)."""
    size = dense.shape[axis]
    cells = dense.astype(np.int64) * size + np.indices(dense.shape, sparse=True)[axis]
    return np.bincount(cells.ravel(), minlength=count * size).reshape(count, size)


def _span(counts: Int64[np.ndarray, " k"]) -> float:
    """Return the distance from the first row or column with a cell to the last, as a share of all."""
    places = np.flatnonzero(counts)
    return int(places[-1] - places[0] + 1) / counts.size


def _materials(
    surface: HapticSurface, materials: MaterialMap | None, dense: Int32[np.ndarray, "h w"], count: int
) -> list[str]:
    """Return the name of the material of most of each part; empty if none is known."""
    palette = surface.materials or (materials.materials if materials else ())
    if surface.labels is None or int(surface.labels.max()) >= len(palette):
        return [""] * count
    label = resampled(surface.labels, dense.shape)
    pairs, cells = np.unique(dense.astype(np.int64) * len(palette) + label, return_counts=True)
    by_size = pairs[np.argsort(cells, kind="stable")].tolist()
    most: dict[int, int] = dict(divmod(pair, len(palette)) for pair in by_size)  # the last pair stays: the largest
    return [palette[most[part]].name for part in range(count)]


def _neighbours(dense: Int32[np.ndarray, "h w"], count: int) -> list[list[int]]:
    """Return the neighbours of each part, the longest border first."""
    borders = neighbours(PartMap(dense, tuple(range(count))))
    neighbours_of: list[list[int]] = [[] for _ in range(count)]
    for border in np.argsort(-borders.sides, kind="stable").tolist():
        low, high = int(borders.low[border]), int(borders.high[border])
        neighbours_of[low].append(high)
        neighbours_of[high].append(low)
    return neighbours_of


ALIKE = 0.1  # the share of the relief's height by which the highest places, or the lowest, may differ
# The largest slope that counts as level, about one degree: a hand does not feel it.
LEVEL_SLOPE = 0.02
MAX_NAMED = 4  # the number of materials that are named; the others are counted
MAX_PARTS = 12  # the number of parts that are named, the nearest; the others are counted
FLAT_M = 1e-6  # the height up to which a relief counts as flat: a hand does not feel it


def describe(
    surface: HapticSurface, scene_name: str, language: Language = "en", kind: SceneKind | None = None, people: int = 0
) -> str:
    """Return one to three sentences on a surface and its scene, always the same for the same surface.

    kind: of the scene, to be mentioned. people: known to be in front of the ground. language: one of `LANGUAGES`.
    Raises: ArgumentError for another language.

    >>> describe(HapticSurface.from_heights(np.zeros((8, 8))), "a plate")
    'a plate is felt as a surface 8 cm wide and 8 cm long. It is flat everywhere.'
    """
    if language not in LANGUAGES:
        raise wrong_argument("language", language, f"one of {', '.join(LANGUAGES)}")
    say = Words(language)
    of_what = _parts(surface, say) if any(surface.names or ()) else materials_in_words(surface, say)
    size = _size(surface, scene_name, kind, say)
    return " ".join(filter(None, [size, people_in_words(people, say), heights_in_words(surface, say), of_what]))


def people_in_words(people: int, say: Words) -> str:
    """Return a sentence on the people in front of the ground; empty for none."""
    return say("one person" if people == 1 else "people", count=people) if people else ""


def _size(surface: HapticSurface, name: str, kind: SceneKind | None, say: Words) -> str:
    width, length = (say.number(100 * side_m) for side_m in surface.extent_m)
    relief_m = float(np.ptp(surface.height_m))
    name = shown(name.removeprefix("builtin/"))
    what = say(kind or "surface", name=name) if name else say("nameless")
    high = say("high", relief=say.number(1000 * relief_m)) if relief_m > FLAT_M else ""
    return say("size", what=what, width=width, length=length, high=high)


def heights_in_words(surface: HapticSurface, say: Words) -> str:
    """Return a sentence on where the surface is high and low, and how much of it is flat."""
    lowest_m, highest_m = float(surface.height_m.min()), float(surface.height_m.max())
    if highest_m - lowest_m <= FLAT_M:
        return say("all flat")
    step = grid_step(surface.height_m)
    height_m = surface.height_m[::step, ::step].astype(np.float64)
    low_m, high_m = np.percentile(height_m, (1, 99)).tolist()
    if high_m - low_m < (highest_m - lowest_m) / 2:  # the raised part is small, but not a stray pixel
        low_m, high_m = float(height_m.min()), float(height_m.max())
    band_m = ALIKE * (high_m - low_m)
    highest, lowest = height_m >= high_m - band_m, height_m <= low_m + band_m
    flat = _flat(surface, height_m, step, say)
    if place_of(highest) == place_of(lowest) == NOWHERE:
        return say("mixed", flat=flat)
    around = place_of(lowest) == NOWHERE and lowest.mean() > 1 / 2
    return say(
        "highest", highest=say(place_of(highest)), lowest=say("around" if around else place_of(lowest)), flat=flat
    )


def _flat(surface: HapticSurface, height_m: np.ndarray, step: int, say: Words) -> str:
    if min(height_m.shape) < 2:
        return ""
    across_m, along_m = (step * pitch_m for pitch_m in surface.relief.pitch_m)
    down, right = np.gradient(height_m, along_m, across_m)
    level = np.hypot(down, right) <= LEVEL_SLOPE
    share = float(level.mean())
    if share < 0.05:
        return say("hardly flat")
    if share > 0.95:
        return say("nearly all flat")
    return say("flat", share=percent(share), where=_place(level, ", {}", say))


def materials_in_words(surface: HapticSurface, say: Words) -> str:
    """Return a sentence on the materials, their shares and places; segments of one material count together."""
    if surface.labels is None or not surface.materials:
        return ""
    step = grid_step(surface.height_m)
    labels = surface.labels[::step, ::step]
    names = [material.name for material in surface.materials]
    parts = {
        name: np.isin(labels, [i for i, other in enumerate(names) if other == name]) for name in dict.fromkeys(names)
    }
    shares = {name: float(part.mean()) for name, part in parts.items() if part.any()}
    if len(shares) == 1:
        return say("one material", material=say.material_after_like(next(iter(shares))))
    by_share = sorted(shares, key=lambda name: (-shares[name], name))
    phrases = [
        say("part", material=say.material(name), share=percent(shares[name]), where=_place(parts[name], " ({})", say))
        for name in by_share[:MAX_NAMED]
    ]
    if others := by_share[MAX_NAMED:]:
        key = "another" if len(others) == 1 else "others"
        phrases.append(say(key, count=len(others), share=percent(sum(shares[name] for name in others))))
    return say("materials", count=len(shares), parts=say.join(phrases))


def _parts(surface: HapticSurface, say: Words) -> str:
    """Return a sentence on the named parts, the highest first, as it is the nearest: place, height and material."""
    names, step = surface.names or (), grid_step(surface.height_m)
    assert surface.labels is not None
    labels = surface.labels[::step, ::step]
    height_m = median_heights_m(labels, surface.height_m[::step, ::step], len(names))
    present = np.flatnonzero(np.isfinite(height_m))
    numbers = [number for number in present[np.argsort(-height_m[present], kind="stable")].tolist() if names[number]]
    phrases = [_part(surface, labels == number, number, float(height_m[number]), say) for number in numbers[:MAX_PARTS]]
    more, nameless = len(numbers) - len(phrases), len(present) - len(numbers)
    phrases += [say("part left" if more == 1 else "parts left", count=more)] if more else []
    phrases += [say("unnamed" if nameless == 1 else "all unnamed", count=nameless)] if nameless else []
    return say("one part" if len(phrases) == 1 else "parts", parts=say.join(phrases)) if phrases else ""


def _part(surface: HapticSurface, cells: Bool[np.ndarray, "h w"], number: int, height_m: float, say: Words) -> str:
    assert surface.names is not None
    facts = [] if place_of(cells) == NOWHERE else [say(place_of(cells))]
    facts += [say("part high", height=say.number(1000 * height_m))] if height_m > FLAT_M else []
    facts += (
        [say("part feels", material=say.material_after_like(surface.materials[number].name))]
        if surface.materials
        else []
    )
    name = shown(surface.names[number])
    return say("of a part", name=name, facts=", ".join(facts)) if facts else name


def percent(share: float) -> str:
    """Return a share in whole per cent, at least 1."""
    return str(max(1, round(100 * share)))


def _place(part: np.ndarray, form: str, say: Words) -> str:
    """Return the place of a part in a form such as ` ({})`; an empty text if it is on no side."""
    place = place_of(part)
    return "" if place == NOWHERE else form.format(say(place))
