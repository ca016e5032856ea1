"""The type of the option `window_px`: an odd side of a window."""

from typing import Annotated

from pydantic import AfterValidator, Field


def _check_odd(value: int) -> int:
    if value % 2 == 0:
        raise ValueError(f"the side of a window must be odd, not {value}; take {value - 1} or {value + 1}")
    return value


WindowSide = Annotated[int, Field(ge=3, le=19), AfterValidator(_check_odd)]
"""Side of a window, in pixels: odd, 3 to 19, so that the sums of `correlation` fit 32 bits."""
