"""The marks of a page, read from the text of its SVG, independently of the code that drew it."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
from matplotlib.path import Path as Shape

from tangible_core.errors import BrokenMethod

_STEP = re.compile(r"([MLZ])\s*(?:(-?[\d.]+)\s+(-?[\d.]+))?")
_WRITTEN = re.compile(rf"(?:\s*{_STEP.pattern})*\s*")


@dataclass(frozen=True, eq=False)
class Mark:
    """A black shape: a disc, a line or an area."""

    what: str  # role: outline, fill, braille or corner
    label: str
    group: int  # number of the element that has the mark; the dots of one text have one group
    shape: Shape
    stroke_mm: float  # width of the line; 0 for a filled shape

    @property
    def place_mm(self) -> tuple[float, float]:
        """A place that is black: the middle of a disc, or the middle corner of a line."""
        at = np.asarray(self.shape.vertices, np.float64)
        at = at.mean(axis=0) if self.stroke_mm == 0 else at[len(at) // 2]
        return float(at[0]), float(at[1])


@dataclass(frozen=True, eq=False)
class Marks:
    """All marks of a page, in the order in which they are drawn."""

    size_mm: tuple[float, float]
    title: str
    marks: tuple[Mark, ...]


def read(text: str) -> Marks:
    """Read the marks of an SVG. Raises: BrokenMethod for elements other than plain shapes, such as a pattern."""
    root = ElementTree.fromstring(text)
    size = _length(root.get("width")), _length(root.get("height"))
    if root.get("viewBox") != f"0 0 {size[0]:g} {size[1]:g}":
        raise BrokenMethod(f"the view box of a page is its size in millimetres, not {root.get('viewBox')}")
    marks = tuple(_marks(root, "", "", [0]))
    return Marks(size, root.findtext("{*}title") or "", marks)


def _marks(element: ElementTree.Element, what: str, label: str, groups: list[int]) -> Iterator[Mark]:
    for child in element:
        kind = child.tag.rpartition("}")[2]
        if "data-mark" in child.attrib:
            groups[0] += 1
        inner, name = child.get("data-mark", what), child.get("aria-label", label)
        if kind == "g":
            yield from _marks(child, inner, name, groups)
        elif kind in ("circle", "path"):
            width = _number(child, "stroke-width") if child.get("stroke") else 0
            for shape in [_disc(child)] if kind == "circle" else _shapes(child.get("d", "")):
                yield Mark(inner, name, groups[0], shape, width)
        elif kind not in ("title", "desc"):
            raise BrokenMethod(f"a page for swell paper has no element {kind}")


def _disc(element: ElementTree.Element) -> Shape:
    return Shape.circle((_number(element, "cx"), _number(element, "cy")), _number(element, "r"))


def _shapes(text: str) -> Iterator[Shape]:
    if not _WRITTEN.fullmatch(text):
        raise BrokenMethod(f"a path of a page has corners alone, M, L and Z, not {text[:40]}")
    for piece in re.findall(r"M[^M]*", text):
        steps = _STEP.findall(piece)
        at = np.array([(float(x), float(y)) for step, x, y in steps if step != "Z"])
        is_closed = steps[-1][0] == "Z"
        at = np.concatenate([at, at[:1]]) if is_closed else at
        codes = [Shape.MOVETO] + [Shape.LINETO] * (len(at) - 1 - is_closed) + [Shape.CLOSEPOLY] * is_closed
        yield Shape(at, codes)


def _number(element: ElementTree.Element, name: str) -> float:
    return float(element.get(name, "nan"))


def _length(text: str | None) -> float:
    if not text or not text.endswith("mm"):
        raise BrokenMethod(f"the size of a page is in millimetres, not {text}")
    return float(text.removesuffix("mm"))
