"""Which methods no other one beats in time and error at once."""

import math
from collections.abc import Sequence


def front(points: Sequence[tuple[float, ...]]) -> list[int]:
    """Indices of the points that none beats: as low in every coordinate, and lower in one; by the first coordinate.

    A point with a NaN is on no front and beats none; of equal points, all are on it.

    >>> front([(1, 9), (2, 5), (3, 6), (4, 1)])
    [0, 1, 3]
    """
    known = [index for index, point in enumerate(points) if not any(map(math.isnan, point))]
    unbeaten = [index for index in known if not any(_beats(points[other], points[index]) for other in known)]
    return sorted(unbeaten, key=lambda index: points[index])


def _beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one != other and all(low <= high for low, high in zip(one, other, strict=True))
