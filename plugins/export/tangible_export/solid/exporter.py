"""The options and the writing that all formats of solids share."""

from abc import abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from jaxtyping import UInt8
from pydantic import Field

from tangible_core.data import Work
from tangible_core.plugins import Exporter, Medium, Previewing
from tangible_core.preflight import over

from ..braille import BrailleChoice

if TYPE_CHECKING:
    from .closed import Solid
    from .plate import Layout


class SolidExporter(Exporter, Previewing):
    """An exporter of the relief as a closed solid, in one file; each format has its own `write_solid`."""

    needs: ClassVar[tuple[str, ...]] = ("relief",)
    medium: ClassVar[Medium | None] = "print"
    limits_slopes: ClassVar[bool] = False
    ending: ClassVar[str]
    """Ending of the file, without the dot."""

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
    braille: bool | BrailleChoice = True
    """Write the title in braille, on the rim below the picture; `{grade: 2}` contracts it."""
    braille_language: Annotated[str, Field(min_length=1, max_length=35)] | None = None
    """Language of the braille, such as de; null for the title's own."""

    def picture_width_m(self, aspect: float) -> float:
        """Return the width of the picture, whose longer side is `longer_side_m`."""
        return self.longer_side_m * min(1.0, aspect)

    def options_for_width(self, width_m: float, aspect: float) -> Mapping[str, Any]:
        """Return the longer side with which the picture is this wide; none beyond a metre."""
        longer_m = width_m / min(1.0, aspect)
        return {"longer_side_m": float(over(longer_m))} if longer_m <= 1 else {}

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write one file: `stem` with the format's ending.

        Raises: GeometryError for a flat relief, BrailleError or OutputError for a title that cannot be written.
        """
        solid, layout = self._make(work)
        path = stem.with_name(f"{stem.name}.{self.ending}")
        with path.open("wb") as file:
            self.write_solid(file, solid, layout, work)
        return (path,)

    def preview(self, work: Work) -> UInt8[np.ndarray, "h w"]:
        """Return the solid, of coarser triangles, in light from the upper left. Raises: as `write`."""
        from .making import COARSE_M, coarse_work, shaded

        return shaded(self._make(coarse_work(work), COARSE_M)[0])

    def _make(self, work: Work, least_error_m: float = 0.0) -> "tuple[Solid, Layout]":
        from .making import PlateOptions, make_solid

        options = PlateOptions(**{name: getattr(self, name) for name in PlateOptions._fields})
        return make_solid(options._replace(error_m=max(options.error_m, least_error_m)), work)

    @abstractmethod
    def write_solid(self, file: IO[bytes], solid: "Solid", layout: "Layout", work: Work) -> None:
        """Write the solid in this format."""
