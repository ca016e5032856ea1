"""Pins as an SVG for the IMAGE services of McGill University: what is not transparent rises.

Their Monarch app reads the alpha of the drawing at one pixel a pin, and shows layer by layer, each by its label. So the
view box is the array of pins, a pin is a square of it, and there is no ground.
"""

import base64
import json
from collections.abc import Mapping
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from jaxtyping import Bool, Int32, UInt8

Pins = UInt8[np.ndarray, "r c"]


def svg(pins: Pins, levels: int, parts: Int32[np.ndarray, "r c"], labels: Mapping[int, str], title: str) -> str:
    """A layer for each part: its pins that are up, and those of its borders.

    parts: the part of each pin, -1 beside the picture. labels: what parts are called, in the order of the layers.
    """
    rows, columns = pins.shape
    layers = [_layer(f"layer-{n}", label, _shapes(pins, levels, _of(parts, part))) for n, (part, label) in
              enumerate(labels.items(), 1)]  # fmt: skip
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{columns}" height="{rows}" '
            f'viewBox="0 0 {columns} {rows}">',
            f"<title>{escape(title)}</title>",
            *layers,
            "</svg>\n",
        ]
    )


def graphic(text: str) -> str:
    """What their renderer takes: JSON with the SVG as a data URL."""
    data = base64.b64encode(text.encode()).decode()
    return json.dumps({"graphic": f"data:image/svg+xml;base64,{data}"}) + "\n"


def _of(parts: Int32[np.ndarray, "r c"], part: int) -> Bool[np.ndarray, "r c"]:
    """The pins of a part, and those to its left and above it, on which its borders lie."""
    there = parts == part
    found = there.copy()
    found[:, :-1] |= there[:, 1:] & (parts[:, :-1] >= 0)
    found[:-1] |= there[1:] & (parts[:-1] >= 0)
    return found


def _layer(name: str, label: str, shapes: list[str]) -> str:
    said = quoteattr(label)
    return "\n".join([f'<g data-image-layer="{name}" aria-label={said}>', *shapes, "</g>"])


def _shapes(pins: Pins, levels: int, there: Bool[np.ndarray, "r c"]) -> list[str]:
    """A path for each height: the higher, the more opaque."""
    found = [(level, _path(there & (pins == level))) for level in range(1, levels + 1)]
    return [
        f'<path shape-rendering="crispEdges"{_opacity(level, levels)} d="{path}"/>' for level, path in found if path
    ]


def _opacity(level: int, levels: int) -> str:
    return "" if level == levels else f' fill-opacity="{level / levels:.3g}"'


def _path(there: Bool[np.ndarray, "r c"]) -> str:
    """A rectangle for each run of pins in a row."""
    path = list[str]()
    for row, pins in enumerate(there):
        steps = np.diff(np.concatenate([[0], pins.astype(np.int8), [0]]))
        starts, ends = np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist()
        path += [f"M{start} {row}h{end - start}v1h{start - end}z" for start, end in zip(starts, ends, strict=True)]
    return "".join(path)
