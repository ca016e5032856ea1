"""Pictures for pin displays."""

import logging
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple, final

import numpy as np
from jaxtyping import Int32, UInt8

from tangible_core.data import PartMap, Work
from tangible_core.errors import PictureError, shown
from tangible_core.plugins import Exporter, Medium, Previewing, note

from .paper.named_parts import find_label, first_labels
from .pin_display.displays import DISPLAYS, HEXADECIMAL, PITCH_M, Display, Named

if TYPE_CHECKING:
    from .pin_display.raising import Place

log: logging.Logger = logging.getLogger(__name__)

MIN_PINS = 3  # fewer leave nothing between two borders


class Raised(NamedTuple):
    """The pins of a display that are up, and the parts that they show."""

    pins: UInt8[np.ndarray, "rows columns"]
    place: "Place"
    most: Int32[np.ndarray, "r c"]  # the part that has most of each pin's place
    labels: dict[int, str]


@final
class Pins(Exporter, Previewing):
    """Pins that rise along the borders of parts: PNG, JSON, Unicode braille, and an SVG for the IMAGE services.

    For displays such as the Monarch and the Dot Pad: a few large parts are legible, details are not.

    On a display whose pins have several heights, the relief fills the areas between the borders, below their height.
    """

    medium: ClassVar[Medium | None] = "pins"
    limits_slopes: ClassVar[bool] = False

    display: Named | Display = "monarch"
    """A display by name, or the numbers of its columns, rows and heights."""

    @property
    def needs(self) -> tuple[str, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The parts; the relief only if pins have several heights, as it may be slow or impossible to make."""
        return ("simplified", "relief") if self._array.levels > 1 else ("simplified",)

    @property
    def _array(self) -> Display:
        return self.display if isinstance(self.display, Display) else DISPLAYS[self.display]

    def picture_width_m(self, aspect: float) -> float:
        """Return the width of the picture on the display."""
        return PITCH_M * min(self._array.columns, self._array.rows * aspect)

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write a file of each format; hexadecimal digits only for a display that reads them.

        Raises: PictureError where there is no border to show, or no room for one.
        """
        from .pin_display import formats, raising

        array = self._array
        pins, place, most, labels = self._raised(work)
        rows, columns = most.shape
        title = shown(work.title)
        svg = formats.svg(pins, array.levels, raising.on_display(array, most, place, -1), labels, title)
        head = {"title": title, "language": work.language, "display": self._name, **array.model_dump()}
        texts = {
            ".json": formats.numbers(pins, {**head, "parts": list(labels.values())}),
            ".txt": formats.patterns(pins),
            ".svg": svg,
            "-graphic.json": formats.graphic(svg),
        }
        if self.display in HEXADECIMAL:
            texts[".hex"] = formats.hexadecimal(pins)
        note(log, f"{columns} x {rows} of {array.columns} x {array.rows} pins; {100 * (pins > 0).mean():.0f} % are up")
        note(log, f"{len(labels)} parts, simplified for this display; other files may have more")
        return _write_files(stem, self._name, formats.png(pins, array.levels), texts)

    def preview(self, work: Work) -> UInt8[np.ndarray, "h w"]:
        """Return the pins as discs, the higher the darker. Raises: as `write`."""
        from .pin_display.formats import discs

        return discs(self._raised(work).pins, self._array.levels)

    def _raised(self, work: Work) -> "Raised":
        from .pin_display import raising

        array, parts = self._array, _parts(work, self._array)
        place = raising.place_picture(array, parts.labels.shape)
        rows, columns = (side.stop - side.start for side in place)
        if min(rows, columns) < MIN_PINS:
            raise PictureError(
                f"the picture would be {columns} pins wide and {rows} long; take a part of it that is less long "
                "and narrow"
            )
        most = raising.largest_shares(parts, rows, columns)
        labels = _visible_labels(work, parts, most)
        area = raising.heights(work.relief, rows, columns, array.levels - 1) if array.levels > 1 else 0
        picture = np.where(raising.borders(most), array.levels, area).astype(np.uint8)
        pins = raising.on_display(array, picture, place, 0)
        if not pins.any():
            raise PictureError("no pin would rise, as one part fills the display; have more parts, and larger ones")
        return Raised(pins, place, most, labels)

    @property
    def _name(self) -> str:
        return self.display if isinstance(self.display, str) else f"pins-{self._array.columns}x{self._array.rows}"


def _parts(work: Work, display: Display) -> PartMap:
    """Return the parts to show. Raises: PictureError for a scene of one part, unless pins have several heights."""
    if (parts := work.simplified) is None:
        raise PictureError("this scene has no parts to show; it needs a picture, or its own `parts:`")
    if display.levels == 1 and (parts.labels == parts.labels.flat[0]).all():
        raise PictureError(
            "the picture is one part, and has no border to show; name or draw its parts (`parts:`), or choose "
            "another texture method"
        )
    return parts


def _visible_labels(work: Work, parts: PartMap, most: np.ndarray) -> dict[int, str]:
    """Return the labels of the parts that have a pin; note those that have none."""
    sizes = np.bincount(parts.labels.ravel(), minlength=parts.count)
    pins = np.bincount(most.ravel(), minlength=parts.count)
    labels = {number: find_label(number, work) for number in np.flatnonzero(sizes).tolist()}
    if lost_labels := [label for number, label in labels.items() if not pins[number]]:
        note(log, f"too small for a pin: {first_labels(lost_labels)}")
    return {number: label for number, label in labels.items() if pins[number]}


def _write_files(stem: Path, name: str, png: bytes, texts: dict[str, str]) -> tuple[Path, ...]:
    picture = stem.with_name(f"{stem.name}-{name}.png")
    picture.write_bytes(png)
    paths = [picture]
    for ending, text in texts.items():
        paths.append(stem.with_name(f"{stem.name}-{name}{ending}"))
        paths[-1].write_text(text, encoding="utf-8", newline="\n")
    return tuple(paths)
