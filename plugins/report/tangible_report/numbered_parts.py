"""The picture with the borders and numbers of its parts, on which a person looks up the number of a part."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from jaxtyping import Int32, UInt8

from tangible_core.data import PartMap, digest_of, shown_number, to_rgb8
from tangible_core.runtime import cv2, plain_opencv
from tangible_legibility.cells import Disc, largest_disc, resampled

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont

SHORTEST_PX, LONGEST_PX = 1200, 2400
"""The limits of the drawn picture's longer side: small pictures grow and large ones shrink, so that numbers look alike
on a screen."""
# The height of a number with and without enough room in its part, as a share of the longer side.
LARGE, SMALL = 1 / 32, 1 / 52
# The PNG's text chunks: the digest of the drawn pixels, and the numbers of the parts, which later show changes.
DRAWN, NUMBERS = "tangible parts", "tangible numbers"
COARSE = 256  # the longer side of the grid on which the numbers are saved
INK, HALO = (0, 0, 0), (255, 255, 255)


def numbered_parts(picture: np.ndarray, parts: PartMap, names: Sequence[str] = ()) -> bytes:
    """Return a PNG of the picture, every part outlined, and numbered in the middle of its largest disc."""
    from PIL import Image, ImageDraw
    from PIL.PngImagePlugin import PngInfo

    canvas, labels = _resize(to_rgb8(picture), parts.labels)
    longer = max(labels.shape)
    _draw_borders(canvas, labels, max(1, round(longer / 800)))
    image = Image.fromarray(canvas)
    draw = ImageDraw.Draw(image)
    for number in range(parts.count):
        name = names[number] if number < len(names) else ""
        number_text = str(shown_number(number))
        texts = [f"{number_text} {name}", number_text] if name else [number_text]
        _write(draw, largest_disc(labels == number), texts, longer)
    info = PngInfo()
    info.add_text(DRAWN, _digest(image))
    info.add_text(NUMBERS, _encode(_coarse(parts.labels, COARSE)), zip=True)
    file = BytesIO()
    image.save(file, format="PNG", pnginfo=info)
    return file.getvalue()


class Before(NamedTuple):
    """The former state of a part, when the picture was drawn."""

    number: int | None  # the former number; None for a new part
    cut_from: int  # the former part that most of it was in


class Drawn(NamedTuple):
    """The parts of a picture of numbered parts, when it was drawn."""

    numbers: Int32[np.ndarray, "r c"]  # the number of the part at each place of a coarse grid

    def before(self, parts: PartMap) -> tuple[Before, ...] | None:
        """Return the former state of each part, of which each covers most of the other; None from another picture."""
        now = _coarse(parts.labels, max(self.numbers.shape))
        if now.shape != self.numbers.shape:
            return None
        both = np.zeros((int(self.numbers.max()) + 1, parts.count), np.int64)
        np.add.at(both, (self.numbers, now), 1)
        of_old, of_new = both.argmax(axis=1), both.argmax(axis=0)
        same = (of_old[of_new] == np.arange(parts.count)) & both.any(axis=0)
        pairs = zip(of_new.tolist(), same.tolist(), strict=True)
        return tuple(Before(old if alike else None, old) for old, alike in pairs)


def as_drawn(path: Path) -> Drawn | None:
    """Return the parts in a file of `numbered_parts`; None for other files, and if somebody has painted on it since."""
    from PIL.Image import open as open_image

    try:
        with open_image(path, formats=("PNG",)) as image:
            if image.info.get(DRAWN) == _digest(image):
                return Drawn(_decode(image.info[NUMBERS]))
    except Exception:  # noqa: BLE001 - a damaged file can raise any error, and is not a file of ours
        return None
    return None


def _digest(image: Image) -> str:
    return digest_of(np.asarray(image))


def _coarse(labels: Int32[np.ndarray, "h w"], longest: int) -> Int32[np.ndarray, "r c"]:
    """Return the labels at the middles of a grid, whose longer side is at most `longest`."""
    scale = min(1.0, longest / max(labels.shape))
    return resampled(labels, tuple(max(1, round(scale * side)) for side in labels.shape))


def _encode(numbers: Int32[np.ndarray, "r c"]) -> str:
    rows, columns = numbers.shape
    return f"{rows} {columns} {b64encode(numbers.astype('<u2').tobytes()).decode()}"


def _decode(text: str) -> Int32[np.ndarray, "r c"]:
    rows, columns, numbers = text.split(" ")
    return np.frombuffer(b64decode(numbers), "<u2").reshape(int(rows), int(columns)).astype(np.int32)


def _resize(
    picture: UInt8[np.ndarray, "h w 3"], labels: Int32[np.ndarray, "h w"]
) -> tuple[UInt8[np.ndarray, "r c 3"], Int32[np.ndarray, "r c"]]:
    """Return both at the drawn size, as new arrays."""
    longer = max(labels.shape)
    scale = -(-SHORTEST_PX // longer) if longer < SHORTEST_PX else min(1.0, LONGEST_PX / longer)
    rows, columns = (max(1, round(scale * side)) for side in labels.shape)
    with plain_opencv():
        resized = cv2.resize(picture, (columns, rows), interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
        nearest = cv2.resize(labels, (columns, rows), interpolation=cv2.INTER_NEAREST)
    return np.array(resized, np.uint8), np.array(nearest, np.int32)


def _draw_borders(canvas: UInt8[np.ndarray, "h w 3"], labels: Int32[np.ndarray, "h w"], width_px: int) -> None:
    """Draw dark lines with light ones on both sides, which are visible on any picture."""
    border = np.zeros(labels.shape, np.uint8)
    border[:, 1:] |= labels[:, 1:] != labels[:, :-1]
    border[1:] |= labels[1:] != labels[:-1]
    for colour, width in ((HALO, 3 * width_px), (INK, width_px)):
        canvas[cv2.dilate(border, np.ones((width, width), np.uint8)) > 0] = colour


def _write(draw: ImageDraw, disc: Disc | None, texts: Sequence[str], longer: int) -> None:
    """Write the first of these texts that fits into the disc, or else the last one, small."""
    if disc is None:
        return
    large, small = _font(round(LARGE * longer)), _font(round(SMALL * longer))
    fits = ((text, font) for text in texts for font in (large, small) if _fits(draw, text, font, disc.radius_px))
    text, font = next(fits, (texts[-1], small))
    place = disc.column + 0.5, disc.row + 0.5
    draw.text(place, text, INK, font, anchor="mm", stroke_width=max(2, round(font.size / 8)), stroke_fill=HALO)


def _fits(draw: ImageDraw, text: str, font: FreeTypeFont, radius_px: float) -> bool:
    left, top, right, bottom = draw.textbbox((0, 0), text, font, anchor="mm")
    return float(np.hypot(right - left, bottom - top)) <= 2 * radius_px


@cache
def _font(size_px: int) -> FreeTypeFont:
    """Return the font of the sheet, from matplotlib's files; matplotlib itself is not imported."""
    from PIL import ImageFont

    spec = find_spec("matplotlib")
    assert spec is not None and spec.origin is not None
    return ImageFont.truetype(Path(spec.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans-Bold.ttf", size_px)
