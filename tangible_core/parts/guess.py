"""Heights of parts by where they are and whose their borders are: a guess, for a person to correct."""

import numpy as np
from jaxtyping import Float64, Int64

from ..data import PartMap
from ..scene.scaling import reduced_shape
from .find import part_sizes, reduced_parts
from .heights import PartHeights
from .neighbours import Neighbours, in_front, neighbours

FOOT, MIDDLE, RIM, SIZE, ENCLOSED, FRONT = 0.7, 0.3, 1.5, 0.1, 0.25, 0.5
"""How much nearness each sign is worth: the height of a part's foot and of its middle in the picture, its share of the
upper and the side rims and of the picture, whether another encloses it, whether it hides another. Chosen on three
pictures whose depth is known (`python -m benchmarks parts`)."""
OWN = 0.5
"""The weight of a part's own signs, against those of what it lies beside, which count 1."""
ROUNDS = 40
SURE, MOST_NAMED = 0.3, 3
"""From here on it is said who hides whom, and how many of them."""
LONGEST_PX = 1000
"""Of the grid on which this is seen."""
SPECK = 0.001
"""Of the picture: what is smaller takes no step of its own."""


def guess_heights(parts: PartMap, top_m: float) -> PartHeights:
    """A height for each part by size, place and border ownership: in even steps from 0 to top_m, in their order.

    What stands low in a picture is near, and what fills much of its upper and side rims, or much of all of it, is far.
    Where three parts meet, the one whose border runs straight on hides the two others; a part that another encloses is
    in front of it. Nearness is what suits these signs best: each part is as near as its own signs say and as its
    neighbours' nearness and what is between them says. Nobody knows what is shown: a table may come to lie before what
    stands on it.
    """
    parts = reduced_parts(parts, _coarse(parts.labels.shape))
    sizes = part_sizes(parts)
    foot, middle, rim = _places(parts, sizes)
    own = FOOT * foot + MIDDLE * middle - RIM * rim - SIZE * sizes / parts.labels.size
    beside = neighbours(parts)
    sure = in_front(parts, beside)
    nearness = _settled(own, beside, FRONT * sure + ENCLOSED * _enclosed(beside, parts.count))
    rank, steps = _ranked(nearness, sizes)
    heights_m = top_m * rank / max(1, steps - 1)
    reasons = (
        f"guessed, {at + 1} of {steps} from the back: it reaches down to {100 * low:.0f} % of the picture's height and "
        f"has {100 * edge:.0f} % of its upper and side rims{said}"
        for at, low, edge, said in zip(rank.tolist(), foot, rim, _said(beside, sure, parts.count), strict=True)
    )
    return PartHeights(tuple(heights_m.tolist()), tuple(reasons))


def _places(
    parts: PartMap, sizes: Int64[np.ndarray, "n"]
) -> tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "n"], Float64[np.ndarray, "n"]]:
    """How far down 95 % of a part's pixels are, and their mean, from 0 to 1; its share of the upper and side rims."""
    labels, (rows, columns) = parts.labels, parts.labels.shape
    lines = np.repeat(np.arange(rows, dtype=np.int64), columns)
    lowest = np.sort(labels.reshape(-1).astype(np.int64) * rows + lines) % rows
    foot = (lowest[np.maximum(np.cumsum(sizes) - 1 - sizes // 20, 0)] + 1) / rows
    middle = (np.bincount(labels.reshape(-1), lines, parts.count) / np.maximum(sizes, 1) + 0.5) / rows
    rim = np.concatenate([labels[0], labels[:, 0], labels[:, -1]])
    return foot, middle, np.bincount(rim, minlength=parts.count) / rim.size


def _enclosed(beside: Neighbours, count: int) -> Float64[np.ndarray, "m"]:
    """Of each pair, 1 where `high` has no other neighbour than `low`, -1 for the contrary, 0 for neither or both."""
    many = np.bincount(beside.low, minlength=count) + np.bincount(beside.high, minlength=count)
    return (many[beside.high] == 1).astype(np.float64) - (many[beside.low] == 1)


def _settled(
    own: Float64[np.ndarray, "n"], beside: Neighbours, nearer: Float64[np.ndarray, "m"]
) -> Float64[np.ndarray, "n"]:
    """Nearness of each part, between its own and its neighbours' with how much nearer `high` is of each pair.

    Of two parts with a long common border more is known, by the root of its length.
    """
    weight = np.sqrt(beside.sides.astype(np.float64))
    count = own.size
    whole = np.bincount(beside.low, weight, count) + np.bincount(beside.high, weight, count)
    found = own
    for _ in range(ROUNDS):
        told = np.bincount(beside.low, weight * (found[beside.high] - nearer), count)
        told += np.bincount(beside.high, weight * (found[beside.low] + nearer), count)
        found = np.where(whole > 0, (OWN * own + told / np.maximum(whole, 1)) / (OWN + 1), own)
    return found


def _said(beside: Neighbours, sure: Float64[np.ndarray, "m"], count: int) -> list[str]:
    """For each part, whom it hides and who hides it, most sure first, three at most."""
    hides: list[list[int]] = [[] for _ in range(count)]
    hidden: list[list[int]] = [[] for _ in range(count)]
    for pair in np.argsort(-np.abs(sure), kind="stable").tolist():
        if abs(sure[pair]) < SURE:
            break
        ends = int(beside.low[pair]), int(beside.high[pair])
        behind, front = ends if sure[pair] > 0 else ends[::-1]
        hides[front].append(behind)
        hidden[behind].append(front)
    return [_listed("it is in front of", a) + _listed("it is behind", b) for a, b in zip(hides, hidden, strict=True)]


def _listed(verb: str, parts: list[int]) -> str:
    """Such as `; it is behind parts 1, 2 and 5`; nothing for no part."""
    *others, last = map(str, parts[:MOST_NAMED] or [""])
    if not last:
        return ""
    return f"; {verb} parts {', '.join(others)} and {last}" if others else f"; {verb} part {last}"


def _ranked(nearness: Float64[np.ndarray, "n"], sizes: Int64[np.ndarray, "n"]) -> tuple[Int64[np.ndarray, "n"], int]:
    """The place of each part from the back, and how many places there are: a speck shares its neighbour's."""
    order = np.argsort(nearness, kind="stable")
    large = sizes >= SPECK * sizes.sum()
    takes = large if large.any() else np.ones_like(large)
    rank = np.empty(sizes.size, np.int64)
    rank[order] = np.maximum(np.cumsum(takes[order]) - 1, 0)
    return rank, max(1, int(takes.sum()))


def _coarse(shape: tuple[int, int]) -> tuple[int, int]:
    """A size at which all of this is seen as well: the same for a picture that is enlarged by whole pixels."""
    return reduced_shape(shape, -(-max(shape) // LONGEST_PX))
