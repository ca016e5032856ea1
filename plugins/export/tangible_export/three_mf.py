"""A solid as 3MF, which says its unit and its title."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import IO, TYPE_CHECKING, ClassVar
from xml.sax.saxutils import escape, quoteattr
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from tangible_core.data import Work
from tangible_core.plugins.interfaces import Exporter, Medium

from .solid import exporter as said

if TYPE_CHECKING:
    from .solid.closed import Solid


class ThreeMF(Exporter):
    """A closed solid to print, as 3MF: as `stl`, in a third of its bytes, with its unit and its title.

    Source: 3D Manufacturing Format, Core Specification 1.3, 3MF Consortium.
    """

    needs: ClassVar[tuple[str, ...]] = ("relief",)
    medium: ClassVar[Medium | None] = "print"

    longer_side_m: said.LongerSide = 0.16
    error_m: said.Error = 5e-5
    base_m: said.Base = 0.0015
    rim_m: said.Rim = 0.006
    corner_mark: said.CornerMark = True
    braille: said.Braille = True
    braille_language: said.BrailleLanguage = None

    def picture_width_m(self, aspect: float) -> float:
        """Of the picture, whose longer side is `longer_side_m`."""
        return said.width_of(self.longer_side_m, aspect)

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """One file, `stem.3mf`.

        Raises: GeometryError for a relief of no height, BrailleError or OutputError for a title that cannot be written.
        """
        from .solid.making import made_solid

        solid, _ = made_solid(self, work)
        path = stem.with_name(f"{stem.name}.3mf")
        with path.open("wb") as file:
            write_3mf(file, solid, work.title, work.language)
        return (path,)


_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_MODEL = "3D/3dmodel.model"
_PARTS = {
    "[Content_Types].xml": (
        f'{_XML}<Types xmlns="{_PACKAGE}/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
    ),
    "_rels/.rels": (
        f'{_XML}<Relationships xmlns="{_PACKAGE}/relationships"><Relationship Id="rel0" Target="/{_MODEL}" '
        'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    ),
}
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_LANGUAGE = re.compile("[A-Za-z]{1,8}(-[A-Za-z0-9]{1,8})*")
ROWS_AT_ONCE = 65_536


def write_3mf(file: IO[bytes], solid: "Solid", title: str, language: str) -> None:
    """Write the package: the same bytes for the same solid, as its parts bear no date."""
    with ZipFile(file, "w", ZIP_DEFLATED) as package:
        for name, text in _PARTS.items():
            package.writestr(_part(name), text)
        with package.open(_part(_MODEL), "w", force_zip64=True) as model:
            for text in _model(solid, title, language):
                model.write(text.encode())


def _part(name: str) -> ZipInfo:
    part = ZipInfo(name)
    part.compress_type = ZIP_DEFLATED
    return part


def _model(solid: "Solid", title: str, language: str) -> Iterator[str]:
    title = _NO_XML.sub("", title).strip() or "tangible-images"
    spoken = f' xml:lang="{language}"' if _LANGUAGE.fullmatch(language) else ""
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    yield f'{_XML}<model unit="millimeter"{spoken} xmlns="{core}">'
    yield f'<metadata name="Title">{escape(title)}</metadata><metadata name="Application">tangible-images</metadata>'
    yield f'<resources><object id="1" type="model" name={quoteattr(title)}><mesh>\n<vertices>\n'
    yield from _rows('<vertex x="%.5f" y="%.5f" z="%.5f"/>\n', solid.vertices_mm)
    yield "</vertices>\n<triangles>\n"
    yield from _rows('<triangle v1="%d" v2="%d" v3="%d"/>\n', solid.triangles)
    yield '</triangles>\n</mesh></object></resources><build><item objectid="1"/></build></model>\n'


def _rows(template: str, values: np.ndarray) -> Iterator[str]:
    for first in range(0, len(values), ROWS_AT_ONCE):
        some = values[first : first + ROWS_AT_ONCE]
        yield template * len(some) % tuple(some.ravel().tolist())
