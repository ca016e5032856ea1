"""The side of a window round a pixel: odd."""

from typing import Annotated

from pydantic import AfterValidator, Field


def _odd(value: int) -> int:
    if value % 2 == 0:
        raise ValueError(f"the side of a window must be odd, not {value}; take {value - 1} or {value + 1}")
    return value


WindowSide = Annotated[int, Field(ge=3, le=19), AfterValidator(_odd)]
