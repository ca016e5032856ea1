"""Checks of a touch as software: paths, repetition, hostile states, unusual surfaces, materials."""

from dataclasses import replace
from itertools import product

import numpy as np
from jaxtyping import Float64

from ...data import NO_FORCE, DeviceSpec, HapticState, HapticSurface, Material
from ...plugins.interfaces import ForceRenderer
from ...servo.guard.stiffness import slopes
from ..checks import Check, checks_in, demand
from ..synthetic.scenes import KnownSurface, plane, sphere_cap

PERIOD_S = 0.001
ROUNDING_N_PER_M = 0.1  # error of a stiffness that is measured by differences of forces
# A device like the Novint Falcon, in whose workspace the stiffness is measured.
DEVICE = DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.1, 0.1), 1e-6, simulated=True)
HOSTILE = (0.0, -0.0, 1e-310, 0.01, -0.03, 5.0, 1e30, -1e300, 1.7e308, np.inf, -np.inf, np.nan)


def broken_state_gives_no_force(method: ForceRenderer) -> None:
    """Check that a position that is NaN or infinite gives zero force: a device that fails must not push."""
    scene = plane()
    x, y, z = scene.at(0, 0, 0.001)
    for bad in (np.nan, np.inf, -np.inf):
        for position in ((bad, y, z), (x, bad, z), (x, y, bad)):
            force = method.touch(scene.surface).force(HapticState(position))
            demand(tuple(force) == NO_FORCE, f"at {position} the force is {force}, not zero")


def path_is_force_by_force(method: ForceRenderer) -> None:
    """Check that `path` gives the same forces as `force` for each position: a study of a path holds for a device."""
    scene = sphere_cap()
    path = _path(scene)
    together, touch = method.touch(scene.surface).path(path, PERIOD_S), method.touch(scene.surface)
    demand(together.shape == path.shape, f"{path.shape} positions give {together.shape} forces")
    singly = np.array([touch.force(state) for state in _states(path)])
    demand(np.isfinite(together).all(), "a force along the path is not finite")
    apart = np.abs(together - singly).max(axis=1)
    worst = int(apart.argmax())
    demand(
        apart[worst] <= 1e-6 * (1 + np.abs(singly).max()),
        f"at step {worst}, {path[worst]}, path gives {together[worst]} N and force {singly[worst]} N",
    )
    nothing = method.touch(scene.surface).path(path[:0], PERIOD_S)
    demand(nothing.shape == (0, 3), f"a path of no positions gives {nothing.shape} forces")


def same_path_same_forces(method: ForceRenderer) -> None:
    """Check that two touches of a surface along one path agree to the last bit: random numbers must be seeded."""
    scene = sphere_cap()
    first, second = (method.touch(scene.surface).path(_path(scene), PERIOD_S) for _ in range(2))
    demand(first.tobytes() == second.tobytes(), "the same path gives different forces the second time")


def touches_are_apart(method: ForceRenderer) -> None:
    """Check that touches are independent: a new one starts without contact, and two do not affect each other."""
    scene = sphere_cap()
    states = _states(_path(scene))
    alone, busy, quiet = (method.touch(scene.surface) for _ in range(3))
    for state in states:
        busy.force(HapticState(scene.at(0.02, -0.02, 0.004), (0.1, 0.1, -0.1), state.time_s))
        first_force, second_force = alone.force(state), quiet.force(state)
        demand(
            tuple(second_force) == tuple(first_force),
            f"next to another touch {state} gives {second_force}, alone {first_force}",
        )
    new, first = method.touch(scene.surface).force(states[0]), method.touch(scene.surface).path(_path(scene)[:1])
    demand(tuple(new) == tuple(first[0].tolist()), f"a new touch gives {new}, an earlier one gave {first[0].tolist()}")


def surface_is_not_written_to(method: ForceRenderer) -> None:
    """Check that a touch does not change its surface: the device, the report and the cache read it too."""
    surface = _patchwork()
    before = surface.digest()
    method.touch(surface).path(_path(plane()), PERIOD_S)
    demand(surface.digest() == before, "touching writes to the surface; work on a copy")


def forces_are_always_finite(method: ForceRenderer) -> None:
    """Check that huge, tiny, infinite and NaN positions, velocities and times, and leaps, give finite forces."""
    random = np.random.default_rng(0)
    scene = sphere_cap()
    touch = method.touch(scene.surface)
    for _ in range(1000):
        position, velocity = random.choice(HOSTILE, (2, 3)).tolist()
        state = HapticState(tuple(position), tuple(velocity), float(random.choice(HOSTILE)))
        force = touch.force(state)
        demand(np.isfinite(force).all(), f"{state} gives {force}")
    forces = method.touch(scene.surface).path(random.choice(HOSTILE, (1000, 3)), PERIOD_S)
    demand(np.isfinite(forces).all(), "a path of leaps gives a force that is not finite")


def any_surface_is_taken(method: ForceRenderer) -> None:
    """Check that forces are finite, and 0 above the surface, for one cell, row or column, a plane at 0 and a spike."""
    spike = np.zeros((9, 9), np.float32)
    spike[4, 4] = 0.01
    flat = [np.full(shape, height, np.float32) for shape in ((1, 1), (1, 9), (9, 1), (5, 7)) for height in (0.0, 0.01)]
    for heights in (*flat, spike):
        touch = method.touch(HapticSurface.from_heights(heights))
        name = f"a surface of {heights.shape} cells, {heights.max():g} m high"
        above = touch.force(HapticState((0.0, 0.0, 0.011)))
        demand(tuple(above) == NO_FORCE, f"over {name}: {above}")
        places = product((0.0, 0.004, 0.04, 0.1), (0.005, 0.0, -0.005))
        forces = np.array([touch.force(HapticState((x, 0.0, z))) for x, z in places])
        demand(np.isfinite(forces).all(), f"a force on {name} is not finite")


def materials_are_taken(method: ForceRenderer) -> None:
    """Check that forces are finite and never pull on two materials, one soft and frictionless, one hard and rough."""
    touch = method.touch(_patchwork())
    rest = np.array([touch.force(HapticState((x, 0.0, 0.009))) for x in (-0.02, 0.02)])
    demand(np.isfinite(rest).all() and (rest[:, 2] >= 0).all(), f"resting on two materials gives {rest.tolist()} N")
    stroke = np.column_stack([np.linspace(-0.03, 0.03, 400), np.zeros(400), np.full(400, 0.0095)])
    demand(np.isfinite(touch.path(stroke, PERIOD_S)).all(), "a stroke over two materials is not finite")


def stiffness_is_no_less_than_felt(method: ForceRenderer) -> None:
    """Check that the stiffness which a force law states is at least the measured one, within 10 %, on level ground."""
    for name, surface in (("a plane", plane().surface), ("a plane of two materials", _patchwork(rough=False))):
        # By the stated stiffness the guard softens a force law that is too stiff for a device; without one, it
        # measures.
        touch = method.touch(surface)
        if (stated := touch.stiffness_n_per_m) is not None:
            steepest = max(slopes(touch, DEVICE), default=0.0)
            demand(
                steepest <= 1.1 * stated + ROUNDING_N_PER_M,
                f"on {name} {steepest:.4g} N/m are measured, but {stated:.4g} stated; state the true value, or None",
            )


def _path(scene: KnownSurface) -> Float64[np.ndarray, "n 3"]:
    """Return a wavy stroke in and out of contact, with a leap, a NaN and a standstill in it."""
    turns = np.linspace(0, 6 * np.pi, 300)
    places = zip(0.02 * np.cos(turns / 3), 0.02 * np.sin(turns / 2), 0.001 * np.sin(turns), strict=True)
    path = np.array([scene.at(float(x), float(y), float(depth)) for x, y, depth in places])
    path[120] = scene.at(-0.03, 0.03, 0.003)
    path[180] = np.nan
    path[240:260] = path[240]
    return path


def _states(path: Float64[np.ndarray, "n 3"]) -> list[HapticState]:
    steps = np.diff(path, axis=0, prepend=path[:1]) / PERIOD_S
    steps[~np.isfinite(steps).all(axis=1)] = 0
    return [
        HapticState((x, y, z), (vx, vy, vz), tick * PERIOD_S)
        for tick, ((x, y, z), (vx, vy, vz)) in enumerate(zip(path.tolist(), steps.tolist(), strict=True))
    ]


def _patchwork(rough: bool = True) -> HapticSurface:
    labels = np.zeros((32, 64), np.int32)
    labels[:, 32:] = 1
    soft = Material("soft", 200.0, 0.0, 0.0, 0.0)
    smooth = Material("hard", 2000.0, 2.0, 0.9, 0.6)
    hard = replace(smooth, roughness_m=2e-4, grain_m=2e-3) if rough else smooth
    return HapticSurface.from_heights(np.full((32, 64), 0.01, np.float32), 0.08, labels, (soft, hard))


CHECKS: tuple[Check, ...] = checks_in(__name__)
