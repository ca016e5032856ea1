"""A solid as 3MF, a format with a unit and a title."""

import re
from collections.abc import Iterator
from typing import IO, TYPE_CHECKING, ClassVar
from xml.sax.saxutils import escape, quoteattr
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from tangible_core.data import Work

from .solid.exporter import SolidExporter

if TYPE_CHECKING:
    from .solid.closed import Solid
    from .solid.plate import Layout


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
_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_LANGUAGE = re.compile("[A-Za-z]{1,8}(-[A-Za-z0-9]{1,8})*")  # as `xml:lang` takes them
ROWS_AT_ONCE = 65_536  # a solid may have millions


class ThreeMF(SolidExporter):
    """A closed solid to print, as 3MF: the solid of `stl` in a third of the bytes, with its unit and its title.

    Source: 3D Manufacturing Format, Core Specification 1.3, 3MF Consortium.
    """

    ending: ClassVar[str] = "3mf"

    def write_solid(self, file: IO[bytes], solid: "Solid", layout: "Layout", work: Work) -> None:
        """Write the package: the same bytes for the same solid, as its parts have no date."""
        with ZipFile(file, "w", ZIP_DEFLATED) as package:
            for name, text in _PARTS.items():
                package.writestr(_part(name), text)
            with package.open(_part(_MODEL), "w", force_zip64=True) as model:
                for text in _model(solid, work.title, work.language):
                    model.write(text.encode())


def _part(name: str) -> ZipInfo:
    part = ZipInfo(name)
    part.compress_type = ZIP_DEFLATED
    return part


def _model(solid: "Solid", title: str, language: str) -> Iterator[str]:
    title = _NOT_IN_XML.sub("", title).strip() or "tangible-images"
    language_attribute = f' xml:lang="{language}"' if _LANGUAGE.fullmatch(language) else ""
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    yield f'{_XML}<model unit="millimeter"{language_attribute} xmlns="{core}">'
    yield f'<metadata name="Title">{escape(title)}</metadata><metadata name="Application">tangible-images</metadata>'
    yield f'<resources><object id="1" type="model" name={quoteattr(title)}><mesh>\n<vertices>\n'
    yield from _rows('<vertex x="%.5f" y="%.5f" z="%.5f"/>\n', solid.vertices_mm)
    yield "</vertices>\n<triangles>\n"
    yield from _rows('<triangle v1="%d" v2="%d" v3="%d"/>\n', solid.triangles)
    yield '</triangles>\n</mesh></object></resources><build><item objectid="1"/></build></model>\n'


def _rows(template: str, values: np.ndarray) -> Iterator[str]:
    for first in range(0, len(values), ROWS_AT_ONCE):
        rows = values[first : first + ROWS_AT_ONCE]
        yield template * len(rows) % tuple(rows.ravel().tolist())
