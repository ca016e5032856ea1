"""Checks of a force law that supports surfaces that move, felt by a hand on a given path; other force laws pass."""

import gc
import pickle
import tracemalloc

import numpy as np
from jaxtyping import Float32

from ...compiled.touch import FRAME, RISE_M, CompiledTouch
from ...data import HapticState, HapticSurface, Relief
from ...errors import ConfigError, GeometryError
from ...plugins.interfaces import Film, Filming, ForceRenderer
from ..checks import Check, checks_in, demand, refuses

PERIOD_S, FRAME_S, TICKS = 0.001, 1 / 30, 33
WIDTH_M, MIDDLE_M = 0.08, 0.008
STEP_N = 0.08
HAND_M = (0.0031, -0.0052, 0.006)  # position of a hand about two millimetres under the surfaces


def film_begins_as_a_touch(method: ForceRenderer) -> None:
    """Check that a film without a frame feels like a touch on the same surface, and reports no rise."""
    if not isinstance(method, Filming):
        return
    surface = _surface(0)
    film, path = method.film(surface, PERIOD_S, FRAME_S), _circle()
    apart = np.abs(film.touch.path(path) - method.touch(surface).path(path)).max()
    demand(apart <= 1e-2, f"before the first frame, film and touch are {apart:.3g} N apart")
    demand(film.arrived and film.dropped == 0, "before the first frame, it has not arrived, or dropped frames")
    demand(_moving(film)[RISE_M] == 0.0, "before the first frame, it reports a rise")


def film_arrives_where_a_touch_is(method: ForceRenderer) -> None:
    """Check that a relief shown is reached within a frame, feels like a touch on it, and has its number reported."""
    if not isinstance(method, Filming):
        return
    film, path = method.film(_surface(0), PERIOD_S, FRAME_S), _circle()
    for frame in (1, 2, 3):
        film.show(_relief(frame), frame)
        _hold(film, TICKS + 1)
        demand(film.arrived, f"frame {frame} is not reached within a frame, though it is near")
        demand(_moving(film)[FRAME] == frame, f"on the way to frame {frame}, it reports {_moving(film)[FRAME]}")
    target = HapticSurface(_relief(3))
    apart = np.abs(film.touch.path(path) - method.touch(target).path(path))[len(path) // 2 :].max()
    demand(apart <= 1e-2, f"once arrived, film and touch are {apart:.3g} N apart")


def film_does_not_jump(method: ForceRenderer) -> None:
    """Check that the force on a hand at rest changes by 0.08 N a tick at most, over cuts, at any phase of a frame."""
    if not isinstance(method, Filming):
        return
    random = np.random.default_rng(0)
    film = method.film(_surface(0), PERIOD_S, FRAME_S)
    _hold(film, 200)
    forces = [_hold(film, 1)]
    for frame in range(60):
        film.show(_relief(0, random.uniform(0, 0.02, (24, 32)) if frame % 2 else None), frame)
        forces.append(_hold(film, int(random.integers(1, 60))))
    steps = np.linalg.norm(np.diff(np.vstack(forces), axis=0), axis=1)
    demand(np.isfinite(steps).all(), "a force is not finite")
    demand(steps.max() <= STEP_N + 1e-9, f"the force on a hand at rest steps by {steps.max():.3g} N")


def film_tells_its_rise(method: ForceRenderer) -> None:
    """Check that the rise of level ground that the film reports, tick by tick, is that of the ground."""
    if not isinstance(method, Filming):
        return
    film = method.film(_level(MIDDLE_M), PERIOD_S, FRAME_S)
    pushes = [_hold(film, 1)[0, 2]]
    rose_m = 0.0
    for frame, height_m in enumerate((0.0095, 0.0095, 0.0071, 0.0068)):
        film.show(_level(height_m).relief, frame)
        for _ in range(TICKS):
            pushes.append(_hold(film, 1)[0, 2])
            rose_m += float(_moving(film)[RISE_M])
        demand(abs(MIDDLE_M + rose_m - height_m) <= 1e-7, f"at {height_m} m it reports a rise of {rose_m} m")
    demand(np.ptp(pushes) > 0, "ground that rises and falls does not change the force")


def film_takes_odd_reliefs(method: ForceRenderer) -> None:
    """Check that forces stay finite for one cell, row or column, level ground, a spike and steps of any height."""
    if not isinstance(method, Filming):
        return
    for shape in ((1, 1), (1, 30), (30, 1), (2, 2), (20, 20)):
        film = method.film(HapticSurface(Relief(np.zeros(shape, np.float32), (WIDTH_M, 0.05))), PERIOD_S, FRAME_S)
        for frame, high_m in enumerate((0.0, 0.02, 3e38, 1e-40, 0.001)):
            heights = np.zeros(shape, np.float32)
            heights[shape[0] // 2, shape[1] // 2] = high_m
            film.show(Relief(heights, (WIDTH_M, 0.05)), frame)
            for place in (HAND_M, (0.0, 0.0, -0.001), (0.0, 0.0, 1e30), (np.nan, 0.0, 0.0)):
                force = np.array([film.touch.force(HapticState(place)) for _ in range(40)])
                demand(np.isfinite(force).all(), f"{shape[1]} x {shape[0]} cells, {high_m} m high: {force[-1]} N")


def film_refuses_what_does_not_fit(method: ForceRenderer) -> None:
    """Check that another grid or extent, and an invalid period or frame, are refused without a change of the film."""
    if not isinstance(method, Filming):
        return
    film = method.film(_surface(0), PERIOD_S, FRAME_S)
    before = _hold(film, 100)[-1]
    for name, heights, width_m in (
        ("another grid", np.zeros((24, 31), np.float32), WIDTH_M),
        ("another extent", np.zeros((24, 32), np.float32), 0.1),
    ):
        relief = Relief(heights, (width_m, 0.06))
        refuses(GeometryError, name, lambda relief=relief: film.show(relief, 1))
    for bad in (0.0, -1.0, np.nan, np.inf):
        refuses(ConfigError, f"a period of {bad} s", lambda bad=bad: method.film(_surface(0), bad, FRAME_S))
        refuses(ConfigError, f"a frame of {bad} s", lambda bad=bad: method.film(_surface(0), PERIOD_S, bad))
    demand(
        np.allclose(_hold(film, TICKS)[-1], before, rtol=0, atol=1e-6), "a relief that was refused changes the force"
    )


def film_can_be_handed_over(method: ForceRenderer) -> None:
    """Check that two unpickled films with shared arrays act as one: one is shown a relief, the other feels it."""
    if not isinstance(method, Filming):
        return
    film, buffers = method.film(_surface(0), PERIOD_S, FRAME_S), list[pickle.PickleBuffer]()
    small = pickle.dumps(film, 5, buffer_callback=buffers.append)
    arrays = [bytearray(buffer.raw()) for buffer in buffers]
    other, shower = (pickle.loads(small, buffers=arrays) for _ in range(2))
    before = _hold(other, 100)[-1]
    shower.show(_relief(2), 7)
    change = np.abs(_hold(other, TICKS)[-1] - before).max()
    demand(change > 0.1, "a relief shown in one process does not change the force in the other")
    demand(_moving(other)[FRAME] == 7, f"it was shown frame 7, and reports {_moving(other)[FRAME]}")
    same = np.allclose(_hold(film, TICKS)[-1], before, rtol=0, atol=1e-6)
    demand(same, "a relief shown to a copy changes the force of the original")


def film_needs_no_more_memory(method: ForceRenderer) -> None:
    """Check that frames, reached or dropped, take no more and more memory, and that dropped ones are counted."""
    if not isinstance(method, Filming):
        return
    film, reliefs = method.film(_surface(0), PERIOD_S, FRAME_S), [_relief(frame) for frame in range(4)]
    for frame in range(8):
        film.show(reliefs[frame % 4], frame)
        _hold(film, 20)
    before, sizes = film.dropped, list[int]()
    tracemalloc.start()
    try:
        for frame in range(8, 308):
            film.show(reliefs[frame % 4], frame)
            if frame % 100 == 7:
                gc.collect()
                sizes.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    demand(sizes[-1] - sizes[-2] < 20_000, f"100 frames leave {sizes[-1] - sizes[-2]} bytes behind")
    before = film.dropped - before
    demand(299 <= before <= 300, f"of 300 frames at once it reports {before} as dropped")


def _surface(frame: int) -> HapticSurface:
    return HapticSurface(_relief(frame))


def _level(height_m: float) -> HapticSurface:
    return HapticSurface(_relief(0, np.full((24, 32), height_m)))


def _relief(frame: int, heights: np.ndarray | None = None) -> Relief:
    """Return waves that move a little from frame to frame, or these heights."""
    row, column = np.indices((24, 32))
    waves = MIDDLE_M + 0.001 * np.sin(column / 4 + 0.3 * frame) * np.cos(row / 5)
    height_m: Float32[np.ndarray, "h w"] = np.asarray(waves if heights is None else heights, np.float32)
    return Relief(height_m, (WIDTH_M, 0.06))


def _circle() -> np.ndarray:
    turn = np.linspace(0, 2 * np.pi, 600)
    return np.column_stack([0.02 * np.cos(turn), 0.02 * np.sin(turn), np.full(600, HAND_M[2])])


def _hold(film: Film, ticks: int) -> np.ndarray:
    return np.array([film.touch.force(HapticState(HAND_M)) for _ in range(ticks)])


def _moving(film: Film) -> np.ndarray:
    """Return the array in which the film's touch reports its frame and its rise."""
    demand(isinstance(film.touch, CompiledTouch), "the touch of a film is not a CompiledTouch: it cannot report a rise")
    assert isinstance(film.touch, CompiledTouch)
    return film.touch.moving


CHECKS: tuple[Check, ...] = checks_in(__name__)
