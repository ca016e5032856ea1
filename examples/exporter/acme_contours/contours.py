"""Lines of equal height, for a plotter or a laser."""

import logging
from pathlib import Path
from typing import Annotated, ClassVar
from xml.sax.saxutils import escape

import numpy as np
from pydantic import Field

from tangible_core.errors import GeometryError
from tangible_core.plugins import Exporter, Work, note

log = logging.getLogger(__name__)


class Contours(Exporter):
    """An SVG of lines of equal height, in millimetres, as a plotter draws them and a laser cuts them."""

    needs: ClassVar[tuple[str, ...]] = ("relief",)
    step_m: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.001
    """Height from one line to the next."""
    width_m: Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)] | None = None
    """Width of the drawing; null for that of the workspace."""

    def picture_width_m(self, aspect: float) -> float | None:
        """Return the width at which the relief is made: nothing is scaled here."""
        return self.width_m

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write one file. Raises: GeometryError where there is no line to draw."""
        lines = self._lines(work.relief.height_m, work.relief.pitch_m)
        if not lines:
            raise GeometryError(f"no line is drawn: nothing is {1e3 * self.step_m:g} mm high; make step_m smaller")
        note(log, f"{len(lines)} lines are drawn")
        width_mm, length_mm = (1e3 * side_m for side_m in work.relief.extent_m)
        path = stem.with_suffix(".svg")
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width_mm:.3f}mm" height="{length_mm:.3f}mm" '
            f'viewBox="0 0 {width_mm:.3f} {length_mm:.3f}" fill="none" stroke="black" stroke-width="0.2">'
            f"<title>{escape(work.title)}</title>{''.join(lines)}</svg>\n",
            encoding="utf-8",
        )
        return (path,)

    def _lines(self, height_m: np.ndarray, pitch_m: tuple[float, float]) -> list[str]:
        import cv2  # heavy, so here: listing plugins imports this file

        top_m, found = float(height_m.max()), list[str]()
        for level_m in np.arange(self.step_m, top_m + self.step_m * 1e-6, self.step_m):
            higher = (height_m >= np.float32(level_m)).astype(np.uint8)
            for outline in cv2.findContours(higher, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)[0]:
                places_mm = (outline[:, 0] + 0.5) * np.array(pitch_m) * 1e3  # cells, as in a picture: y runs down
                found.append(f'<path d="M{" ".join(f"{x:.3f},{y:.3f}" for x, y in places_mm)}z"/>')
        return found
