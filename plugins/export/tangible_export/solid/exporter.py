"""What a solid may be asked for, in whatever format it is written."""

from typing import Annotated, Protocol

from pydantic import Field

LongerSide = Annotated[
    float,
    Field(
        ge=0.01,
        le=1,
        allow_inf_nan=False,
        description="The longer side of the picture on the plate, without the rim: with 0.16, the plate fits on the "
        "bed of most printers, and one hand spans the picture.",
    ),
]
Error = Annotated[
    float,
    Field(
        ge=5e-6,
        le=0.005,
        allow_inf_nan=False,
        description="How far the solid may be from any height of the relief; a printer's layers of 0.15 mm alone are "
        "off by as much as the default.",
    ),
]
Base = Annotated[
    float,
    Field(
        ge=0.0002,
        le=0.1,
        allow_inf_nan=False,
        description="Thickness of the plate below the lowest point of the picture.",
    ),
]
Rim = Annotated[
    float,
    Field(
        ge=0,
        le=0.1,
        allow_inf_nan=False,
        description="Width of the flat rim around the picture; 0 for none. The title and the corner mark need 4 mm.",
    ),
]
CornerMark = Annotated[
    bool,
    Field(description="A raised triangle on the rim, at the upper right: fingers find which way up the plate lies."),
]
Braille = Annotated[bool, Field(description="The title in braille, on the rim below the picture.")]
BrailleLanguage = Annotated[
    str | None,
    Field(min_length=1, max_length=35, description="Language of the braille, such as de; null for the title's own."),
]


class SolidOptions(Protocol):
    """An exporter of solids, as the rooms below it see it."""

    @property
    def error_m(self) -> float:
        """See `Error`."""
        ...

    @property
    def base_m(self) -> float:
        """See `Base`."""
        ...

    @property
    def rim_m(self) -> float:
        """See `Rim`."""
        ...

    @property
    def corner_mark(self) -> bool:
        """See `CornerMark`."""
        ...

    @property
    def braille(self) -> bool:
        """See `Braille`."""
        ...

    @property
    def braille_language(self) -> str | None:
        """See `BrailleLanguage`."""
        ...


def width_of(longer_side_m: float, aspect: float) -> float:
    """Width of a picture whose width through length is `aspect`.

    >>> width_of(0.16, 2.0), width_of(0.16, 0.5)
    (0.16, 0.08)
    """
    return longer_side_m * min(1.0, aspect)
