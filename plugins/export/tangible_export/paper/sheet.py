"""Sheets of paper: the places of picture, title and corner mark, in millimetres from the upper left corner."""

from dataclasses import dataclass, replace
from typing import Literal

from tangible_core.errors import GeometryError

from ..braille import height_m

Page = Literal["a4", "letter", "a3"]
SIZES_MM: dict[Page, tuple[float, float]] = {"a4": (210, 297), "letter": (215.9, 279.4), "a3": (297, 420)}
MARGIN_MM = 10.0  # margin on all sides, which printers leave white, and where a hand holds the sheet
LINE_MM = 1.0  # width of outlines. A convention of ours, within the 0.5 to 1.5 mm that tactile graphics use.
DASH_MM, DOT_MM = 6.0, 1.5  # length of a dash and width of a dot of a line. Conventions of ours
HEAVY_MM = 1.5  # the most that tactile graphics use, for the figure
GAP_MM = 3.2  # between marks that a finger tells apart. Source: tactilegraphics.org
CLEAR_MM = GAP_MM + 0.2  # GAP_MM and two pixels of the measurement
CORNER_MM = 8.0  # legs of the triangle that marks the upper right corner
# Limit to moving a picture down where there is room: a hand that comes from the title still finds it.
LOWERED_MM = 10.0
# Shorter side of a picture. Source for the least size of a shape that is recognised: APH, 1997.
MIN_MM = 12.7


@dataclass(frozen=True)
class Sheet:
    """A sheet with the place of its picture."""

    width_mm: float
    length_mm: float
    left_mm: float
    top_mm: float
    picture_mm: tuple[float, float]
    spare_mm: float = 0
    """Room below the picture, for moving it down under a title of several lines."""

    @property
    def title_width_mm(self) -> float:
        """Width of the lines above the picture, to the left of the corner mark."""
        return self.width_mm - 2 * MARGIN_MM - CORNER_MM - 2 * GAP_MM

    def below(self, title_mm: float) -> "Sheet":
        """Return the sheet with its picture moved below a title of this height and towards the middle, if possible."""
        least = MARGIN_MM + title_mm + CLEAR_MM + LINE_MM / 2
        down = max(least - self.top_mm, min(self.spare_mm / 2, LOWERED_MM))
        down = min(max(down, 0), self.spare_mm)
        return replace(self, top_mm=self.top_mm + down, spare_mm=self.spare_mm - down)


def sheet_for(page: Page, aspect: float, width_m: float | None) -> Sheet:
    """Return the sheet, upright or on its side, on which the picture is largest; or with a picture of this width."""
    size, wide = _largest(page, aspect)
    wide = wide if width_m is None else 1000 * width_m
    spare_mm = _room(size)[1] - wide / aspect
    return Sheet(size[0], size[1], (size[0] - wide) / 2, _top_mm(), (wide, wide / aspect), spare_mm)


def check_readable(page: Page, sheet: Sheet) -> None:
    """Check the picture's size. Raises: GeometryError if it is too large for the page or too narrow for a finger."""
    width, length = sheet.picture_mm
    _, most = _largest(page, width / length)
    if width > most + 1e-6:
        raise GeometryError(
            f"width_m: a picture {width:.4g} mm wide has no room on {page}, which takes {most:.4g} mm; make it "
            "smaller or the page larger"
        )
    if min(width, length) < MIN_MM:
        raise GeometryError(
            f"the picture would be {width:.3g} mm wide and {length:.3g} mm long on {page}, and a finger needs "
            f"{MIN_MM} mm; take a part of the picture that is less long and narrow, or make it larger"
        )


def _largest(page: Page, aspect: float) -> tuple[tuple[float, float], float]:
    """Return the size of the sheet as it lies, and the width of the largest picture on it."""
    upright = SIZES_MM[page]
    level = upright[1], upright[0]
    rooms = {size: min(_room(size)[0], _room(size)[1] * aspect) for size in (upright, level)}
    size = max(rooms, key=lambda room: rooms[room])
    return size, rooms[size]


def empty_sheet(page: Page, like: Sheet) -> Sheet:
    """Return a sheet for a key, lying as the other one: its picture is the whole room below the title."""
    upright = SIZES_MM[page]
    size = upright if like.width_mm < like.length_mm else (upright[1], upright[0])
    return Sheet(size[0], size[1], MARGIN_MM, _top_mm(), _room(size))


def _top_mm() -> float:
    return MARGIN_MM + max(CORNER_MM, 1000 * height_m()) + CLEAR_MM + LINE_MM / 2


def _room(size: tuple[float, float]) -> tuple[float, float]:
    width, length = size
    return width - 2 * MARGIN_MM - LINE_MM, length - _top_mm() - MARGIN_MM - LINE_MM / 2
