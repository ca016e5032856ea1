"""Random films under random hands: what a film of `proxy` does at its worst, as the law has it and behind the guard."""

from collections.abc import Iterator
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float64
from numba import njit

from tangible_core.compiled.touch import RISE_M as RISE
from tangible_core.data import DeviceSpec, HapticSurface, Relief, TickFlag
from tangible_core.servo.guard import layout as at
from tangible_core.servo.guard.guard import guard
from tangible_core.servo.guard.safety import Safety
from tangible_render.proxy import Proxy

from .figures import Figure

DEVICE = DeviceSpec(8.0, 3000.0, 1.5, (0.08, 0.08, 0.08), 3e-5)
PERIOD_S, WIDTH_M = 0.001, 0.08
TICKS, TICKS_A_FILM = 10_000_000, 20_000
# A hand that went farther in a tick was put down there, and its account begins anew: sampling knows nothing of it.
PUT_DOWN_M = 0.001
STEP_N, GAIN_J, GAIN_SHARE = 0.08, 1e-2, 1e-4
"""What is allowed: of a force on a hand at rest; and of energy beyond what the surface did, once and as a share of all
work that was done back and forth, of which sampling loses track."""
DAMPED = int(TickFlag.DAMPED)
(NOT_FINITE, STEP, WORK, SURFACE, SIZE, MOVED, GAIN, TOUCHED, BRAKED, GUARDED, MAX_GUARDED, AT_REST) = range(12)
# What is kept of a film: figures, and the forces of the law and of the guard in the last tick.
FORCE, LEFT, FOUND = 12, 15, 18


class Worst(NamedTuple):
    """Of all ticks."""

    ticks: int
    touched: int
    not_finite: int
    step_n: float
    """The greatest step of the law's force on a hand that does not move."""
    gained_j: float
    """The most of what a hand had got and the spring held, over what the surface had done and is allowed besides."""
    moved_j: float
    """Work that surfaces did and took back."""
    guarded_j: float
    """The most that a hand had got behind the guard, over what a surface may do."""
    damped: float
    """Share of the ticks in which the guard braked."""


def figures() -> Iterator[Figure]:
    """Yield the demands over 1e7 ticks."""
    worst = stress(TICKS)
    told = f"{worst.ticks:.0e} ticks, {worst.touched:.0e} of them in contact"
    yield Figure(
        "forces that are not finite, over random films", "none", f"{worst.not_finite}; {told}", not worst.not_finite
    )
    yield Figure(
        "greatest step of the law's force on a hand at rest",
        "<= 0.08 N",
        f"{worst.step_n:.4f} N",
        worst.step_n <= 0.0801,
    )
    told = f"{1000 * worst.gained_j:.3g} mJ; surfaces did {worst.moved_j:.0f} J"
    yield Figure("gained over what the surface did and 1e-4 of all work", "<= 10 mJ", told, worst.gained_j <= GAIN_J)
    told = f"{1000 * worst.guarded_j:.3g} mJ; braked in {100 * worst.damped:.1f} % of the ticks"
    yield Figure("gained behind the guard over what a surface may do", "nothing", told, worst.guarded_j <= 0)


def stress(ticks: int, seed: int = 0) -> Worst:
    """Yield the worst of the films, a new one every 20000 ticks."""
    random = np.random.default_rng(seed)
    worst, done = Worst(0, 0, 0, 0.0, -np.inf, 0.0, -np.inf, 0.0), 0
    while done < ticks:
        count = min(TICKS_A_FILM, ticks - done)
        worst = _worse(worst, _film(random, count))
        done += count
    return worst


def _worse(a: Worst, b: Worst) -> Worst:
    ticks = a.ticks + b.ticks
    return Worst(
        ticks,
        a.touched + b.touched,
        a.not_finite + b.not_finite,
        max(a.step_n, b.step_n),
        max(a.gained_j, b.gained_j),
        a.moved_j + b.moved_j,
        max(a.guarded_j, b.guarded_j),
        (a.damped * a.ticks + b.damped * b.ticks) / ticks,
    )


def _film(random: np.random.Generator, ticks: int) -> Worst:
    """One film under one hand; frames at any phase, some of them never gone to."""
    shape = tuple(random.integers(16, 65, 2).tolist())
    high_m = float(random.choice([0.002, 0.006, 0.02]))
    static = float(random.choice([0.0, 0.0, 0.6]))
    law = Proxy(
        stiffness_n_per_m=float(random.choice([200.0, 800.0, 2500.0])),
        damping_n_s_per_m=float(random.choice([0.0, 0.0, 1.0])),
        static_friction=static,
        dynamic_friction=0.6 * static,
    )
    scene = _scene(random, shape, high_m)
    surface = HapticSurface.from_heights(next(scene), WIDTH_M)
    film = law.film(surface, PERIOD_S)
    held = random.random() < 0.4
    hands = _held(random, surface, ticks) if held else _loops(random, surface, ticks)
    settings, memory = Safety(ramp_s=0, passivity="strict").arrays(DEVICE, law.stiffness_n_per_m)
    touch, found, first, frame = cast(Any, film.touch), np.zeros(FOUND), 0, 0
    found[GAIN] = -np.inf
    while first < ticks:
        last = min(first + int(random.integers(1, 90)), ticks)
        walk(
            touch.fixed,
            touch.address(),
            touch.moving,
            settings,
            memory,
            hands,
            first,
            last,
            law.stiffness_n_per_m,
            found,
        )
        film.show(Relief(next(scene), surface.extent_m), frame := frame + 1)
        first = last
    may_j = settings[at.MAX_SURFACE_J] + settings[at.SURFACE_W] * ticks * PERIOD_S
    return Worst(
        ticks,
        int(found[TOUCHED]),
        int(found[NOT_FINITE]),
        found[STEP],
        found[GAIN] - GAIN_SHARE * found[SIZE],
        found[MOVED],
        found[MAX_GUARDED] - may_j,
        found[BRAKED] / ticks,
    )


@njit(nogil=True)
def walk(fixed, tick, moving, settings, memory, hands, first, last, stiffness, found):
    """Ticks along a path of the hand, and their work: the law's by the trapezoidal rule, the guard's as it is held."""
    for i in range(first, last):
        x, y, z = hands[i, 0], hands[i, 1], hands[i, 2]
        before = hands[max(i - 1, 0)]
        dx, dy, dz = x - before[0], y - before[1], z - before[2]
        put_down = dx * dx + dy * dy + dz * dz > PUT_DOWN_M * PUT_DOWN_M
        at_rest = 0.0 if dx != 0.0 or dy != 0.0 or dz != 0.0 else found[AT_REST] + 1.0
        found[AT_REST] = at_rest
        vx, vy, vz = (0.0, 0.0, 0.0) if put_down else (dx / PERIOD_S, dy / PERIOD_S, dz / PERIOD_S)
        fx, fy, fz = tick(*fixed, x, y, z, vx, vy, vz)
        memory[at.RISE_M] = moving[RISE]
        gx, gy, gz, flags = guard(settings, memory, PERIOD_S, x, y, z, vx, vy, vz, fx, fy, fz)
        found[NOT_FINITE] += not np.isfinite(fx + fy + fz + gx + gy + gz + moving[RISE])
        found[TOUCHED] += fx != 0.0 or fy != 0.0 or fz != 0.0
        found[BRAKED] += flags & DAMPED != 0
        px, py, pz = found[FORCE], found[FORCE + 1], found[FORCE + 2]
        held_j = (fx * fx + fy * fy + fz * fz) / (2.0 * stiffness)
        if put_down or i == 0:  # a new account: what the spring holds it was given by the one who put the hand down
            found[WORK], found[SURFACE] = -held_j, 0.0
            found[GUARDED] = 0.0
        else:
            work_j = 0.5 * ((px + fx) * dx + (py + fy) * dy + (pz + fz) * dz)
            surface_j = 0.5 * (pz + fz) * moving[RISE]
            found[WORK] += work_j
            found[SURFACE] += surface_j
            found[SIZE] += abs(work_j) + abs(surface_j)
            found[MOVED] += abs(surface_j)
            found[GAIN] = max(found[GAIN], found[WORK] - found[SURFACE] + held_j)
            found[GUARDED] += found[LEFT] * dx + found[LEFT + 1] * dy + found[LEFT + 2] * dz
            found[MAX_GUARDED] = max(found[MAX_GUARDED], found[GUARDED])
            if at_rest > 1.0:
                step_n = np.sqrt((fx - px) ** 2 + (fy - py) ** 2 + (fz - pz) ** 2)
                found[STEP] = max(found[STEP], step_n)
        found[FORCE], found[FORCE + 1], found[FORCE + 2] = fx, fy, fz
        found[LEFT], found[LEFT + 1], found[LEFT + 2] = gx, gy, gz


def _held(random: np.random.Generator, surface: HapticSurface, ticks: int) -> Float64[np.ndarray, "n 3"]:
    """Return a hand that is put down somewhere over or in the block, and stays for a while."""
    half_m, high_m = np.array(surface.extent_m) / 2, float(surface.height_m.max())
    places = random.uniform((*-half_m, -0.002), (*half_m, high_m + 0.001), (ticks // 1000 + 2, 3))
    return places[np.minimum(np.cumsum(random.random(ticks) < 1 / 1500), len(places) - 1)]


def _loops(random: np.random.Generator, surface: HapticSurface, ticks: int) -> Float64[np.ndarray, "n 3"]:
    """Return a closed path over and over: within the borders or beyond them, shallow or deep, slow or fast."""
    half_m, high_m = np.array(surface.extent_m) / 2, float(surface.height_m.max())
    beyond, deep, turn_s = random.choice([0.7, 1.1]), random.choice([0.1, 0.5]), random.choice([0.5, 2.0, 8.0])
    turn = 2 * np.pi * PERIOD_S / turn_s * np.arange(ticks)
    waves = [np.sin(number * turn + random.uniform(0, 7)) for number in random.permutation([1, 2, 3])]
    return np.column_stack(
        [beyond * half_m[0] * waves[0], beyond * half_m[1] * waves[1], high_m * (0.5 + deep * waves[2]) - 0.001]
    )


def _scene(random: np.random.Generator, shape: tuple[int, ...], high_m: float) -> Iterator[np.ndarray]:
    """Reliefs without end: one that drifts, one that breathes, or another one each time, rough or smooth."""
    row, column = np.indices(shape)
    kind, hertz = random.choice(["drifts", "breathes", "cuts", "noise"]), random.uniform(0.2, 8)
    waves = random.normal(0, 0.3, (4, 2)), random.uniform(0, 7, 4), random.normal(0, 1, 4)
    level, frame = random.uniform(0, 0.5), 0
    while True:
        frame += 1
        if kind == "cuts":
            waves = random.normal(0, 0.3, (4, 2)), random.uniform(0, 7, 4), random.normal(0, 1, 4)
            level = random.uniform(-0.5, 0.9)
        shift = 0.3 * frame if kind == "drifts" else 0.0
        found = (
            sum(
                high * np.sin(across * (column + shift) + down * row + phase)
                for (across, down), phase, high in zip(*waves, strict=True)
            )
            / 8
            + 0.5
        )
        if kind == "breathes":
            found = found + 0.3 * np.sin(2 * np.pi * hertz * frame / 30)
        if kind == "noise":
            found = random.uniform(0, 1, shape) ** random.integers(1, 9)
        steps = found * (found > level) if kind == "cuts" else found
        yield np.asarray(np.clip(steps, 0, 1) * high_m, np.float32)
