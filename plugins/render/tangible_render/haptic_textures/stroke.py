"""Heights and forces along a straight stroke over a material."""

from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Material
from tangible_core.errors import MaterialError

from .table import STIFFNESS, compile_textures


class Stroke(NamedTuple):
    """A stroke: distance, height, and force on the hand in the direction of the stroke, in metres and newtons."""

    way_m: Float64[np.ndarray, " n"]
    height_m: Float64[np.ndarray, " n"]
    force_n: Float64[np.ndarray, " n"]


def stroke(
    material: Material,
    speed_m_per_s: float = 0.05,
    normal_n: float = 1.0,
    length_m: float = 0.02,
    period_s: float = 0.001,
    direction_deg: float = 0.0,
) -> Stroke:
    """Compute a stroke from the workspace's origin at constant speed and normal force.

    The force is the sum of the texture's, the slope's, -N dh/ds (Robles-De-La-Torre & Hayward, Nature 412, 2001), and
    the dynamic friction if the texture has no friction. Compiles on the first use on a machine.
    Raises: MaterialError if one of the numbers is not positive and finite (a direction: not finite).
    """
    positive = (speed_m_per_s, normal_n, length_m, period_s)
    if not (all(0 < each < np.inf for each in positive) and np.isfinite(direction_deg)):
        raise MaterialError(f"a stroke needs positive numbers and a direction, not {positive} and {direction_deg}")
    from . import forces

    way_m = np.arange(0, length_m, speed_m_per_s * period_s)
    along = np.array([np.cos(np.deg2rad(direction_deg)), np.sin(np.deg2rad(direction_deg))])
    textures, result = compile_textures([material]), np.empty((len(way_m), 5))
    cast(Any, forces).along(textures, 0, np.zeros(forces.STATE), np.outer(way_m, along), period_s, normal_n, result)
    friction_n = 0.0 if textures[0, STIFFNESS] else material.dynamic_friction * normal_n
    lateral_n = result[:, 3:] - normal_n * result[:, 1:3]
    force_n = lateral_n[:, 0] * along[0] + lateral_n[:, 1] * along[1] - friction_n * (way_m > 0)
    return Stroke(way_m, result[:, 0], force_n)
