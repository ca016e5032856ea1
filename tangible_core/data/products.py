"""The table of the pipeline's products: whatever lists products reads it here."""

from collections.abc import Mapping
from typing import Literal, NamedTuple

from .parts import PartMap
from .records import Record
from .surface import HapticSurface, MaterialMap, Relief
from .views import DisparityMap, SegmentMap

Product = Literal["disparity", "relief", "segments", "parts", "simplified", "materials", "surface", "touch"]


class ProductRow(NamedTuple):
    """The facts about a product that do not depend on a scene; `pipeline/engine/stages/` has how it is made."""

    record: type[Record] | None
    """The record's class; None for a product that is not a record, and is neither cached nor exported."""
    panel: str = ""
    """The product of the sheet's panel that draws such a record; "" for a record without a picture of its own."""
    in_report: bool = False
    """True if a run that needs the product keeps it and shows it on its sheet."""


PRODUCTS: Mapping[Product, ProductRow] = {
    "disparity": ProductRow(DisparityMap, "disparity", in_report=True),
    "relief": ProductRow(Relief, "relief"),
    "segments": ProductRow(SegmentMap, "segments", in_report=True),
    "parts": ProductRow(PartMap, "parts", in_report=True),
    "simplified": ProductRow(PartMap, "parts"),
    "materials": ProductRow(MaterialMap, in_report=True),
    "surface": ProductRow(HapticSurface, "relief", in_report=True),
    "touch": ProductRow(None),
}
"""Every product, in the order in which a picture becomes a force."""
EXPORTABLE = tuple(name for name, row in PRODUCTS.items() if row.record is not None)
"""The products that an exporter may need: all that are records."""
IN_REPORT = tuple(name for name, row in PRODUCTS.items() if row.in_report)
"""The products that a run keeps and shows on its sheet, besides the requested one."""
