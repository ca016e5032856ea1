"""Heights in millimetres, for programs that work on height maps; this program reads them back without loss."""

import json
import logging
from io import BytesIO
from pathlib import Path
from typing import Annotated, ClassVar, final

import numpy as np
from pydantic import Field

from tangible_core.data import Relief, Work
from tangible_core.files import atomic_write, write_text
from tangible_core.plugins import Exporter, note
from tangible_core.scene.formats import MM, HeightsMetadata, levels

log: logging.Logger = logging.getLogger(__name__)

FINE_MM = 2e-4  # keeps rounding to 16 bits below a tenth of a micrometre


@final
class Heights(Exporter):
    """Heights: a PNG of 16 bits with a JSON of millimetres, and a TIFF of floating-point millimetres.

    `scene: {height: NAME-heights.json}` reads them back within 0.1 um, at their own width and height. So do the
    picture files alone, the PNG with the precision of 65,535 steps.
    """

    needs: ClassVar[tuple[str, ...]] = ("relief",)

    width_m: Annotated[float, Field(ge=0.001, le=10, allow_inf_nan=False)] | None = None
    """Width of the whole map; null for the width of the workspace."""

    def picture_width_m(self, aspect: float) -> float | None:
        """Return `width_m`."""
        return self.width_m

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write the three files; the JSON is first in the list, as it is the one to read back."""
        from PIL import Image

        png, tiff, text = (stem.with_name(f"{stem.name}-heights.{end}") for end in ("png", "tif", "json"))
        numbers, low_mm, step_mm = levels(work.relief)
        description = _describe(work, png.name).model_copy(
            update={"exact": tiff.name, "low_mm": low_mm, "step_mm": step_mm}
        )
        if step_mm > FINE_MM:
            note(
                log,
                f"{png.name} holds heights in steps of {1e3 * step_mm:.2g} um, as 16 bits have no finer ones for "
                f"{description.high_mm - low_mm:.3g} mm; {tiff.name} holds them exactly",
            )
        with atomic_write(png) as file:
            Image.fromarray(numbers).save(file, "PNG")
        _write_tiff(tiff, work.relief, _describe(work, tiff.name))
        write_text(text, description.model_dump_json(indent=2) + "\n")
        return text, png, tiff


def _describe(work: Work, file: str) -> HeightsMetadata:
    (rows, columns), (width_m, length_m) = work.relief.height_m.shape, work.relief.extent_m
    return HeightsMetadata(
        title=work.title, language=work.language, file=file, columns=columns, rows=rows,
        width_mm=width_m * MM, length_mm=length_m * MM,
        high_mm=float(work.relief.height_m.max()) * MM, low_mm=0, step_mm=1,
    )  # fmt: skip


def _write_tiff(path: Path, relief: Relief, description: HeightsMetadata) -> None:
    from PIL import Image

    text = json.dumps(description.model_dump(), ensure_ascii=True)  # a tag of plain letters
    heights_mm = (relief.height_m.astype(np.float64) * MM).astype(np.float32)
    buffer = BytesIO()  # the library would not say why it cannot write a file
    Image.fromarray(heights_mm).save(buffer, "TIFF", compression="tiff_adobe_deflate", description=text)
    with atomic_write(path) as file:
        file.write(buffer.getbuffer())
