"""Solids: triangles, bytes, time and memory, the largest error at every node, and what other programs say of them."""

import logging
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from statistics import median
from time import process_time

import cv2
import numpy as np

from tangible_bench.memory import start_peak
from tangible_core import Pipeline, Scene, Workspace
from tangible_core.data import Relief, Work
from tangible_core.parts import HeightChoice, Layering
from tangible_depth import Luminance, SemiGlobal
from tangible_export import Glb, Stl, ThreeMF

from .figures import Figure, judged, part, table
from .tests_path import drawn_parts, solids

WIDTH_M, RUNS = 0.16, 5
HUGE = 4096
MAX_TRIANGLES, MAX_S = 40_000, 0.3
HUGE_S, HUGE_GIB = 5.0, 1.0
EXTENT_MM = 1e-3
REPAIRS = ("Degenerate", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards", "Normals f")


def section() -> str:
    """Return the section as Markdown."""
    logging.getLogger("tangible_export").addHandler(logging.NullHandler())  # what it says of each solid
    rows, figures = part("pictures", _pictures)
    figures += part(f"{HUGE} x {HUGE}", lambda: list(_huge()))
    figures += part("other programs", lambda: list(_judges()))
    head = (
        f"Reliefs {1000 * WIDTH_M:.0f} mm wide on a plate with a rim, a line of braille and a corner mark, to 0.05 mm. "
        f"Seconds of one processor from the relief to the file, median of {RUNS}. Error: at every node of the relief, "
        "by a rasteriser that made no mesh. Not smoothed: as stereo left it."
    )
    headings = ("relief", "nodes", "triangles", "STL MiB", "3MF MiB", "GLB MiB", "STL s", "largest error mm")
    return "\n".join([head, "", *table(headings, rows), "", *judged(figures)])


def _pictures() -> tuple[list[tuple[str, ...]], list[Figure]]:
    rows, figures = list[tuple[str, ...]](), list[Figure]()
    for name, work in _works().items():
        with tempfile.TemporaryDirectory() as folder:
            stem = Path(folder) / "solid"
            files = [cls().write(work, stem)[0] for cls in (Stl, ThreeMF, Glb)]
            mib = [f"{path.stat().st_size / 2**20:.1f}" for path in files]
            seconds = median(_seconds(work, stem) for _ in range(RUNS))
            mesh, error_mm = solids.read(files[0]), _error_mm(files[0], work)
        rows_, columns = work.relief.height_m.shape
        count = len(mesh.triangles)
        rows.append((name, f"{columns} x {rows_}", f"{count:,}", *mib, f"{seconds:.2f}", f"{error_mm:.4f}"))
        if name == "motorcycle, stereo":
            met = count <= MAX_TRIANGLES and seconds <= MAX_S
            bound = f"<= {MAX_TRIANGLES:,} triangles in <= {MAX_S} s"
            figures.append(Figure(f"{name}, {columns} x {rows_}", bound, f"{count:,} in {seconds:.2f} s", met))
        figures.append(Figure(f"{name}: largest error", "<= 0.05 mm", f"{error_mm:.4f} mm", error_mm <= 0.05))
        figures.append(_size(name, mesh, work))
    return rows, figures


def _size(name: str, mesh: solids.Mesh, work: Work) -> Figure:
    wide_mm = 1000 * work.relief.extent_m[0] + 12
    off = max(abs(mesh.vertices[:, 0].max() - wide_mm), np.abs(mesh.vertices.min(axis=0)).max())
    met = bool(off <= EXTENT_MM) and solids.is_closed(mesh)
    return Figure(f"{name}: closed, extent off by", "<= 1 um", f"{1000 * off:.2f} um", met)


def _seconds(work: Work, stem: Path) -> float:
    start = process_time()
    Stl().write(work, stem)
    return process_time() - start


def _error_mm(path: Path, work: Work) -> float:
    """At every node, with the plate's rim and a line of braille before the picture."""
    mesh = solids.read(path)
    length_mm = 1000 * work.relief.extent_m[1]
    x, y = solids.nodes(work, 6, mesh.vertices[:, 1].max() - 6 - length_mm)
    heights = solids.from_above(mesh, x, y)[::-1] - 1.5
    return float(np.abs(heights - 1000 * work.relief.height_m).max())


@cache
def _works() -> dict[str, Work]:
    stereo = Scene.builtin("motorcycle")
    size = Workspace(width_m=WIDTH_M, relief_m=0.01)
    rough = size.model_copy(update={"smooth_m": 0.0})
    astronaut = drawn_parts.drawn("astronaut")
    layered = Layering(astronaut.parts, WIDTH_M, HeightChoice(by="given"), astronaut.picture)
    portrait = Pipeline(Scene.photo(astronaut.picture), depth=Luminance(), workspace=Workspace(width_m=WIDTH_M))
    reliefs = {
        "motorcycle, stereo": (Pipeline(stereo, depth=SemiGlobal(), workspace=size).relief, stereo.views.left),
        "motorcycle, not smoothed": (Pipeline(stereo, depth=SemiGlobal(), workspace=rough).relief, stereo.views.left),
        "astronaut, luminance": (portrait.relief, astronaut.picture),
        "astronaut, drawn parts": (layered.relief(astronaut.heights_m), astronaut.picture),
    }
    return {name: Work("Picture", "en", {"relief": relief}, picture) for name, (relief, picture) in reliefs.items()}


def _huge() -> Iterator[Figure]:
    heights = cv2.resize(_works()["motorcycle, stereo"].relief.height_m, (HUGE, HUGE), interpolation=cv2.INTER_CUBIC)
    wave = np.sin(np.arange(HUGE, dtype=np.float32) * np.float32(2 * np.pi / 51))
    heights += np.float32(5e-5) * wave * wave[:, None]
    work = Work("Picture", "en", {"relief": Relief(np.maximum(heights, 0), (WIDTH_M, WIDTH_M))})
    del heights
    with tempfile.TemporaryDirectory() as folder:
        peak = start_peak()
        seconds = _seconds(work, Path(folder) / "huge")
        gib = (peak() or 0) / 2**30
        error_mm = _error_mm(Path(folder) / "huge.stl", work)
        count = (Path(folder) / "huge.stl").stat().st_size // 50
    what = f"{HUGE} x {HUGE}"
    yield Figure(f"{what}: {count:,} triangles, seconds", f"<= {HUGE_S:.0f} s", f"{seconds:.1f} s", seconds <= HUGE_S)
    yield Figure(f"{what}: memory beside the relief", f"<= {HUGE_GIB:.0f} GiB", f"{gib:.2f} GiB", 0 < gib <= HUGE_GIB)
    yield Figure(f"{what}: largest error", "<= 0.05 mm", f"{error_mm:.4f} mm", error_mm <= 0.05)


def _judges() -> Iterator[Figure]:
    with tempfile.TemporaryDirectory() as folder:
        for name, work in _works().items():
            (path,) = Stl().write(work, Path(folder) / "solid")
            yield _judge(f"{name}: repairs by admesh", "0", ["admesh", str(path)], _repairs)
            yield _judge(f"{name}: manifold, by PrusaSlicer", "yes", ["prusa-slicer", "--info", str(path)], _manifold)


def _judge(what: str, bound: str, command: list[str], found: Callable[[str], str]) -> Figure:
    if shutil.which(command[0]) is None:
        return Figure(what, bound, f"not measured: {command[0]} is not installed", False)
    measured = found(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return Figure(what, bound, measured, measured == bound)


def _repairs(told: str) -> str:
    lines = [line for line in told.splitlines() if line.startswith(REPAIRS)]
    return str(sum(int(line.split(":")[1].split()[0]) for line in lines)) if len(lines) == len(REPAIRS) else told


def _manifold(told: str) -> str:
    return next((line.partition(" = ")[2] for line in told.splitlines() if line.startswith("manifold")), "not said")
