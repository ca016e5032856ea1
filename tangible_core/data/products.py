"""The table of the pipeline's products, and the products as an exporter gets them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, cast

import numpy as np

from ..errors import BrokenMethod
from .figure import Figure
from .records import Record
from .surface import HapticSurface, MaterialMap, Relief
from .texts import PictureText
from .views import DisparityMap, PartMap, SegmentMap

Product = Literal["disparity", "figure", "relief", "segments", "parts", "simplified", "materials", "surface", "touch"]


class ProductRow(NamedTuple):
    """The facts about a product that do not depend on a scene; `pipeline/engine/stages/` has how it is made."""

    # The record's class; None for a product that is not a record, and is neither cached nor exported.
    record: type[Record] | None
    # The product of the sheet's panel that draws such a record; "" for a record without a picture of its own.
    panel: str = ""
    in_report: bool = False  # true if a run that needs the product keeps it and shows it on its sheet


PRODUCTS: Mapping[Product, ProductRow] = {
    "disparity": ProductRow(DisparityMap, "disparity", in_report=True),
    "figure": ProductRow(Figure),
    "relief": ProductRow(Relief, "relief"),
    "segments": ProductRow(SegmentMap, "segments", in_report=True),
    "parts": ProductRow(PartMap, "parts", in_report=True),
    "simplified": ProductRow(PartMap, "parts"),
    "materials": ProductRow(MaterialMap, in_report=True),
    "surface": ProductRow(HapticSurface, "relief", in_report=True),
    "touch": ProductRow(None),
}
"""Every product, in the order in which a picture becomes a force."""
# The products that an exporter may need: all that are records.
EXPORTABLE = tuple(name for name, row in PRODUCTS.items() if row.record is not None)
IN_REPORT = tuple(name for name, row in PRODUCTS.items() if row.in_report)
"""The products that a run keeps and shows on its sheet, besides the requested one."""


@dataclass(frozen=True, eq=False)
class Work:
    """The products that an exporter needs, and the title and language of the whole.

    A product is there if the exporter `needs` it, and None where the scene does not need it.
    """

    title: str
    """The title of the pipeline, or else the name of its scene."""
    language: str
    """A language tag, such as `en` or `de-AT`, for the title and the names."""
    products: Mapping[str, Record | None] = field(default_factory=dict[str, Record | None])
    """The records by the product's name."""
    picture: np.ndarray | None = None
    """The left view, as in `Views`; None for a scene of heights alone."""
    names: tuple[str, ...] = ()
    """The names of parts, by number, "" for a part without a name; () if the pipeline has no parts."""
    extras: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Further things that a sheet shows, where they exist: `views`, the `truth` of the disparity (h, w) in px, the
    `recording` of a run, and the `figure` that networks see, where the relief is made of it."""
    kind: str = "photograph"
    """The kind of the picture, as `kind` of a scene: `photograph`, `drawing`, `lines` or `text`."""
    texts: tuple[PictureText, ...] = ()
    """The texts of the picture that are neither the title nor names of parts; "" for what nobody has read."""
    film: bool = False
    """True for a film, of which the products show the first frame."""

    @property
    def relief(self) -> Relief:
        """Heights in metres. Raises: BrokenMethod if the exporter does not need it."""
        return cast(Relief, self._product("relief"))

    @property
    def surface(self) -> HapticSurface:
        """The surface, with names and, if the force law uses them, materials. Raises: BrokenMethod as `relief`."""
        return cast(HapticSurface, self._product("surface"))

    @property
    def parts(self) -> PartMap | None:
        """The connected parts of the picture; None if it has no segments. Raises: BrokenMethod as `relief`."""
        return cast("PartMap | None", self._product("parts"))

    @property
    def simplified(self) -> PartMap | None:
        """The parts in a form that fingers can read, numbered as `parts`. Raises: BrokenMethod as `relief`."""
        return cast("PartMap | None", self._product("simplified"))

    @property
    def materials(self) -> MaterialMap | None:
        """The material of each part or segment. Raises: BrokenMethod as `relief`."""
        return cast("MaterialMap | None", self._product("materials"))

    def _product(self, name: str) -> Record | None:
        if name not in self.products:
            raise BrokenMethod(f"an exporter reads {name}, which it does not name in `needs`; add it there")
        return self.products[name]
