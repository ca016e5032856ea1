"""Sub-pixel position of an optimum between three samples, in steps from the middle one."""

from typing import Any

from tangible_core.compiled.compiling import inner


@inner()
def parabola(before: Any, at: Any, after: Any) -> Any:
    """Return the vertex of the parabola through three equally spaced samples, (a - c) / (2 (a - 2 b + c)).

    Within +-0.5 if `at` is the best of the three, whether best means smallest or largest; 0 if they lie on a line.
    """
    bend = (before - at) + (after - at)
    return (before - after) / (bend + bend) if bend != 0 else bend


@inner()
def equiangular(before: Any, at: Any, after: Any) -> Any:
    """Return the tip of the symmetric V through three equally spaced costs; 0 if they are equal.

    Costs that count differing bits grow linearly round their minimum: the parabola would pull towards whole numbers.
    Within +-0.5 if `at` is the smallest.
    Source: Shimizu & Okutomi, Precise sub-pixel estimation on area-based matching, ICCV 2001.
    """
    rise = max(before, after) - at
    return (before - after) / (rise + rise) if rise != 0 else rise
