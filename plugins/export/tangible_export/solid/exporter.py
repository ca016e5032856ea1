"""The options that all formats of solids share."""

from typing import Annotated, ClassVar

from pydantic import Field

from tangible_core.plugins.interfaces import Exporter, Medium


class SolidExporter(Exporter):
    """An exporter of the relief as a closed solid; each format has its own `write`."""

    needs: ClassVar[tuple[str, ...]] = ("relief",)
    medium: ClassVar[Medium | None] = "print"

    longer_side_m: Annotated[float, Field(ge=0.01, le=1, allow_inf_nan=False)] = 0.16
    """Longer side of the picture on the plate, without the rim: with 0.16, the plate fits on the bed of most printers,
    and one hand spans the picture."""
    error_m: Annotated[float, Field(ge=5e-6, le=0.005, allow_inf_nan=False)] = 5e-5
    """Largest distance of the solid from any height of the relief; the default is as much as a printer's layers of
    0.15 mm are off by themselves."""
    base_m: Annotated[float, Field(ge=0.0002, le=0.1, allow_inf_nan=False)] = 0.0015
    """Thickness of the plate below the lowest point of the picture."""
    rim_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.006
    """Width of the flat rim around the picture; 0 for none. The title and the corner mark need 4 mm."""
    corner_mark: bool = True
    """Add a raised triangle to the rim, at the upper right: fingers find which way up the plate lies."""
    braille: bool = True
    """Write the title in braille, on the rim below the picture."""
    braille_language: Annotated[str, Field(min_length=1, max_length=35)] | None = None
    """Language of the braille, such as de; null for the title's own."""

    def picture_width_m(self, aspect: float) -> float:
        """Return the width of the picture, whose longer side is `longer_side_m`."""
        return self.longer_side_m * min(1.0, aspect)
