"""Checks of a force law: the size and direction of its force, and where it pushes."""

from itertools import product

import numpy as np
from jaxtyping import Float64

from ...data import NO_FORCE, HapticState
from ...plugins.interfaces import ForceRenderer
from ..checks import Check, checks_in, demand
from ..synthetic.scenes import KnownSurface, plane, ramp, sphere_cap

# Points well inside the surfaces, on no line of symmetry but the first.
PLACES_M = ((0.0, 0.0), (0.011, 0.007), (-0.017, 0.012), (0.006, -0.021), (-0.013, -0.009))
DEPTHS_M = (0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005)


def free_air_is_free(method: ForceRenderer) -> None:
    """Check that there is no force above the surface, near it or far, moving or at rest."""
    for name, scene in _scenes():
        touch = method.touch(scene.surface)
        for (x, y), up, speed in product(PLACES_M, (1e-4, 0.01, 1.0), (0.0, -0.5)):
            force = touch.force(HapticState(scene.at(x, y, -up), (speed, 0.0, speed)))
            demand(tuple(force) == NO_FORCE, f"{up * 1000:g} mm above the {name} at ({x}, {y}) m: {force}")


def plane_pushes_straight_up(method: ForceRenderer) -> None:
    """Check that on a level plane a force at rest has no sideways part, never pulls and never falls with depth."""
    scene = plane()
    for x, y in PLACES_M:
        forces = np.array([_press(method, scene, x, y, depth) for depth in DEPTHS_M])
        demand(np.isfinite(forces).all(), f"not every force at ({x}, {y}) m is finite: {forces.tolist()}")
        sideways = np.abs(forces[:, :2]).max()
        demand(sideways <= 1e-3 * (1 + forces[:, 2].max()), f"a level plane pushes {sideways:.3g} N sideways")
        demand((forces[:, 2] >= 0).all(), f"a plane pulls: {forces[:, 2].min():.3g} N")
        demand((np.diff(forces[:, 2]) >= -1e-6).all(), f"force falls with depth: {forces[:, 2].tolist()} N")


def what_it_says_of_itself_is_felt(method: ForceRenderer) -> None:
    """Check that a force law with `is_lateral` never pushes along z, and that one without does."""
    # `with-materials` relies on it; a force law that wraps another one passes.
    if type(method).renders_materials:
        return
    up = [_press(method, scene, x, y, depth)[2] for _, scene in _scenes() for x, y in PLACES_M for depth in DEPTHS_M]
    if type(method).is_lateral:
        demand(not np.any(up), f"it has `is_lateral`, but pushes along z with up to {np.abs(up).max():.3g} N")
    else:
        demand(np.any(up), "it gives no force along z; write `is_lateral: ClassVar[bool] = True` in its class")


def surface_lies_where_it_is_drawn(method: ForceRenderer) -> None:
    """Check that a ramp pushes just under its true height and not just over it: x is right, y far, z up, in metres."""
    scene = ramp()
    touch = method.touch(scene.surface)
    for x, y in PLACES_M:
        over = touch.force(HapticState(scene.at(x, y, -2e-4)))
        under = _press(method, scene, x, y, 1e-3)
        demand(tuple(over) == NO_FORCE, f"0.2 mm over the ramp at ({x}, {y}) m: {over}")
        demand(np.any(under != 0), f"1 mm under the ramp at ({x}, {y}) m there is no force")


def slopes_push_downhill(method: ForceRenderer) -> None:
    """Check that on a ramp and on a sphere the sideways part of a force, if there is one, points down the slope."""
    for name, scene in (("ramp", ramp()), ("sphere", sphere_cap())):
        for x, y in PLACES_M[1:]:
            force = _press(method, scene, x, y, 5e-4)
            across, along = scene.slope(x, y)
            steepness, size = float(np.hypot(across, along)), float(np.linalg.norm(force))
            uphill = (force[0] * across + force[1] * along) / steepness
            aside = abs(force[1] * across - force[0] * along) / steepness
            place = f"on the {name} at ({x}, {y}) m, force {force.round(4).tolist()} N"
            demand(uphill <= 0.02 * size, f"{place} points uphill")
            demand(aside <= 0.1 * size, f"{place} points along the slope, not down it")


def springs_are_exact(method: ForceRenderer) -> None:
    """Check that a spring pushes along the normal of a ramp and of a sphere, within 5 degrees."""
    stiffness = _stiffness(method)
    if stiffness is None:
        return
    depth = 5e-4
    for (name, scene), (x, y) in product((("ramp", ramp()), ("sphere", sphere_cap())), PLACES_M):
        force, normal = _press(method, scene, x, y, depth), scene.normal(x, y)
        size = float(np.linalg.norm(force))
        angle = float(np.degrees(np.arccos(np.clip(force @ normal / size, -1, 1)))) if size else 180.0
        demand(angle <= 5, f"on the {name} at ({x}, {y}) m the force is {angle:.3g} degrees off the normal")
        # Between a spring to the nearest point, k times the distance, and one along the gradient, k d sqrt(1 +
        # slope^2).
        least, most = stiffness * depth * normal[2], stiffness * depth / normal[2]
        demand(
            0.95 * least <= size <= 1.05 * most,
            f"on the {name} at ({x}, {y}) m, {depth * 1000:g} mm deep, the force is {size:.4g} N; "
            f"{stiffness:.4g} N/m, as on a plane, is {least:.4g} to {most:.4g} N",
        )


def resampling_feels_the_same(method: ForceRenderer) -> None:
    """Check that a sphere sampled twice as finely feels the same within 10 %: no quantity is per pixel."""
    coarse, fine = sphere_cap(shape=(65, 65)), sphere_cap(shape=(130, 130))
    forces = [np.array([_press(method, scene, x, y, 1e-3) for x, y in PLACES_M]) for scene in (coarse, fine)]
    largest = float(np.abs(forces[1]).max())
    apart = float(np.abs(forces[1] - forces[0]).max())
    demand(apart <= 0.1 * largest, f"at twice the resolution a force of {largest:.3g} N changes by {apart:.3g} N")


def _scenes() -> tuple[tuple[str, KnownSurface], ...]:
    return ("plane", plane()), ("ramp", ramp()), ("sphere", sphere_cap())


def _press(method: ForceRenderer, scene: KnownSurface, x: float, y: float, depth_m: float) -> Float64[np.ndarray, "3"]:
    return np.array(method.touch(scene.surface).force(HapticState(scene.at(x, y, depth_m))), np.float64)


def _stiffness(method: ForceRenderer) -> float | None:
    """Return the stiffness, N/m, if the force on a plane is proportional to the depth, otherwise None."""
    depths = np.array((2e-4, 4e-4, 8e-4))
    pushes = np.array([_press(method, plane(), 0.011, 0.007, float(depth))[2] for depth in depths])
    stiffness = pushes / depths
    return float(stiffness[0]) if stiffness[0] > 0 and np.ptp(stiffness) <= 0.02 * stiffness[0] else None


CHECKS: tuple[Check, ...] = checks_in(__name__)
