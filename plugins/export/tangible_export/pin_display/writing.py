"""Pins as files: a picture, numbers, braille patterns, hexadecimal digits."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Bool, UInt8

Pins = UInt8[np.ndarray, "r c"]
_BRAILLE = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bits of Unicode's braille patterns, of a cell of 2 x 4 pins."""


def png(pins: Pins, levels: int) -> bytes:
    """A pixel a pin: black is up, white is down, greys are between."""
    import cv2

    grey = 255 - np.rint(pins.astype(np.float64) * (255 / levels)).astype(np.uint8)
    _, data = cv2.imencode(".png", grey)
    return data.tobytes()


def numbers(pins: Pins, said: Mapping[str, Any]) -> str:
    """JSON: what is said, and the height of each pin, a line of text a row of pins."""
    head = json.dumps(dict(said), ensure_ascii=False, indent=2).removesuffix("\n}")
    rows = ",\n".join("    " + json.dumps(row) for row in pins.tolist())
    return f'{head},\n  "heights": [\n{rows}\n  ]\n}}\n'


def patterns(pins: Pins) -> str:
    """Unicode's braille patterns, a character a cell of 2 x 4 pins, of which those that are not down are dots."""
    up = _whole_cells(pins > 0)
    cells = up.reshape(up.shape[0] // 4, 4, up.shape[1] // 2, 2).transpose(0, 2, 1, 3)
    codes = 0x2800 + (cells * _BRAILLE).sum(axis=(2, 3))
    return "".join("".join(map(chr, row)) + "\n" for row in codes.tolist())


def hexadecimal(pins: Pins) -> str:
    """Digits as Dot Pad takes them: of each cell of 2 x 4 pins two, for its right column and then its left one.

    A digit's bits are the pins of a column, from the top the lowest first. Source: touchout-org/dotpad-toolkit.
    """
    up = _whole_cells(pins > 0)
    columns = up.reshape(up.shape[0] // 4, 4, up.shape[1] // 2, 2)[..., ::-1].transpose(0, 2, 3, 1)
    return "".join(f"{digit:X}" for digit in (columns * np.array([1, 2, 4, 8])).sum(axis=3).ravel().tolist())


def _whole_cells(up: Bool[np.ndarray, "r c"]) -> Bool[np.ndarray, "k l"]:
    return np.pad(up, ((0, -up.shape[0] % 4), (0, -up.shape[1] % 2)))
