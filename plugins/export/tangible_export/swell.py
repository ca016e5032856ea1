"""Pages for swell paper."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, final

import numpy as np
from jaxtyping import UInt8
from pydantic import Field

from tangible_core.data import PartMap, Work
from tangible_core.errors import PictureError
from tangible_core.plugins import Exporter, Medium, Previewing

from .braille import BrailleChoice, in_grade
from .paper.sheet import Page, check_readable, sheet_for

if TYPE_CHECKING:
    from .paper.marks.svg import Drawing

PREVIEW_PER_MM = 3  # enough for dots of braille


@final
class Swell(Exporter, Previewing):
    """A page for swell paper and its key: outlines, fills and braille in black shapes alone, as SVG and as PDF.

    For fingers that read braille: print it on swell paper and heat it. Heights are lost: take `stl` to keep them.

    Sources: Guidelines and Standards for Tactile Graphics, Braille Authority of North America, 2010, for a key of
    letters, outlines that stand clear of fills, and a mark at the upper right corner; sizes have their own sources.
    """

    needs: ClassVar[tuple[str, ...]] = ("simplified",)
    medium: ClassVar[Medium | None] = "swell"
    shows_texts: ClassVar[bool] = True

    page: Page = "a4"
    """Size of the paper; it lies on its side where that makes the picture larger."""
    width_m: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] | None = None
    """Width of the picture; null for the largest that the page allows."""
    braille: BrailleChoice = BrailleChoice()
    """The braille of the title and the key."""

    def picture_width_m(self, aspect: float) -> float:
        """Return the width of the picture on the page."""
        return sheet_for(self.page, aspect, self.width_m).picture_mm[0] / 1000

    def options_for_width(self, width_m: float, aspect: float) -> Mapping[str, Any]:
        """Return a page with room for this width, and the width if one is given; none if no page has room."""
        for page in dict.fromkeys((self.page, "a3")):
            room_m = sheet_for(page, aspect, None).picture_mm[0] / 1000
            if width_m <= room_m:
                paper = {} if page == self.page else {"page": page}
                return paper if self.width_m is None else {**paper, "width_m": width_m}
        return {}

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write the page and each page of the key as an SVG, and all of them as one PDF; the page also in ink.

        The copies in ink, `-ink.svg` and `-ink.pdf`, have the same marks in grey, and in black the texts of the
        braille, the names of the parts and a scale bar.

        Raises: PictureError where there are no parts, or a page could not be read; GeometryError where it has no room;
        BrailleError for a title or a name that has no braille.
        """
        pages = self._pages(work)
        from .paper.lettering import words
        from .paper.marks.ink import ink_svg, write_ink_pdf
        from .paper.marks.reading import read
        from .paper.marks.rendering import write_pdf
        from .paper.marks.svg import svg

        texts, note = [svg(page) for page in pages], words(work.language).ink
        files = {f"{stem.name}-swell{'-key' * (n > 0)}{f'-{n}' * (n > 1)}.svg": text for n, text in enumerate(texts)}
        pdf, ink, ink_pdf = (
            stem.with_name(f"{stem.name}-swell{ending}") for ending in (".pdf", "-ink.svg", "-ink.pdf")
        )
        paths = [*map(stem.with_name, files), ink]
        for path, text in zip(paths, [*texts, ink_svg(pages[0], note, named=True)], strict=True):
            path.write_text(text, encoding="utf-8", newline="\n")
        write_pdf(pdf, [read(text) for text in texts])
        write_ink_pdf(ink_pdf, pages, note)
        return (*paths[:-1], pdf, ink, ink_pdf)

    def preview(self, work: Work) -> UInt8[np.ndarray, "h w"]:
        """Return the page of the picture. Raises: as `write`."""
        pages = self._pages(work)
        from .paper.marks.reading import read
        from .paper.marks.rendering import black
        from .paper.marks.svg import svg

        ink = black(read(svg(pages[0])), PREVIEW_PER_MM)
        return np.where(ink, 0, 255).astype(np.uint8)

    def _pages(self, work: Work) -> "list[Drawing]":
        from .paper.opening import open_parts
        from .paper.page import drawn_lines, drawn_pages

        work = replace(work, language=in_grade(work.language, self.braille.grade))
        if work.kind == "text":
            raise PictureError(
                "this is a page of text, which fingers cannot read as a picture; write it in braille, or give "
                "`scene: {kind: drawing}` if it is another picture"
            )
        if work.kind == "lines" and not any(work.names) and work.picture is not None:
            sheet = sheet_for(self.page, work.picture.shape[1] / work.picture.shape[0], self.width_m)
            check_readable(self.page, sheet)
            return drawn_lines(work, work.picture, sheet, self.page)
        if (parts := work.simplified) is None:
            raise PictureError("this scene has no parts to outline; it needs a picture, or its own `parts:`")
        sheet = sheet_for(self.page, _aspect(work, parts), self.width_m)
        check_readable(self.page, sheet)
        return drawn_pages(work, open_parts(work, parts, sheet.picture_mm[0] / 1000), sheet, self.page)


def _aspect(work: Work, parts: PartMap) -> float:
    rows, columns = parts.labels.shape if work.picture is None else work.picture.shape[:2]
    return columns / rows
