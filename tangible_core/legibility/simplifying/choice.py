"""What `simplify:` may say."""

from typing import Annotated

from pydantic import Field

from ...scene.workspace import Section


class SimplifyChoice(Section):
    """Parts made so large and so far apart that fingers can read them, before anything is made of them."""

    gap_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0032
    """Where a part is narrower than this, that place goes to the parts beside it."""
    part_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0064
    """Diameter of a disc that each part must hold; a part that holds none goes to the parts beside it."""
    textures: Annotated[int, Field(ge=1, le=100)] = 5
    """Most textures that a finger is to tell apart; beyond these, the most alike become one. Parts that have a name
    stay parts of their own."""
