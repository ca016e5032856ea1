"""Displays of pins that rise."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from tangible_core.data.quantities import Quantities

PITCH_M = 0.0025
"""From pin to pin: of all displays below, about. Products are made for it, so that parts narrower than a finger go."""


class Display(Quantities):
    """An array of pins."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    columns: Annotated[int, Field(ge=3, le=1000)]
    """Pins from left to right."""
    rows: Annotated[int, Field(ge=3, le=1000)]
    """Pins from top to bottom."""
    levels: Annotated[int, Field(ge=1, le=255)] = 1
    """Heights above that of a pin that is down: 1 for pins that are up or down, 4 for heights of 0 to 4."""

    def fitted(self, aspect: float) -> tuple[int, int]:
        """Columns and rows of a picture of this width through length, as large as there is room for."""
        columns = min(self.columns, self.rows * aspect)
        return max(1, round(columns)), max(1, min(self.rows, round(columns / aspect)))


Named = Literal["monarch", "graphiti", "dotpad"]
DISPLAYS: dict[str, Display] = {
    "monarch": Display(columns=96, rows=40),
    "graphiti": Display(columns=60, rows=40, levels=4),
    "dotpad": Display(columns=60, rows=40),
}
"""Sources: the makers' pages: APH and HumanWare of Monarch, Orbit Research of Graphiti, Dot Inc. of Dot Pad 320."""
HEXADECIMAL = ("dotpad",)
"""Those whose maker takes pins as hexadecimal digits."""
