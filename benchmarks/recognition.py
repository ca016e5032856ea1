"""Whether a photograph is recognised by touch: a machine hand strokes the surface, and networks look at what it felt.

The hand knows its positions and the forces on it at 1 kHz, nothing else. What it felt becomes a map of heights, which
is lit from twelve sides; networks then look for the face and the figure that they see in the photograph.
"""
# OpenCV and scipy have no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Mapping
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

import cv2
import numpy as np
from scipy.interpolate import LinearNDInterpolator

from tangible_core import Pipeline, Scene
from tangible_core.data import Figure as Seen
from tangible_core.data import HapticSurface
from tangible_depth import Luminance
from tangible_networks.faces import LOWEST_SCORE, find_faces
from tangible_networks.seeing import look, look_for_figure
from tangible_networks.store import known_networks, networks_here
from tangible_render import Proxy
from tangible_texture import Hierarchy

from .figures import Figure, judged, table
from .regions_drawn import photographs
from .tests_path import drawn_parts

NAMED = "astronaut", "chelsea", "coffee"
"""Photographs that scikit-image ships."""
DRAWN = "astronaut", "camera", "chelsea", "coffee", "rocket", "motorcycle"
"""Photographs of the picture in the docs, which `python -m benchmarks.recognition` draws."""
CELL_PX = 300
SECONDS = 60, 600
MIN_LIGHTS, MAX_MEAN_OFF, MIN_OVERLAP = 9, 0.04, 0.8
TICK_S, PRESS_N, SPEED_M_PER_S = 1e-3, 1.0, 0.15
LANDING = 100
"""Ticks in which the hand comes down on one place."""
LIGHTS = tuple(range(0, 360, 30))
"""Directions of the light, degrees."""
ELEVATION = 35
MAX_OFF = 0.3
"""Largest mean distance of the points of a face from those in the photograph, of its width: farther, it is another."""


class Felt(NamedTuple):
    """What networks see of a relief."""

    lights: int
    """Number of lights under which the photograph's face is found."""
    off: float
    """Mean distance of the face's points from the photograph's, of the face's width."""
    overlap: float
    """Intersection over union of the figure with the photograph's, the best of all lights."""
    has_face: bool
    """True if the photograph shows a face."""


WAYS: Mapping[str, Mapping[str, Any]] = {
    "brightness": {"depth": Luminance()},
    "edges": {"relief": "edges", "texture": Hierarchy()},
    "figure": {"relief": "figure"},
    "figure, no slope bound": {"relief": {"by": "figure", "slope": 0}},
}
"""The ways to make a relief of a photograph, as options of a pipeline."""


def section() -> str:
    """Return the section as Markdown."""
    if not all(networks_here(task) for task in ("figure", "borders", "faces")):
        return "Not measured: the networks are not here; `tangible networks add figure borders faces`."
    rows: list[tuple[str, ...]] = []
    felt: dict[tuple[str, int], list[Felt]] = {}
    for name, picture in _pictures().items():
        seen = look(picture)
        for way, options in WAYS.items():
            relief = Pipeline(Scene.photo(picture), cached=False, **options).relief
            for seconds in SECONDS:
                heights_m = stroke_surface(HapticSurface(relief), seconds)
                result = recognise(heights_m, relief.pitch_m[0], seen, picture.shape[:2])
                felt.setdefault((way, seconds), []).append(result)
                off = "-" if math.isnan(result.off) else f"{100 * result.off:.1f} %"
                rows.append((name, way, f"{seconds} s", f"{result.lights}", off, f"{result.overlap:.2f}"))
    best = [result for result in felt["figure", SECONDS[-1]] if not math.isnan(result.overlap)]
    faces = [result for result in best if result.has_face]
    lights, off, overlap = (
        min(each.lights for each in faces),
        fmean(each.off for each in faces),
        fmean(each.overlap for each in best),
    )
    figures = [
        Figure("lights of 12 under which each face is found", f">= {MIN_LIGHTS}", f"{lights}", lights >= MIN_LIGHTS),
        Figure("points of a face off, of its width", f"<= {MAX_MEAN_OFF}", f"{off:.3f}", off <= MAX_MEAN_OFF),
        Figure("overlap of the figure", f">= {MIN_OVERLAP}", f"{overlap:.2f}", overlap >= MIN_OVERLAP),
    ]
    return "\n".join(
        [
            "What a machine hand feels in a minute and in ten, lit from twelve sides: under how many lights the face "
            "of the photograph is found, how far its points are off, and how far both figures overlap.",
            "",
            *table(("photograph", "relief", "stroked", "lights", "points off", "overlap"), rows),
            "",
            *judged(figures),
        ]
    )


def _pictures() -> dict[str, np.ndarray]:
    """Return the photographs of scikit-image, and every other one of those that people drew regions in."""
    named = {name: np.asarray(drawn_parts.drawn(name).picture) for name in NAMED}
    return named | {name: each.picture for name, each in list(photographs().items())[1::6]}


def stroke_surface(surface: HapticSurface, seconds: float) -> np.ndarray:
    """Stroke a surface in rows from top to bottom; return the heights that were felt, (h, w) as the surface has, m.

    The hand lands once, to learn the stiffness; then it goes as deep as its press needs, by the row felt before.
    """
    touch = Proxy().touch(surface)
    rows, columns = surface.height_m.shape
    width_m, length_m = surface.extent_m
    lines = max(2, round(seconds * SPEED_M_PER_S / width_m))
    x = np.linspace(-0.5, 0.5, max(2, round(seconds / TICK_S / lines))) * width_m
    y = (0.5 - (np.arange(lines) + 0.5) / lines) * length_m
    top_m = float(surface.height_m.max()) + 0.001
    landing = np.column_stack([np.full((LANDING, 2), [x[0], y[0]]), np.linspace(top_m, -0.001, LANDING)])
    forces = touch.path(landing, TICK_S)
    stiffness = _stiffness(landing, forces)
    known = np.full(x.size, landing[-1, 2] + forces[-1, 2] / stiffness)
    points: list[np.ndarray] = []
    for line in range(lines):
        way = slice(None) if line % 2 == 0 else slice(None, None, -1)
        positions = np.column_stack([x, np.full(x.size, y[line]), known - PRESS_N / stiffness])[way]
        forces = touch.path(positions, TICK_S)
        felt = (positions + forces / stiffness)[forces[:, 2] > 0]
        points.append(felt)
        order = np.argsort(felt[:, 0])
        known = np.interp(x, felt[order, 0], felt[order, 2]) if felt.size else known - PRESS_N / stiffness
    every = np.concatenate(points)
    places = (every[:, :2] / [width_m, -length_m] + 0.5) * [columns, rows]
    row, column = np.mgrid[:rows, :columns] + 0.5
    heights = LinearNDInterpolator(places, every[:, 2])(column, row)
    return np.where(np.isfinite(heights), heights, np.nanmin(heights)).astype(np.float32)


def _stiffness(positions: np.ndarray, forces: np.ndarray) -> float:
    """Return the stiffness that the hand feels while it comes down on one place, N/m."""
    pressed = forces[:, 2] > 0
    return float(np.ptp(forces[pressed, 2]) / np.ptp(positions[pressed, 2]))


def light_surface(heights_m: np.ndarray, pitch_m: float, azimuth: float) -> np.ndarray:
    """Return a surface of heights (h, w) lit from one side, 0..1."""
    down, right = np.gradient(heights_m, pitch_m)
    normal = np.dstack([-right, down, np.ones_like(heights_m)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    along, up = math.radians(azimuth), math.radians(ELEVATION)
    light = [math.cos(along) * math.cos(up), math.sin(along) * math.cos(up), math.sin(up)]
    return np.clip(normal @ np.array(light), 0, 1).astype(np.float32)


def recognise(heights_m: np.ndarray, pitch_m: float, seen: Seen, shape: tuple[int, ...]) -> Felt:
    """Compare what networks see on lit heights with what they see in the photograph."""
    known, offs, overlaps = known_networks(), list[float](), list[float]()
    wanted = seen.figure > 0.5 if seen.figure is not None and (seen.figure > 0.5).any() else None
    for azimuth in LIGHTS:
        lit = cv2.resize(light_surface(heights_m, pitch_m, azimuth), (shape[1], shape[0]))
        picture = np.repeat(lit[..., None], 3, axis=2)
        if len(seen.faces):
            found = find_faces(picture, known["face-finder"], known["face-points"], LOWEST_SCORE)
            offs += [off for off in [_off(found, seen.faces[0])] if off < MAX_OFF]
        if wanted is not None:
            figure = look_for_figure(picture)
            assert figure is not None
            both, either = (figure > 0.5) & wanted, (figure > 0.5) | wanted
            overlaps.append(float(both.sum() / max(either.sum(), 1)))
    return Felt(len(offs), fmean(offs) if offs else math.nan, max(overlaps, default=math.nan), len(seen.faces) > 0)


def _off(found: np.ndarray, face: np.ndarray) -> float:
    """Return the mean distance of the nearest face's points, over the face's width; infinite without a face."""
    width = float(np.ptp(face[:, 0]))
    return min(
        (float(np.linalg.norm(each[:, :2] - face[:, :2], axis=1).mean()) / width for each in found), default=math.inf
    )


def draw(target: Path) -> None:
    """Draw photographs beside their reliefs by brightness, by edges and by what networks see, lit from one side."""
    rows: list[np.ndarray] = []
    for name in DRAWN:
        picture = np.asarray(drawn_parts.drawn(name).picture)
        cells = [picture[..., ::-1] if picture.ndim == 3 else cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR)]
        for way in ("brightness", "edges", "figure"):
            relief = Pipeline(Scene.photo(picture), cached=False, **WAYS[way]).relief
            lit = (255 * light_surface(relief.height_m, relief.pitch_m[0], 135)).astype(np.uint8)
            cells.append(cv2.cvtColor(lit, cv2.COLOR_GRAY2BGR))
        size = CELL_PX, round(CELL_PX * picture.shape[0] / picture.shape[1])
        rows.append(np.hstack([cv2.resize(cell, size, interpolation=cv2.INTER_AREA) for cell in cells]))
    cv2.imwrite(str(target), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    draw(Path("docs/photographs.jpg"))
