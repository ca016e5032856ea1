"""The cells of a map on the ground, from what its file states: GeoTIFF's tags, the header of a grid, SRTM's name."""

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...files.reading import check_file
from .grids import GRIDS, grid_header
from .height_maps import MeasuredSize
from .kinds import ASC
from .tiff import TIFF, open_tiff

EARTH_M = 6371008.8  # mean radius of the Earth (IUGG)
# Metres of the linear units of EPSG: the metre, the foot and the US survey foot.
UNITS_M: Mapping[int, float] = {9001: 1.0, 9002: 0.3048, 9003: 1200 / 3937}
PIXEL_SCALE, TIE_POINT, TRANSFORMATION, GEO_KEYS = 33550, 33922, 34264, 34735
MODEL_TYPE, GEOGRAPHIC, GEOGRAPHIC_TYPE, PROJECTED_TYPE, HORIZONTAL_UNIT, VERTICAL_UNIT = (
    1024,
    2,
    2048,
    3072,
    3076,
    4099,
)
WEB_MERCATOR, MERCATOR_M = 3857, 6378137.0
"""The projection of web maps, whose metres are those of the equator, and its radius."""
HEAD_BYTES = 4096  # bytes in which the head of an ESRI grid stands
# Cells of a grid without a stated unit that are smaller than this, at a place that the Earth has, are in degrees.
DEGREES = 0.02


class Ground(NamedTuple):
    """The cells of a map on the ground."""

    # Width and length of a cell, metres; those in the middle row of a map in degrees.
    cell_m: tuple[float, float]
    shape: tuple[int, int]  # rows and columns
    unit_m: float = 1.0  # metres that one number of the heights is

    @property
    def size(self) -> MeasuredSize:
        """The size of the whole map."""
        rows, columns = self.shape
        return MeasuredSize(self.cell_m[0] * columns, self.cell_m[1] * rows, None, self.unit_m)


def read_ground(path: Path) -> Ground | None:
    """Read the cells of a map from its file; None if it does not state them, or cannot be read."""
    with suppress(Exception):  # whatever is wrong with a file, the reader of its heights reports
        check_file(path)
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES)
        if head[:4] in TIFF:
            ground = _geotiff(path)
        elif path.suffix.lower() == ".hgt":
            ground = _srtm(path)
        elif path.suffix.lower() in GRIDS or ASC.match(head):
            ground = _esri_grid(path, head)
        else:
            return None
        if ground is not None and all(0 < side < math.inf for side in ground.cell_m):
            return ground
    return None


def cells_in_degrees(width_deg: float, length_deg: float, latitude_deg: float) -> tuple[float, float]:
    """Return width and length of a cell in metres: on a sphere, a degree of longitude shrinks by cos(latitude).

    >>> [round(side) for side in cells_in_degrees(1 / 3600, 1 / 3600, 60)]
    [15, 31]
    """
    degree_m = math.radians(EARTH_M)
    return width_deg * degree_m * math.cos(math.radians(latitude_deg)), length_deg * degree_m


def _geotiff(path: Path) -> Ground | None:
    """Source: OGC 19-008r4 (GeoTIFF 1.1), sections 7 and B."""
    with open_tiff(path) as tiff:
        page: Any = tiff.pages.first
        tags = {number: page.tags.valueof(number) for number in (PIXEL_SCALE, TIE_POINT, TRANSFORMATION, GEO_KEYS)}
        shape = int(page.imagelength), int(page.imagewidth)
    if tags[TRANSFORMATION] is not None:
        steps = np.reshape(tags[TRANSFORMATION], (4, 4))[:2, [0, 1, 3]]
    elif tags[PIXEL_SCALE] is not None:
        across, down = tags[PIXEL_SCALE][:2]
        column, row, _, left, top, _ = tags[TIE_POINT][:6] if tags[TIE_POINT] else [0.0] * 6
        steps = np.array([[across, 0, left - column * across], [0, -down, top + row * down]])
    else:
        return None
    keys = dict(np.reshape(tags[GEO_KEYS] or [], (-1, 4))[1:, [0, 3]].tolist())
    unit_m = UNITS_M.get(keys.get(VERTICAL_UNIT, 0), 1.0)
    across, down = np.hypot(*steps[:, :2]).tolist()
    middle = float(steps[1, 0] * shape[1] / 2 + steps[1, 1] * shape[0] / 2 + steps[1, 2])
    in_degrees = GEOGRAPHIC_TYPE in keys and PROJECTED_TYPE not in keys
    if keys.get(MODEL_TYPE, GEOGRAPHIC if in_degrees else 0) == GEOGRAPHIC:
        return Ground(cells_in_degrees(across, down, middle), shape, unit_m)
    metres = UNITS_M.get(keys.get(HORIZONTAL_UNIT, 0), 1.0)
    metres /= math.cosh(middle / MERCATOR_M) if keys.get(PROJECTED_TYPE) == WEB_MERCATOR else 1.0
    return Ground((across * metres, down * metres), shape, unit_m)


def _srtm(path: Path) -> Ground | None:
    """Source: SRTM quickstart: the name is that of the lower left corner, and the tile a degree long."""
    match = re.match(r"([NS])(\d\d)[EW]\d{3}", path.stem, re.IGNORECASE)
    side = math.isqrt(path.stat().st_size // 2)
    if match is None:
        return None
    latitude = 0.5 + int(match[2]) * (1 if match[1].upper() == "N" else -1)
    return Ground(cells_in_degrees(1 / (side - 1), 1 / (side - 1), latitude), (side, side))


def _esri_grid(path: Path, head: bytes) -> Ground:
    """Source: Esri, ASCII raster format, BIL files; `dx` and `dy` as GDAL's driver AAIGrid has them."""
    words = grid_header(path, head)

    def number(*names: str) -> float:
        return next((float(words[name]) for name in names if name in words), 0.0)

    shape = int(words["nrows"]), int(words["ncols"])
    across, down = number("dx", "xdim", "cellsize"), number("dy", "ydim", "cellsize")
    left, bottom, top = number("xllcorner", "xllcenter", "ulxmap"), number("yllcorner", "yllcenter"), number("ulymap")
    middle = top - down * shape[0] / 2 if "ulymap" in words else bottom + down * shape[0] / 2
    if max(across, down) < DEGREES and (left or middle) and abs(left) <= 180 and abs(middle) <= 90:
        return Ground(cells_in_degrees(across, down, middle), shape)
    return Ground((across, down), shape)
