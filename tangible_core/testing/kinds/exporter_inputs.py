"""Inputs that exporters are tested with: small scenes with every product, and with fewer."""

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
WIDE_M = 0.16  # width of the picture if the exporter sets none, in metres
FINE = 4  # cells of the simplified parts per cell of the parts, along each axis
FELT = Material("felt", 300.0, 1.5, 0.5, 0.4, source="a guess")
UNUSUAL = {
    "a title in other scripts": "Grüße — 東京 ♞ العربية",
    "a title of markup": "<b>&amp;\"']]> -- %(no)s {x}",
    "a title of one letter": "i",
    "no title": "",
}
LANGUAGES = ("de-AT", "tlh", "zh-Hant-TW")


def plain_work(exporter: Exporter) -> Work:
    """Return a scene of three parts, two of them named, large enough for fingers."""
    return make_work(exporter, labels=_labels((ROWS, COLUMNS)), picture=_picture((ROWS, COLUMNS)))


def works(exporter: Exporter) -> Iterator[tuple[str, Work]]:
    """Yield named works that may occur: flat, tiny, without parts, without a picture, with words of any script."""
    plain = plain_work(exporter)
    for name, title in UNUSUAL.items():
        yield name, replace(plain, title=title)
    for language in LANGUAGES:
        yield f"the language {language}", replace(plain, language=language)
    yield "names in other scripts", replace(plain, names=("стена", "テーブル", "Ωμέγα <&>"))
    yield "parts without names", replace(plain, names=())
    yield "a flat surface", _flat(exporter, plain)
    yield "a scene without parts", make_work(exporter, picture=_picture((ROWS, COLUMNS)))
    yield "heights without a picture", make_work(exporter)
    labels = _labels((ROWS, COLUMNS))
    fine = np.where(labels == len(NAMES) - 1, 0, labels).astype(np.int32).repeat(FINE, 0).repeat(FINE, 1)
    yield "a part that was simplified away", make_work(exporter, labels, _picture((ROWS, COLUMNS)), fine_labels=fine)
    for shape in ((1, 1), (1, 9), (9, 1), (2, 2)):
        name = f"{shape[0]} x {shape[1]} cells"
        yield name, make_work(exporter, labels=_labels(shape), picture=_picture(shape), shape=shape)


def make_work(
    exporter: Exporter,
    labels: np.ndarray | None = None,
    picture: np.ndarray | None = None,
    shape: tuple[int, int] = (ROWS, COLUMNS),
    fine_labels: np.ndarray | None = None,
) -> Work:
    """Return a work with the products that this exporter needs, and no other. labels: of the parts, or None."""
    width_m = exporter.picture_width_m(shape[1] / shape[0]) or WIDE_M
    available = _products(shape, width_m, labels, fine_labels)
    names = () if labels is None else NAMES
    products: dict[str, Record | None] = {name: available[name] for name in exporter.needs if name in EXPORTABLE}
    return Work("Still life", "en", products, picture, names)


def _products(
    shape: tuple[int, int], width_m: float, labels: np.ndarray | None, fine_labels: np.ndarray | None
) -> dict[str, Any]:
    rows, columns = shape
    heights_m = np.linspace(0, 0.003, columns, dtype=np.float32)[None].repeat(rows, 0)
    if labels is not None:
        heights_m = np.array(HEIGHTS_M, np.float32)[labels]
    relief = Relief(heights_m, (width_m, width_m * rows / columns))
    products: dict[str, Any] = dict.fromkeys(EXPORTABLE)
    products |= {"relief": relief, "surface": HapticSurface(relief), "disparity": DisparityMap(heights_m * 1000)}
    if labels is not None:
        parts = PartMap(labels, tuple(range(len(NAMES))))
        fine = labels.repeat(FINE, 0).repeat(FINE, 1) if fine_labels is None else fine_labels
        materials = (FELT,) * len(NAMES)
        products |= {
            "segments": SegmentMap(labels),
            "parts": parts,
            "simplified": PartMap(fine, parts.segments),
            "materials": MaterialMap(materials, ("made up",) * len(NAMES)),
            "surface": HapticSurface(relief, labels, materials, NAMES),
        }
    return products


def _flat(exporter: Exporter, plain: Work) -> Work:
    products = dict(plain.products)
    width_m = exporter.picture_width_m(COLUMNS / ROWS) or WIDE_M
    relief = Relief(np.zeros((ROWS, COLUMNS), np.float32), (width_m, width_m * ROWS / COLUMNS))
    if isinstance(products.get("relief"), Relief):
        products["relief"] = relief
    if isinstance(surface := products.get("surface"), HapticSurface):
        products["surface"] = replace(surface, relief=relief)
    return replace(plain, products=products)


def _labels(shape: tuple[int, int]) -> np.ndarray:
    rows, columns = shape
    labels = np.zeros(shape, np.int32)
    labels[(rows + 1) // 2 :, : max(1, columns - columns // 4)] = 1
    labels[rows // 8 : rows * 3 // 8, columns // 8 : columns // 2] = 2
    return labels


def _picture(shape: tuple[int, int]) -> np.ndarray:
    rows, columns = shape
    across = np.linspace(20, 235, columns).astype(np.uint8)[None].repeat(rows, 0)
    return np.ascontiguousarray(np.dstack([across, across // 2, 255 - across]))
