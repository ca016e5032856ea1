"""Fills by which a finger tells a part from its neighbours: whole elements of five kinds, clear of each other."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from jaxtyping import Float64

from .sheet import CLEAR_MM, LINE_MM

MIN_DOTS, MIN_STROKES_MM = 4, 16.0  # conventions of ours
DOT_MM, DOTS_APART_MM = 2.4, 6.0


@dataclass(frozen=True)
class Lines:
    """A fill of parallel lines."""

    width_mm: float
    pitch_mm: float
    angle_deg: float
    wave_mm: float = 0
    length_mm: float = 10
    least_mm: float = 5  # shortest piece: a shorter one would be felt as a dot, or as a straight line


@dataclass(frozen=True)
class Fill:
    """Dots and strokes, in millimetres on the page."""

    dots_mm: Float64[np.ndarray, "n 2"] = field(default_factory=lambda: np.zeros((0, 2)))
    strokes: tuple[Any, ...] = ()
    stroke_mm: float = 0

    def __bool__(self) -> bool:
        return bool(len(self.dots_mm) or self.strokes)

    def without(self, places_mm: Float64[np.ndarray, "n 2"]) -> "Fill":
        """Return the fill without the dots and strokes at these places."""
        near = shapely.MultiPoint(places_mm)
        dots = self.dots_mm[shapely.distance(shapely.points(self.dots_mm), near) > 0.1]
        return Fill(dots, tuple(stroke for stroke in self.strokes if stroke.distance(near) > 0.1), self.stroke_mm)


def _dots(inner: Any) -> Fill:
    room = inner.buffer(-DOT_MM / 2)
    if room.is_empty:
        return Fill()
    left, top, right, bottom = room.bounds
    columns, rows = _amid(left, right, DOTS_APART_MM), _amid(top, bottom, DOTS_APART_MM * np.sqrt(3) / 2)
    at = np.array([(x + row % 2 * DOTS_APART_MM / 2, y) for row, y in enumerate(rows) for x in columns])
    at = _without_single_dots(at[shapely.contains_xy(room, at)])
    return Fill(dots_mm=at) if len(at) >= MIN_DOTS else Fill()


def _amid(start: float, end: float, pitch: float) -> Float64[np.ndarray, " n"]:
    count = int((end - start) / pitch)
    return (start + end - count * pitch) / 2 + pitch * np.arange(count + 1)


def _without_single_dots(at: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "k 2"]:
    """Return the dots that have a neighbour: a finger takes a single dot for a letter."""
    points: Any = shapely.points(at)
    one, other = shapely.STRtree(points).query(points, predicate="dwithin", distance=1.1 * DOTS_APART_MM)
    return at[np.unique(one[one != other])]


def _lines(inner: Any, kind: Lines) -> Fill:
    room = inner.buffer(-kind.width_mm / 2)
    if room.is_empty:
        return Fill()
    strokes = _clear_strokes(shapely.get_parts(shapely.intersection(_parallels(room.bounds, kind), room)), kind)
    if sum(stroke.length for stroke in strokes) < MIN_STROKES_MM or len(strokes) < 2:
        return Fill()
    return Fill(strokes=tuple(strokes), stroke_mm=kind.width_mm)


def _parallels(bounds: tuple[float, ...], kind: Lines) -> Any:
    """Return lines over a whole rectangle, from its middle to both sides."""
    left, top, right, bottom = bounds
    reach = np.hypot(right - left, bottom - top) / 2 + kind.wave_mm
    along = np.arange(-reach, reach + 0.5, 0.5) if kind.wave_mm else np.array([-reach, reach])
    wave = kind.wave_mm * np.sin(2 * np.pi * along / kind.length_mm)
    rows = [np.stack([along, wave + off], axis=1) for off in _amid(-reach, reach, kind.pitch_mm)]
    cosine, sine = np.cos(np.radians(kind.angle_deg)), np.sin(np.radians(kind.angle_deg))
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    middle = np.array([(left + right) / 2, (top + bottom) / 2])
    lines: Any = [shapely.linestrings(np.einsum("ij,kj->ki", rotation, points) + middle) for points in rows]
    return shapely.multilinestrings(lines)


def _clear_strokes(strokes: Any, kind: Lines) -> list[Any]:
    """Return the long strokes, without those too near to a longer one: ends that a corner of the part left over."""
    long = sorted((stroke for stroke in strokes if stroke.length >= kind.least_mm), key=lambda stroke: -stroke.length)
    tree = shapely.STRtree(long)
    one, other = tree.query(long, predicate="dwithin", distance=CLEAR_MM + kind.width_mm) if long else ([], [])
    neighbours: dict[int, list[int]] = {}
    for this, that in zip(one, other, strict=True):
        neighbours.setdefault(int(this), []).append(int(that))
    clear: dict[int, Any] = {}
    for number, stroke in enumerate(long):
        if not any(other in clear for other in neighbours.get(number, [])):
            clear[number] = stroke
    return list(clear.values())


# Fills by name: five, as many as a finger tells apart (tactile-graphics wiki).
KINDS: dict[str, Callable[[Any], Fill]] = {
    "blank": lambda _: Fill(),
    "dots": _dots,
    "level lines": lambda inner: _lines(inner, Lines(0.8, 4.3, 0)),
    "steep lines": lambda inner: _lines(inner, Lines(1.6, 6.0, -50)),
    "waves": lambda inner: _lines(inner, Lines(0.8, 6.2, 90, wave_mm=1.5, least_mm=11)),
}
BLANK = next(iter(KINDS))


def fill_shape(shape: Any, kind: str, free: Any = None, clear_mm: float = CLEAR_MM) -> Fill:
    """Return a fill within a shape, clear of its outline and outside of `free`; empty where it has no room."""
    inner = shape.buffer(-(LINE_MM / 2 + clear_mm))
    inner = inner if free is None else inner.difference(free)
    return Fill() if inner.is_empty else KINDS[kind](inner)
