"""The exporter of descriptions: the surface in words."""

import logging
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Annotated, ClassVar, final

from pydantic import Field

from tangible_core.data import Figure, Work
from tangible_core.files import write_text
from tangible_core.plugins import Exporter, note
from tangible_export.braille import BrailleChoice, as_ascii, in_grade, width_m, wrapped, written_by
from tangible_legibility.words.languages import Language, spoken_language

from .description import PartFacts, describe_at_length, facts, page_of

log = logging.getLogger(__name__)

RUNOVER_CELLS = 2  # the indentation of the further lines of a paragraph in braille, cells


@final
class Text(Exporter):
    """A description of the surface in words: plain text, an accessible page of HTML and, on request, braille.

    The description has the size and heights of the whole surface and then of each part, from near to far. The parts
    are those of the surface if one of them has a name; otherwise, the parts that fingers can read. Next to a page for
    swell paper or a solid in the same export, it has the parts and the size of that, and the heights of the solid.
    """

    needs: ClassVar[tuple[str, ...]] = ("surface", "simplified", "materials")
    describes: ClassVar[bool] = True

    language: Language | None = None
    """Language of the description; null for that of the pipeline, or English if the description does not exist in it.
    Names stay as they are."""
    materials: bool = True
    """Name the material of each part; false for paper and prints, which have no materials."""
    width_m: Annotated[float, Field(ge=0.001, le=10, allow_inf_nan=False)] | None = None
    """Width of the whole picture in the description; null for that of the solid, else of the page for swell paper, in
    the same export, and for that of the workspace without these."""
    braille: bool | BrailleChoice = False
    """Write NAME.brf too: uncontracted braille in the characters that embossers accept; `{grade: 2}` contracts it."""
    cells: Annotated[int, Field(ge=10, le=200)] = 40
    """Cells in a line of braille."""
    lines: Annotated[int, Field(ge=5, le=200)] = 25
    """Lines on a page of braille."""

    def picture_width_m(self, aspect: float) -> float | None:
        """Return the option `width_m`."""
        return self.width_m

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write the files. Raises: BrailleError for a name that has no braille, if braille is requested."""
        language = self.language or spoken_language(work.language, log)
        parts, kind = self._parts(work), None if work.picture is not None else "heights"
        surface = work.surface if self.materials else replace(work.surface, materials=None)
        figure: Figure | None = work.extras.get("figure")
        content = surface, work.title, language, parts, kind, 0 if figure is None else figure.people
        lines = describe_at_length(*content)
        texts = {".txt": "".join(f"{line}\n" for line in lines), ".html": page_of(*content, named_in=work.language)}
        if self.braille:
            in_braille = in_grade(language, BrailleChoice.in_force(self.braille).grade)
            note(log, f"braille by {written_by(in_braille)}")
            texts[".brf"] = self._emboss(lines, in_braille)
        for suffix, text in texts.items():
            write_text(stem.with_suffix(suffix), text)
        return tuple(map(stem.with_suffix, texts))

    def _parts(self, work: Work) -> tuple[PartFacts, ...]:
        """Return the parts of the surface if one has a name; otherwise, the parts that fingers can read."""
        surface, simpler = work.surface, work.simplified
        if any(surface.names or ()):
            parts = facts(surface, work.materials, texts=work.texts)
        elif simpler is None:
            return ()
        else:
            note(log, "no part has a name, so parts are described by number; `tangible parts` shows them for naming")
            parts = facts(surface, work.materials, simpler, work.names, work.texts)
        return parts if self.materials else tuple(part._replace(material="") for part in parts)

    def _emboss(self, lines: Sequence[str], language: str) -> str:
        """Return lines and pages of braille for embossers, in plain ASCII."""
        line_m = width_m((0,) * self.cells)
        cells = chain.from_iterable(wrapped(line, language, line_m, RUNOVER_CELLS) or [()] for line in lines)
        rows = [f"{as_ascii(line).rstrip()}\r\n" for line in cells]
        return "\f".join("".join(rows[at : at + self.lines]) for at in range(0, len(rows), self.lines))
