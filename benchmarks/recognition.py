"""Whether a photograph is recognised by touch: a machine hand strokes the surface, and networks look at what it felt.

The hand knows its positions and the forces on it at 1 kHz, nothing else: where the surface is, and how it slopes. What
it felt becomes a map of heights, which is lit from twelve sides; networks then look for the face and the figure that
they see in the photograph.
"""
# OpenCV and scipy have no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUnknownMemberType=false

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from statistics import fmean, stdev
from typing import Any, NamedTuple

import cv2
import numpy as np
from scipy.interpolate import CubicHermiteSpline

from tangible_core import Pipeline, Scene
from tangible_core.data import Figure as Seen
from tangible_core.data import HapticSurface
from tangible_depth import Luminance, SemiGlobal
from tangible_networks.seeing import LOWEST_SCORE, find_faces, look, look_for_figure
from tangible_networks.store import known_networks, networks_here
from tangible_render import Proxy
from tangible_texture import Hierarchy

from .figures import Figure, judged, table
from .regions_drawn import photographs
from .tests_path import drawn_parts

NAMED = "astronaut", "chelsea", "coffee"  # photographs that scikit-image ships
PAIR = "motorcycle"  # the pair that scikit-image ships
# Those of the photographs that people drew regions in whose faces are the widest; no number was chosen on them.
WITH_FACES = "189013", "230098", "368037"
DRAWN = "astronaut", "camera", "chelsea", "coffee", "rocket", "motorcycle"
"""Photographs of the picture in the docs, which `python -m benchmarks.recognition` draws."""
CELL_PX = 300
SECONDS = 60, 600
MIN_LIGHTS, MAX_MEAN_OFF, MIN_OVERLAP = 9, 0.04, 0.8
# The press is a light one: on 800 N/m, a hand that presses with 1 N is over a millimetre deep, and misses eyes.
TICK_S, PRESS_N, SPEED_M_PER_S = 1e-3, 0.3, 0.15
LANDING = 100  # ticks in which the hand comes down on one place
LIGHTS = tuple(range(0, 360, 30))  # directions of the light, degrees
FIGURE_LIGHTS = LIGHTS[3::6]  # those under which the figure is looked for, which takes a second each
AROUND = 1.5  # distance from a face's middle within which it is looked for, of its width
ELEVATION = 35
# Largest mean distance of the points of a face from those in the photograph, of its width: farther, it is another.
MAX_OFF = 0.3


class Felt(NamedTuple):
    """What networks see of a relief."""

    lights: int  # number of lights under which the photograph's face is found
    off: float  # mean distance of the face's points from the photograph's, of the face's width
    overlap: float  # intersection over union of the figure with the photograph's, the best of all lights
    has_face: bool  # true if the photograph shows a face


# The ways to make a relief of a photograph, as options of a pipeline.
WAYS: Mapping[str, Mapping[str, Any]] = {
    "brightness": {"depth": Luminance()},
    "edges": {"relief": "edges", "texture": Hierarchy()},
    "edges, no slope bound": {"relief": {"by": "edges", "slope": 0}, "texture": Hierarchy()},
    "parts": {"heights": {"by": "guess"}, "texture": Hierarchy()},
    "figure": {"relief": "figure"},
    "figure, no slope bound": {"relief": {"by": "figure", "slope": 0}},
}
PAIR_WAYS: Mapping[str, Mapping[str, Any]] = {
    "disparity": {"depth": SemiGlobal()},
    "disparity, no slope bound": {"depth": SemiGlobal(), "relief": {"slope": 0}},
    "figure, by disparity": {"depth": SemiGlobal(), "relief": "figure"},
}
"""The ways to make a relief of a pair."""


def section() -> str:
    """Return the section as Markdown."""
    if not all(networks_here(task) for task in ("figure", "borders", "faces")):
        return "Not measured: the networks are not here; `tangible networks add figure borders faces`."
    scenes = dict(_scenes())
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as processes:
        measured = dict(zip(scenes, processes.map(measure, scenes.keys(), scenes.values()), strict=True))
    rows: list[tuple[str, ...]] = []
    felt: dict[tuple[str, int], dict[str, Felt]] = {}
    for name, results in measured.items():
        for (way, seconds), result in results.items():
            felt.setdefault((way, seconds), {})[name] = result
            lights = f"{result.lights}" if result.has_face else "-"
            off = "-" if math.isnan(result.off) else f"{100 * result.off:.1f} %"
            rows.append((name, way, f"{seconds} s", lights, off, f"{result.overlap:.2f}"))
    best = felt["figure", SECONDS[-1]]
    face, overlap = best[NAMED[0]], fmean(result.overlap for result in best.values() if not math.isnan(result.overlap))
    figures = [
        Figure(f"lights of 12, face of {NAMED[0]}", f">= {MIN_LIGHTS}", f"{face.lights}", face.lights >= MIN_LIGHTS),
        Figure("its points off, of its width", f"<= {MAX_MEAN_OFF}", f"{face.off:.3f}", face.off <= MAX_MEAN_OFF),
        Figure("overlap of the figure, mean", f">= {MIN_OVERLAP}", f"{overlap:.2f}", overlap >= MIN_OVERLAP),
    ]
    means = [(way, f"{seconds} s", *_means(list(results.values()))) for (way, seconds), results in felt.items()]
    return "\n".join(
        [
            f"What a machine hand feels in {SECONDS[0]} s, and in {SECONDS[1]} s, with a press of {PRESS_N} N: under "
            "how many of twelve lights the surest face of the photograph is found on the relief, how far its points "
            "are off, of its width, and how far both figures overlap.",
            "",
            *table(("relief", "stroked", "lights of a face", "points off, %", "overlap"), means),
            "",
            "Means with standard errors, over the photographs that follow.",
            "",
            *table(("photograph", "relief", "stroked", "lights", "points off", "overlap"), rows),
            "",
            *judged(figures),
        ]
    )


def measure(name: str, scene: Scene) -> dict[tuple[str, int], Felt]:
    """Return what networks see on each relief of a scene, by the way and the seconds of stroking."""
    assert scene.views is not None
    picture, felt = np.asarray(scene.views.left), dict[tuple[str, int], Felt]()
    seen = look(picture)
    for way, options in (PAIR_WAYS if name == PAIR else WAYS).items():
        relief = Pipeline(scene, cached=False, **options).relief
        for seconds in SECONDS if way == "figure" else SECONDS[:1]:
            heights_m = stroke_surface(HapticSurface(relief), seconds)
            felt[way, seconds] = recognise(heights_m, relief.pitch_m[0], seen, picture.shape[:2])
    return felt


def _scenes() -> Iterator[tuple[str, Scene]]:
    for name in NAMED:
        yield name, Scene.photo(np.asarray(drawn_parts.drawn(name).picture))
    yield PAIR, Scene.builtin(f"builtin/{PAIR}")
    for name, photograph in photographs().items():
        if name in WITH_FACES:
            yield name, Scene.photo(photograph.picture)


def _means(results: Sequence[Felt]) -> Iterator[str]:
    yield _mean([result.lights for result in results if result.has_face], "{:.1f}")
    yield _mean([100 * result.off for result in results if not math.isnan(result.off)], "{:.1f}")
    yield _mean([result.overlap for result in results if not math.isnan(result.overlap)], "{:.2f}")


def _mean(values: Sequence[float], form: str) -> str:
    if len(values) < 2:
        return form.format(values[0]) if values else "-"
    return f"{form.format(fmean(values))} ± {form.format(stdev(values) / math.sqrt(len(values)))}"


def stroke_surface(surface: HapticSurface, seconds: float) -> np.ndarray:
    """Stroke a surface in rows from top to bottom; return the heights that were felt, (h, w) as the surface has, m.

    The hand lands once, to learn the stiffness; then it goes as deep as its press needs, by the row felt before. The
    direction of the force is the slope, so that between two rows there is a cubic through both.
    """
    touch = Proxy().touch(surface)
    rows, columns = surface.height_m.shape
    width_m, length_m = surface.extent_m
    lines = max(2, round(seconds * SPEED_M_PER_S / width_m))
    x = np.linspace(-0.5, 0.5, max(2, round(seconds / TICK_S / lines))) * width_m
    y = (0.5 - (np.arange(lines) + 0.5) / lines) * length_m
    column_m = ((np.arange(columns) + 0.5) / columns - 0.5) * width_m
    top_m = float(surface.height_m.max()) + 0.001
    landing = np.column_stack([np.full((LANDING, 2), [x[0], y[0]]), np.linspace(top_m, -0.001, LANDING)])
    forces = touch.path(landing, TICK_S)
    stiffness = _stiffness(landing, forces)
    known = np.full(x.size, landing[-1, 2] + forces[-1, 2] / stiffness)
    felt_rows: list[np.ndarray] = []
    for line in range(lines):
        way = slice(None) if line % 2 == 0 else slice(None, None, -1)
        positions = np.column_stack([x, np.full(x.size, y[line]), known - PRESS_N / stiffness])[way]
        forces = touch.path(positions, TICK_S)
        pressed = forces[:, 2] > 0
        if not pressed.any():
            known = known - PRESS_N / stiffness
            continue
        positions, forces = positions[pressed], forces[pressed]
        felt = np.column_stack([positions + forces / stiffness, -forces[:, 1] / forces[:, 2]])
        felt = felt[np.argsort(felt[:, 0])]
        known = np.interp(x, felt[:, 0], felt[:, 2])
        felt_rows.append(np.column_stack([np.interp(column_m, felt[:, 0], felt[:, axis]) for axis in (1, 2, 3)]))
    places = np.stack(felt_rows)
    row_m = (0.5 - (np.arange(rows) + 0.5) / rows) * length_m
    heights_m = np.empty((rows, columns), np.float32)
    for column in range(columns):
        own = places[np.unique(places[:, column, 0], return_index=True)[1], column]
        spline = CubicHermiteSpline(own[:, 0], own[:, 1], own[:, 2])
        heights_m[:, column] = spline(np.clip(row_m, own[0, 0], own[-1, 0]))
    return heights_m


def _stiffness(positions: np.ndarray, forces: np.ndarray) -> float:
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
            face = seen.faces[0]
            middle, reach = face[:, :2].mean(axis=0), AROUND * float(np.ptp(face[:, 0]))
            left, top = np.maximum(middle - reach, 0).astype(int).tolist()
            right, bottom = np.ceil(middle + reach).astype(int).tolist()
            around = np.ascontiguousarray(picture[top:bottom, left:right])
            found = find_faces(around, known["face-finder"], known["face-points"], LOWEST_SCORE)
            offs += [off for off in [_off(found[..., :2] + [left, top], face)] if off < MAX_OFF]
        if wanted is not None and azimuth in FIGURE_LIGHTS:
            figure = look_for_figure(picture)
            assert figure is not None
            both, either = (figure > 0.5) & wanted, (figure > 0.5) | wanted
            overlaps.append(float(both.sum() / max(either.sum(), 1)))
    return Felt(len(offs), fmean(offs) if offs else math.nan, max(overlaps, default=math.nan), len(seen.faces) > 0)


def _off(found: np.ndarray, face: np.ndarray) -> float:
    """Return the mean distance of the nearest face's (n, 468, 2) points over its width; infinite without a face."""
    width = float(np.ptp(face[:, 0]))
    return min((float(np.linalg.norm(each - face[:, :2], axis=1).mean()) / width for each in found), default=math.inf)


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
    draw(Path("docs/pictures/photographs.jpg"))
