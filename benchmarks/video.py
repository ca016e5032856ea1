"""Moving pictures: frames a second, what they cost the force loop, flicker, memory.

TANGIBLE_MINUTES (10) is how long memory is watched, TANGIBLE_SLICES (3) how often frames are counted.
"""

import os
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from tangible_core import Pipeline, Scene
from tangible_core.data import ServoReport
from tangible_core.pipeline.feeling import Feeling
from tangible_core.runtime.threads import limited_threads
from tangible_core.servo import Safety, Servo
from tangible_core.session import Slot, run_kiosk
from tangible_core.session.film import Steady
from tangible_depth import SemiGlobal
from tangible_render import Proxy

from . import video_stress
from .figures import Figure, judged, part
from .servo_rounds import Round, no_later_figure
from .tests_path import Circling, films
from .ui_late import ROUND_S, ROUNDS

MINUTES, SLICES = (
    float(os.environ.get(name, kept)) for name, kept in (("TANGIBLE_MINUTES", 10), ("TANGIBLE_SLICES", 3))
)
SLICE_S = 10.0
BOUNDS = {(320, 240): (80.0, 9.0, 120.0), (640, 480): (30.0, 27.0, 60.0)}
"""Frames a second at least, milliseconds of a processor for one at most, and frames a second of the file, by size."""
MAX_GROWN_MB = 10.0


def section() -> str:
    """Return the section as Markdown."""
    parts: dict[str, Callable[[], Iterator[Figure]]] = {
        "frames a second": _rates,
        "lateness": _lateness,
        "flicker": _steadiness,
        "random films": video_stress.figures,
        f"memory over {MINUTES:g} minutes": _memory,
    }
    found = [figure for name, work in parts.items() for figure in part(name, lambda work=work: list(work()))]
    head = (
        "A camera moves past the motorcycle, side by side, with noise; `semi-global` with `resolution: half`, the rest "
        "as it is by default. Frames are decoded, matched, made steady and shown to a loop in another process that "
        "ticks at 1 kHz, one processor left to it. Milliseconds: of the processor, one thread."
    )
    return "\n".join([head, "", *judged(found)])


def _pipeline(folder: Path, size: tuple[int, int], fps: float, **scene: Any) -> Pipeline:
    path = folder / f"{size[0]}-{fps:g}.avi"
    if not path.exists():
        _write(path, size, fps)
    made = Scene.video(path, layout="side-by-side", **scene)
    return Pipeline(made, depth=SemiGlobal(resolution="half"), render=Proxy(), cached=False)


def _write(path: Path, size: tuple[int, int], fps: float) -> None:
    from skimage.data import stereo_motorcycle

    (width, height), generator = size, np.random.default_rng(0)
    margin = width // 10
    pair = [
        cv2.resize(each, (width + margin, height), interpolation=cv2.INTER_AREA) for each in stereo_motorcycle()[:2]
    ]
    out = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), fps, (2 * width, height))
    for number in range(180):
        at = round(margin * (0.5 + 0.5 * np.sin(2 * np.pi * number / 180)))
        frame = np.hstack([each[:, at : at + width] for each in pair]) + generator.normal(0, 2, (height, 2 * width, 3))
        out.write(np.clip(frame, 0, 255).astype(np.uint8)[..., ::-1])
    out.release()


def _cost_ms(pipeline: Pipeline, frames: int = 100) -> float:
    """Of the processor, to read, match, steady and show a frame: one after the other, none left out."""
    film = Feeling(pipeline).film()
    with Feeling(pipeline).reliefs as reliefs, limited_threads(1):
        for number, _, relief in islice(reliefs, 10):
            film.show(relief, number)
        begun_s = time.process_time()
        for number, _, relief in islice(reliefs, frames):
            film.show(relief, number)
        return 1e3 * (time.process_time() - begun_s) / frames


def _played(
    pipeline: Pipeline,
    seconds: float,
    playing: bool = True,
    on_start: Callable[[Servo], None] | None = None,
    on_report: Callable[[ServoReport], None] | None = None,
) -> ServoReport:
    """Return a session of a film on a device without Python; of its first frame alone, if it is not to play."""
    turn = Slot(Feeling(pipeline).film(), Safety(), reliefs=(lambda: Feeling(pipeline).reliefs) if playing else None)
    return run_kiosk([turn], Circling(), seconds, on_start=on_start, on_report=on_report)


def _rates() -> Iterator[Figure]:
    with tempfile.TemporaryDirectory() as folder:
        for size, (least, most_ms, fps) in BOUNDS.items():
            pipeline = _pipeline(Path(folder), size, fps)
            _played(pipeline, 3.0)  # whatever is compiled
            reports = [_played(pipeline, SLICE_S) for _ in range(round(SLICES))]
            played = [report.film for report in reports if report.film is not None]
            rate, cost = statistics.median(each.per_s for each in played), _cost_ms(pipeline)
            age = statistics.median(each.age_ms or 0.0 for each in played)
            name = f"{size[0]} x {size[1]} at {fps:g} a second, from file to surface beside a loop"
            said = f"{rate:.0f} frames/s, felt {age:.0f} ms after they are due"
            yield Figure(name, f">= {least:g} frames/s", said, rate >= least)
            yield Figure(f"{size[0]} x {size[1]}, a frame", f"<= {most_ms:g} ms", f"{cost:.1f} ms", cost <= most_ms)


def _lateness() -> Iterator[Figure]:
    """Yield the same loop with a film that plays and one that stands, in turn: any machine has its spells."""
    late = {True: list[Round](), False: list[Round]()}
    with tempfile.TemporaryDirectory() as folder:
        pipeline = _pipeline(Path(folder), (640, 480), 30.0)
        _played(pipeline, 3.0)
        for number in range(ROUNDS):
            for playing in (True, False) if number % 2 else (False, True):
                servos = list[Servo]()
                _played(pipeline, ROUND_S, playing, servos.append)
                late[playing].append(Round.of(servos[0].ring))
    yield no_later_figure("640 x 480 at 30 frames/s", late[True], late[False])


def _steadiness() -> Iterator[Figure]:
    """Yield a box walks over a ground, both known exactly, with noise that is new in each frame."""
    generator, steady, count = np.random.default_rng(3), Steady(), 45
    shape = (240, 320)
    method = SemiGlobal(resolution="half", min_disparity_px=0, max_disparity_px=32)
    found = [method.estimate(films.layered(number, 4.0, generator, shape)) for number in range(count)]
    seconds, felt = time.process_time(), list[np.ndarray]()
    felt = [steady.next(each).disparity.disparity_px for each in found]
    took_ms = 1e3 * (time.process_time() - seconds) / count
    raw, out = np.stack([each.disparity_px for each in found]), np.stack(felt)
    true = np.stack([films.true_disparity(number, shape) for number in range(count)])
    still = (true == true[0]).all(axis=0)
    flicker = [float(np.diff(each[10:], axis=0)[:, still].std()) for each in (raw, out)]
    wrong = [float((np.abs(each - true)[10:, still] > 2).mean()) for each in (raw, out)]
    told = f"{flicker[0]:.3f} -> {flicker[1]:.3f} px a frame"
    yield Figure("flicker where nothing moves", "halved", told, flicker[1] <= 0.5 * flicker[0])
    told = f"{100 * wrong[0]:.2f} -> {100 * wrong[1]:.2f} % off by more than 2 px"
    yield Figure("wrong there", "not more", told, wrong[1] <= wrong[0])
    late = [np.abs(each - true) > 2 for each in (raw, out)]
    late[1] &= np.abs(out - np.roll(true, 1, axis=0)) > 2
    moved = ~still
    ghosts = [float(each[10:, moved].mean()) for each in late]
    told = f"{100 * ghosts[1]:.1f} % are neither this frame nor the one before; {100 * ghosts[0]:.1f} % as matched"
    yield Figure("where the box passes", "a frame late at most, no ghosts", told, ghosts[1] <= ghosts[0] + 0.005)
    yield Figure("to steady a map of 320 x 240", "<= 1 ms", f"{took_ms:.2f} ms", took_ms <= 1.0)


def _memory() -> Iterator[Figure]:
    import psutil

    seen = list[tuple[float, float]]()

    servos = list[Servo]()

    def look(_: ServoReport) -> None:
        if len(seen) < len(marks) and time.monotonic() - begun_s >= marks[len(seen)]:
            here, there = (psutil.Process(pid).memory_info().rss / 2**20 for pid in (os.getpid(), servos[0].process_id))
            seen.append((here, there))

    with tempfile.TemporaryDirectory() as folder:
        pipeline = _pipeline(Path(folder), (640, 480), 30.0)
        marks = [60 * MINUTES * share for share in (0.2, 0.4, 0.6, 0.8, 0.97)]
        begun_s = time.monotonic()
        report = _played(pipeline, 60 * MINUTES, on_start=servos.append, on_report=look)
    grown = [seen[-1][which] - seen[0][which] for which in (0, 1)]
    film = report.film
    assert film is not None
    told = f"{grown[0]:+.1f} MB where frames are made, {grown[1]:+.1f} MB in the loop; {film.shown} frames"
    yield Figure(f"memory, {MINUTES:g} minutes", f"<= {MAX_GROWN_MB:g} MB", told, max(grown) <= MAX_GROWN_MB)
