"""What there is to feel, in words."""

import logging
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Annotated, ClassVar, final

from pydantic import Field

from tangible_core.data import Work
from tangible_core.files.writing import write_text
from tangible_core.parts.words.languages import Language, spoken_language
from tangible_core.plugins.interfaces import Exporter
from tangible_core.plugins.notes import note
from tangible_export.braille import Cells, as_ascii, width_m, wrapped, written_by

from .description import PartFacts, describe_at_length, facts, page_of

log = logging.getLogger(__name__)

RUNOVER_CELLS = 2
"""By so much the further lines of a paragraph in braille are indented."""


@final
class Text(Exporter):
    """Words on what there is to feel: plain text, an accessible page of HTML and, where it is asked for, braille.

    They say size and heights of the whole, and then of each part, from near to far. Parts that somebody named are
    described as they are felt; where none is, those that fingers can read.
    """

    needs: ClassVar[tuple[str, ...]] = ("surface", "simplified", "materials")

    language: Language | None = None
    """Of the words; null for that of the pipeline, or English where there are no words in it. Names stay as they
    are."""
    materials: bool = True
    """Whether it says what each part feels like; false beside paper and prints, which have no materials."""
    width_m: Annotated[float, Field(ge=0.001, le=10, allow_inf_nan=False)] | None = None
    """Width of the whole picture as it is described, such as that on a page; null for that of the workspace."""
    braille: bool = False
    """Whether NAME.brf is written too: uncontracted braille in the characters that embossers take."""
    cells: Annotated[int, Field(ge=10, le=200)] = 40
    """Of a line of braille."""
    lines: Annotated[int, Field(ge=5, le=200)] = 25
    """Of a page of braille."""

    def picture_width_m(self, aspect: float) -> float | None:
        """That of `width_m`."""
        return self.width_m

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Raises: BrailleError for a name that has no braille, where braille is asked for."""
        language = self.language or spoken_language(work.language, log)
        parts, kind = self._parts(work), None if work.picture is not None else "heights"
        surface = work.surface if self.materials else replace(work.surface, materials=None)
        told = surface, work.title, language, parts, kind
        lines = describe_at_length(*told)
        written = [
            _write(stem.with_suffix(".txt"), "".join(f"{line}\n" for line in lines)),
            _write(stem.with_suffix(".html"), page_of(*told, named_in=work.language)),
        ]
        if self.braille:
            note(log, f"braille by {written_by(language)}")
            written.append(_write(stem.with_suffix(".brf"), self._embossed(lines, language)))
        return tuple(written)

    def _parts(self, work: Work) -> tuple[PartFacts, ...]:
        """As they are felt if one has a name, for then somebody looked at them; else those that fingers can read."""
        surface, simplified = work.surface, work.simplified
        if any(surface.names or ()):
            found = facts(surface, work.materials)
        elif simplified is None:
            return ()
        else:
            note(log, "no part has a name, so that they go by numbers; `tangible parts` shows them to be named")
            found = facts(surface, work.materials, simplified, work.names)
        return found if self.materials else tuple(each._replace(material="") for each in found)

    def _embossed(self, lines: Sequence[str], language: Language) -> str:
        """Lines and pages as embossers take them, in plain ASCII."""
        line_m = width_m((0,) * self.cells)
        cells = chain.from_iterable(_paragraph(line, language, line_m) for line in lines)
        rows = [f"{as_ascii(line).rstrip()}\r\n" for line in cells]
        return "\f".join("".join(rows[at : at + self.lines]) for at in range(0, len(rows), self.lines))


def _paragraph(line: str, language: Language, line_m: float) -> list[Cells]:
    return wrapped(line, language, line_m, RUNOVER_CELLS) or [()]


def _write(path: Path, text: str) -> Path:
    write_text(path, text)
    return path
