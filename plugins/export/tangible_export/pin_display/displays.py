"""Displays of raised pins."""

from typing import Annotated, Literal

from pydantic import Field

from tangible_core.data import Quantities

PITCH_M = 0.0025
"""Distance from pin to pin of the displays below, about. Parts are simplified for pictures of this pitch."""


class Display(Quantities):
    """An array of pins."""

    columns: Annotated[int, Field(ge=3, le=1000)]
    """Pins from left to right."""
    rows: Annotated[int, Field(ge=3, le=1000)]
    """Pins from top to bottom."""
    levels: Annotated[int, Field(ge=1, le=255)] = 1
    """Heights above that of a pin that is down: 1 for pins that are up or down, 4 for heights of 0 to 4."""

    def picture_size(self, aspect: float) -> tuple[int, int]:
        """Return columns and rows of the largest picture with this ratio of width to length."""
        columns = min(self.columns, self.rows * aspect)
        return max(1, round(columns)), max(1, min(self.rows, round(columns / aspect)))


Named = Literal["monarch", "graphiti", "dotpad"]
DISPLAYS: dict[str, Display] = {
    "monarch": Display(columns=96, rows=40),
    "graphiti": Display(columns=60, rows=40, levels=4),
    "dotpad": Display(columns=60, rows=40),
}
"""Displays by name. Sources: pages of the makers, APH and HumanWare (Monarch), Orbit Research (Graphiti), Dot Inc. (Dot
Pad 320)."""
HEXADECIMAL = ("dotpad",)
