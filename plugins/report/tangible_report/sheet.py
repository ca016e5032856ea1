"""The exporter of sheets: a run on one page of pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, final

from tangible_core.data import Record, Work
from tangible_core.plugins import Drawing, Exporter

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@final
class Sheet(Exporter, Drawing):
    """A page of pictures: the views, the products made from them and, for a run, the recorded forces."""

    needs: ClassVar[tuple[str, ...]] = ("disparity", "segments", "materials", "surface")

    format: Literal["png", "svg", "pdf"] = "png"
    """The file format; svg and pdf can be enlarged."""

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write the sheet. Raises: OutputError where there is nothing to draw, or the place cannot be written."""
        path = stem.with_suffix(f".{self.format}")
        self.draw(work, path)
        return (path,)

    def draw(self, work: Work, path: Path) -> str:
        """Draw the sheet into a file, and return a description of it. Raises: OutputError, PictureError for sizes."""
        from .drawing.sheet import draw_sheet

        return draw_sheet(path, title=work.title, language=work.language, **work.products, **work.extras)

    def show(self, product: Record, axes: Axes | None = None, **others: Any) -> Axes:
        """Draw one product as its panel on the sheet. Raises: OutputError for a product without a picture."""
        from .drawing.sheet import show

        return show(product, axes, **others)
