"""Pins as files: a picture, numbers, braille patterns, hexadecimal digits, and an SVG for the IMAGE services."""

import base64
import json
from collections.abc import Mapping
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import cv2
import numpy as np
from jaxtyping import Bool, Int32, UInt8

Pins = UInt8[np.ndarray, "r c"]
PIN_PX = 8
_BRAILLE = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bits of Unicode's braille patterns, of a cell of 2 x 4 pins."""


def png(pins: Pins, levels: int) -> bytes:
    """Return a picture with a pixel a pin: black is up, white is down, greys are between."""
    grey = 255 - np.rint(pins.astype(np.float64) * (255 / levels)).astype(np.uint8)
    _, data = cv2.imencode(".png", grey)
    return data.tobytes()


def discs(pins: Pins, levels: int) -> UInt8[np.ndarray, "h w"]:
    """Return a picture of the pins: a ring for each that is down, a disc for each that is up, darker if higher."""
    at = np.mgrid[:PIN_PX, :PIN_PX] - (PIN_PX - 1) / 2
    radius = np.hypot(*at)
    disc, ring = radius < 0.42 * PIN_PX, np.abs(radius - 0.34 * PIN_PX) < 0.6
    grey = 200 - np.rint(pins.astype(np.float64) * (200 / levels)).astype(np.uint8)
    fine = np.kron(grey, np.ones((PIN_PX, PIN_PX), np.uint8))
    up = np.kron(pins > 0, disc)
    return np.where(up, fine, np.where(np.kron(pins == 0, ring), 190, 255)).astype(np.uint8)


def numbers(pins: Pins, head: Mapping[str, Any]) -> str:
    """Return JSON: the head, and the height of each pin, a line of text for each row of pins."""
    first_lines = json.dumps(dict(head), ensure_ascii=False, indent=2).removesuffix("\n}")
    rows = ",\n".join("    " + json.dumps(row) for row in pins.tolist())
    return f'{first_lines},\n  "heights": [\n{rows}\n  ]\n}}\n'


def patterns(pins: Pins) -> str:
    """Return Unicode's braille patterns, a character for each cell of 2 x 4 pins; pins that are not down are dots."""
    up = _whole_cells(pins > 0)
    cells = up.reshape(up.shape[0] // 4, 4, up.shape[1] // 2, 2).transpose(0, 2, 1, 3)
    codes = 0x2800 + (cells * _BRAILLE).sum(axis=(2, 3))
    return "".join("".join(map(chr, row)) + "\n" for row in codes.tolist())


def hexadecimal(pins: Pins) -> str:
    """Return digits for Dot Pad: two for each cell of 2 x 4 pins, the right column's before the left one's."""
    up = _whole_cells(pins > 0)
    columns = up.reshape(up.shape[0] // 4, 4, up.shape[1] // 2, 2)[..., ::-1].transpose(0, 2, 3, 1)
    # The lowest bit is at the top. Source: touchout-org/dotpad-toolkit.
    return "".join(f"{digit:X}" for digit in (columns * np.array([1, 2, 4, 8])).sum(axis=3).ravel().tolist())


def _whole_cells(up: Bool[np.ndarray, "r c"]) -> Bool[np.ndarray, "k l"]:
    return np.pad(up, ((0, -up.shape[0] % 4), (0, -up.shape[1] % 2)))


def svg(pins: Pins, levels: int, parts: Int32[np.ndarray, "r c"], labels: Mapping[int, str], title: str) -> str:
    """Return an SVG with a layer for each part, in the order of `labels`: its raised pins, and those of its borders."""
    # The Monarch app of IMAGE reads the alpha at one pixel a pin, and shows one layer at a time, each by its label.
    rows, columns = pins.shape
    layers = [
        _layer(f"layer-{number}", label, _shapes(pins, levels, _with_borders(parts, part)))
        for number, (part, label) in enumerate(labels.items(), 1)
    ]
    size = f'width="{columns}" height="{rows}" viewBox="0 0 {columns} {rows}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size}>'
    return "\n".join([head, f"<title>{escape(title)}</title>", *layers, "</svg>\n"])


def graphic(text: str) -> str:
    """Return an SVG as their renderer reads it: JSON with a data URL."""
    data = base64.b64encode(text.encode()).decode()
    return json.dumps({"graphic": f"data:image/svg+xml;base64,{data}"}) + "\n"


def _with_borders(parts: Int32[np.ndarray, "r c"], part: int) -> Bool[np.ndarray, "r c"]:
    """Return the pins of a part, and those to its left and above it, on which its borders lie."""
    inside = parts == part
    mask = inside.copy()
    mask[:, :-1] |= inside[:, 1:] & (parts[:, :-1] >= 0)
    mask[:-1] |= inside[1:] & (parts[:-1] >= 0)
    return mask


def _layer(name: str, label: str, shapes: list[str]) -> str:
    return "\n".join([f'<g data-image-layer="{name}" aria-label={quoteattr(label)}>', *shapes, "</g>"])


def _shapes(pins: Pins, levels: int, mask: Bool[np.ndarray, "r c"]) -> list[str]:
    """Return a path for each height: the higher, the more opaque."""
    paths = [(level, _path(mask & (pins == level))) for level in range(1, levels + 1)]
    opacity = ["", *(f' fill-opacity="{level / levels:.3g}"' for level in range(1, levels)), ""]
    return [f'<path shape-rendering="crispEdges"{opacity[level]} d="{path}"/>' for level, path in paths if path]


def _path(mask: Bool[np.ndarray, "r c"]) -> str:
    path = list[str]()
    for row, pins in enumerate(mask):
        steps = np.diff(np.concatenate([[0], pins.astype(np.int8), [0]]))
        starts, ends = np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist()
        path += [f"M{start} {row}h{end - start}v1h{start - end}z" for start, end in zip(starts, ends, strict=True)]
    return "".join(path)
