"""What exporters are tried on: small pictures with everything that an exporter may need, and with less."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...data import DisparityMap, HapticSurface, Material, MaterialMap, PartMap, Record, Relief, SegmentMap, Work
from ...data.products import EXPORTABLE
from ...plugins.interfaces import Exporter

ROWS, COLUMNS = 48, 64
NAMES = ("wall", "table", "")
HEIGHTS_M = (0.0, 0.004, 0.002)
WIDE_M = 0.16
"""The width, where the exporter wants none of its own."""
FINE = 4
"""Cells of the simplified parts a cell of the parts."""
FELT = Material("felt", 300.0, 1.5, 0.5, 0.4, source="a guess")
UNUSUAL = {
    "a title in other scripts": "Grüße — 東京 ♞ العربية",
    "a title of markup": "<b>&amp;\"']]> -- %(no)s {x}",
    "a title of one letter": "i",
    "no title": "",
}
LANGUAGES = ("de-AT", "tlh", "zh-Hant-TW")


def plain_work(exporter: Exporter) -> Work:
    """Three parts, two of them named, large enough for fingers: as an exporter is given it."""
    return work_of(exporter, labels=_labels((ROWS, COLUMNS)), picture=_picture((ROWS, COLUMNS)))


def works(exporter: Exporter) -> Iterator[tuple[str, Work]]:
    """What there may be, each with a name: flat, tiny, without parts, without a picture, in words of any script."""
    plain = plain_work(exporter)
    for what, title in UNUSUAL.items():
        yield what, replace(plain, title=title)
    for language in LANGUAGES:
        yield f"the language {language}", replace(plain, language=language)
    yield "names in other scripts", replace(plain, names=("стена", "テーブル", "Ωμέγα <&>"))
    yield "parts without names", replace(plain, names=())
    yield "a flat surface", _flat(exporter, plain)
    yield "a scene without parts", work_of(exporter, picture=_picture((ROWS, COLUMNS)))
    yield "heights without a picture", work_of(exporter)
    yield "a part that was simplified away", _without_last(exporter)
    for shape in ((1, 1), (1, 9), (9, 1), (2, 2)):
        what = f"{shape[0]} x {shape[1]} cells"
        yield what, work_of(exporter, labels=_labels(shape), picture=_picture(shape), shape=shape)


def work_of(
    exporter: Exporter,
    labels: np.ndarray | None = None,
    picture: np.ndarray | None = None,
    shape: tuple[int, int] = (ROWS, COLUMNS),
    simplified: np.ndarray | None = None,
) -> Work:
    """What this exporter is given, and nothing that it does not need. labels: of parts; None for a scene without."""
    width_m = exporter.picture_width_m(shape[1] / shape[0]) or WIDE_M
    made = _products(shape, width_m, labels, simplified)
    names = () if labels is None else NAMES
    products: dict[str, Record | None] = {name: made[name] for name in exporter.needs if name in EXPORTABLE}
    return Work("Still life", "en", products, picture, names)


def _products(
    shape: tuple[int, int], width_m: float, labels: np.ndarray | None, simplified: np.ndarray | None
) -> dict[str, Any]:
    rows, columns = shape
    heights_m = np.linspace(0, 0.003, columns, dtype=np.float32)[None].repeat(rows, 0)
    if labels is not None:
        heights_m = np.array(HEIGHTS_M, np.float32)[labels]
    relief = Relief(heights_m, (width_m, width_m * rows / columns))
    found: dict[str, Any] = dict.fromkeys(EXPORTABLE)
    found |= {"relief": relief, "surface": HapticSurface(relief), "disparity": DisparityMap(heights_m * 1000)}
    if labels is not None:
        parts = PartMap(labels, tuple(range(len(NAMES))))
        fine = labels.repeat(FINE, 0).repeat(FINE, 1) if simplified is None else simplified
        materials = (FELT,) * len(NAMES)
        found |= {
            "segments": SegmentMap(labels),
            "parts": parts,
            "simplified": PartMap(fine, parts.segments),
            "materials": MaterialMap(materials, ("made up",) * len(NAMES)),
            "surface": HapticSurface(relief, labels, materials, NAMES),
        }
    return found


def _flat(exporter: Exporter, plain: Work) -> Work:
    """No height anywhere."""
    products = dict(plain.products)
    relief = Relief(np.zeros((ROWS, COLUMNS), np.float32), plain_relief(exporter).extent_m)
    if isinstance(products.get("relief"), Relief):
        products["relief"] = relief
    if isinstance(surface := products.get("surface"), HapticSurface):
        products["surface"] = replace(surface, relief=relief)
    return replace(plain, products=products)


def plain_relief(exporter: Exporter) -> Relief:
    """The relief of the plain work, whether the exporter needs it or not."""
    width_m = exporter.picture_width_m(COLUMNS / ROWS) or WIDE_M
    return _products((ROWS, COLUMNS), width_m, _labels((ROWS, COLUMNS)), None)["relief"]


def _without_last(exporter: Exporter) -> Work:
    labels = _labels((ROWS, COLUMNS))
    fine = np.where(labels == len(NAMES) - 1, 0, labels).astype(np.int32).repeat(FINE, 0).repeat(FINE, 1)
    return work_of(exporter, labels, _picture((ROWS, COLUMNS)), simplified=fine)


def _labels(shape: tuple[int, int]) -> np.ndarray:
    """A wall, a table in its lower half, and something in its upper left; as many of them as there is room for."""
    rows, columns = shape
    labels = np.zeros(shape, np.int32)
    labels[(rows + 1) // 2 :, : max(1, columns - columns // 4)] = 1
    labels[rows // 8 : rows * 3 // 8, columns // 8 : columns // 2] = 2
    return labels


def _picture(shape: tuple[int, int]) -> np.ndarray:
    """In colour, lighter to the right."""
    rows, columns = shape
    across = np.linspace(20, 235, columns).astype(np.uint8)[None].repeat(rows, 0)
    return np.ascontiguousarray(np.dstack([across, across // 2, 255 - across]))
