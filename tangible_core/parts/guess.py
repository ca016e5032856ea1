"""Heights of parts guessed from place, size and border ownership, for a person to correct."""

import numpy as np
from jaxtyping import Float64, Int64

from ..data import PartMap
from ..data.part_words import name_part, shown_number
from ..data.pictures import to_rgb8
from ..runtime.opencv import cv2, plain_opencv
from ..scene.scaling import reduced_shape
from .find import part_sizes, reduced_parts
from .heights import PartHeights
from .neighbours import Neighbours, in_front, neighbours

# Weights of cues: foot, middle, shares of rims and of the picture, enclosure, occlusion (`benchmarks parts`).
FOOT, MIDDLE, RIM, SIZE, ENCLOSED, FRONT = 0.7, 0.3, 1.5, 0.1, 0.25, 0.5
# Largest difference in colour of a hole from a part beyond, as a share of that from the part around it.
LIKE = 0.5
# Nearness by which a hole is in front of what is seen through it, so that the two have an order.
APART = 1e-6
OWN = 0.5  # weight of a part's own cues; those of its neighbours have weight 1
ROUNDS = 40
SURE, MAX_NAMED = 0.3, 3  # smallest certainty of an occlusion that the reasons name, and how many they name
LONGEST_PX = 1000
SPECK = 0.001  # share of the picture below which a part shares a neighbour's height step


def guess_heights(parts: PartMap, top_m: float, picture: np.ndarray | None = None) -> PartHeights:
    """Guess a height for each part by size, place and border ownership: even steps from 0 to top_m, in their order."""
    parts = reduced_parts(parts, _coarse(parts.labels.shape))
    sizes = part_sizes(parts)
    foot, middle, rim = _places(parts, sizes)
    own = FOOT * foot + MIDDLE * middle - RIM * rim - SIZE * sizes / parts.labels.size
    pairs = neighbours(parts)
    sure = in_front(parts, pairs)
    enclosure = _enclosure(parts, pairs)
    # Parts low in a picture are near; parts that fill much of its upper and side rims, or of the whole picture, are
    # far. An enclosed part is in front, unless its colour is that of a part beyond: then it is a hole, such as the
    # water between the legs of a bear. The cues do not know what is shown: a table may come to lie before the things on
    # it.
    nearness = _relax(own, pairs, FRONT * sure + ENCLOSED * enclosure)
    for pair, beyond in _holes(parts, sizes, pairs, enclosure, picture).items():
        hole, around = _ends(pairs, pair, enclosure[pair])
        nearness[hole] = min(nearness[beyond] + APART, nearness[around] - APART)
        sure[pair] = -enclosure[pair]
    rank, steps = _rank(nearness, sizes)
    heights_m = top_m * rank / max(1, steps - 1)
    reasons = (
        f"guessed, {at + 1} of {steps} from the back: it reaches down to {100 * low:.0f} % of the picture's height and "
        f"has {100 * edge:.0f} % of its upper and side rims{overlap}"
        for at, low, edge, overlap in zip(rank.tolist(), foot, rim, _overlaps(pairs, sure, parts.count), strict=True)
    )
    return PartHeights(tuple(heights_m.tolist()), tuple(reasons))


def _places(
    parts: PartMap, sizes: Int64[np.ndarray, "n"]
) -> tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "n"], Float64[np.ndarray, "n"]]:
    labels, (rows, columns) = parts.labels, parts.labels.shape
    lines = np.repeat(np.arange(rows, dtype=np.int64), columns)
    lowest = np.sort(labels.reshape(-1).astype(np.int64) * rows + lines) % rows
    foot = (lowest[np.maximum(np.cumsum(sizes) - 1 - sizes // 20, 0)] + 1) / rows
    middle = (np.bincount(labels.reshape(-1), lines, parts.count) / np.maximum(sizes, 1) + 0.5) / rows
    rim = np.concatenate([labels[0], labels[:, 0], labels[:, -1]])
    return foot, middle, np.bincount(rim, minlength=parts.count) / rim.size


def _enclosure(parts: PartMap, pairs: Neighbours) -> Float64[np.ndarray, "m"]:
    """Return, for each pair, 1 if `low` encloses `high`, -1 for the reverse, 0 for neither."""
    labels, count = parts.labels, parts.count
    # It has one neighbour and no pixel at the rims of the picture.
    inside = np.bincount(pairs.low, minlength=count) + np.bincount(pairs.high, minlength=count) == 1
    inside[np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])] = False
    return inside[pairs.high].astype(np.float64) - inside[pairs.low]


def _holes(
    parts: PartMap,
    sizes: Int64[np.ndarray, "n"],
    pairs: Neighbours,
    enclosure: Float64[np.ndarray, "m"],
    picture: np.ndarray | None,
) -> dict[int, int]:
    """Return the pairs of a hole and the part around it, each with the part beyond that is seen through the hole."""
    holes = dict[int, int]()
    if picture is None or not enclosure.any():
        return holes
    lab = _mean_colours(parts, sizes, picture)
    ends = {pair: _ends(pairs, pair, enclosure[pair]) for pair in np.flatnonzero(enclosure).tolist()}
    inside = [hole for hole, _ in ends.values()]
    for pair, (hole, around) in ends.items():
        beside = np.concatenate([pairs.low[pairs.high == around], pairs.high[pairs.low == around]])
        # Two birds before a sky are not holes in it: enclosed parts are not beyond.
        beyond = np.setdiff1d(beside, inside)
        differ = np.linalg.norm(lab[beyond] - lab[hole], axis=1)
        if beyond.size and differ.min() < LIKE * np.linalg.norm(lab[around] - lab[hole]):
            holes[pair] = int(beyond[differ.argmin()])
    return holes


def _ends(pairs: Neighbours, pair: int, sign: float) -> tuple[int, int]:
    low, high = int(pairs.low[pair]), int(pairs.high[pair])
    return (high, low) if sign > 0 else (low, high)


def _mean_colours(parts: PartMap, sizes: Int64[np.ndarray, "n"], picture: np.ndarray) -> Float64[np.ndarray, "n 3"]:
    labels = parts.labels
    with plain_opencv():
        small = cv2.resize(to_rgb8(picture), labels.shape[::-1], interpolation=cv2.INTER_AREA)
        lab = cv2.cvtColor(small, cv2.COLOR_RGB2LAB).reshape(-1, 3)
    sums = [np.bincount(labels.reshape(-1), lab[:, channel], parts.count) for channel in range(3)]
    return np.stack(sums, axis=1) / np.maximum(sizes, 1)[:, None]


def _relax(
    own: Float64[np.ndarray, "n"], pairs: Neighbours, nearer: Float64[np.ndarray, "m"]
) -> Float64[np.ndarray, "n"]:
    """Relax the nearness of each part between its own and its neighbours', by the root of their border's length."""
    weight = np.sqrt(pairs.sides.astype(np.float64))
    count = own.size
    whole = np.bincount(pairs.low, weight, count) + np.bincount(pairs.high, weight, count)
    nearness = own
    for _ in range(ROUNDS):
        sums = np.bincount(pairs.low, weight * (nearness[pairs.high] - nearer), count)
        sums += np.bincount(pairs.high, weight * (nearness[pairs.low] + nearer), count)
        nearness = np.where(whole > 0, (OWN * own + sums / np.maximum(whole, 1)) / (OWN + 1), own)
    return nearness


def _overlaps(pairs: Neighbours, sure: Float64[np.ndarray, "m"], count: int) -> list[str]:
    """Describe, for each part, the parts that it hides and that hide it, the most certain first."""
    hides: list[list[int]] = [[] for _ in range(count)]
    behind_parts: list[list[int]] = [[] for _ in range(count)]
    for pair in np.argsort(-np.abs(sure), kind="stable").tolist():
        if abs(sure[pair]) < SURE:
            break
        ends = int(pairs.low[pair]), int(pairs.high[pair])
        behind, front = ends if sure[pair] > 0 else ends[::-1]
        hides[front].append(behind)
        behind_parts[behind].append(front)
    return [_list("it is in front of", a) + _list("it is behind", b) for a, b in zip(hides, behind_parts, strict=True)]


def _list(verb: str, parts: list[int]) -> str:
    """Return words such as `; it is behind parts 1, 2 and 5`; nothing for no part."""
    if len(parts) == 1:
        return f"; {verb} {name_part(parts[0])}"
    *others, last = [str(shown_number(part)) for part in parts[:MAX_NAMED]] or [""]
    return f"; {verb} parts {', '.join(others)} and {last}" if others else ""


def _rank(nearness: Float64[np.ndarray, "n"], sizes: Int64[np.ndarray, "n"]) -> tuple[Int64[np.ndarray, "n"], int]:
    """Return the rank of each part from the back, and the number of ranks; a speck has that of the part behind it."""
    order = np.argsort(nearness, kind="stable")
    large = sizes >= SPECK * sizes.sum()
    takes = large if large.any() else np.ones_like(large)
    rank = np.empty(sizes.size, np.int64)
    rank[order] = np.maximum(np.cumsum(takes[order]) - 1, 0)
    return rank, max(1, int(takes.sum()))


def _coarse(shape: tuple[int, int]) -> tuple[int, int]:
    """Return a reduced shape for the cues: the same for a picture that is enlarged by whole pixels."""
    return reduced_shape(shape, -(-max(shape) // LONGEST_PX))
