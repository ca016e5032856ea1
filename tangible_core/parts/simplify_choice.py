"""The options of `simplify:`."""

from typing import Annotated

from pydantic import Field

from ..scene.workspace import Section


class SimplifyChoice(Section):
    """Parts simplified until fingers can read them, before relief, labels and materials are made of them."""

    gap_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0032
    """Smallest width of a part; a narrower place goes to the neighbouring parts."""
    part_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0064
    """Diameter of the disc that each part must hold; a part that holds none goes to its neighbours."""
    textures: Annotated[int, Field(ge=1, le=100)] = 5
    """Largest number of textures that a finger must tell apart; of more, the most similar become one. Parts with a
    name stay separate."""
