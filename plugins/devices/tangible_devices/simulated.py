"""The common parts of devices without a motor: the limits of a Novint Falcon, a link that holds the last force, a hand.

The virtual hand is a mass on a spring towards its target, with limited strength to press.
"""

import cmath
import math
from collections.abc import Callable
from typing import Annotated, final

from pydantic import Field

from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState, Quantities, Vector
from tangible_core.plugins import Link

# Limits of a Novint Falcon, as in CHAI3D's tables; a resolution of a picometre, as positions are not rounded.
LIKE_A_FALCON = DeviceSpec(
    max_force_n=8.0,
    max_stiffness_n_per_m=3000.0,
    damping_n_s_per_m=20.0,
    workspace_m=(0.08, 0.08, 0.08),
    resolution_m=1e-12,
    simulated=True,
)


@final
class SimulatedLink(Link):
    """A simulated device in use."""

    def __init__(self, name: str, move: Callable[[Force], HapticState]) -> None:
        """move: returns the next state, given the force that was held since the last one."""
        super().__init__(f"the {name} device", LIKE_A_FALCON.max_force_n)
        self._move = move
        self._force = NO_FORCE

    def _read(self) -> HapticState:
        return self._move(self._force)

    def _send(self, force: Force) -> None:
        self._force = force

    @property
    def applied(self) -> Force:
        """The force on the hand now."""
        return self._force

    def _release(self) -> None:
        """Do nothing, as there is no device."""


class VirtualHand(Quantities):
    """The model of a hand on the device: m a = F - b v + k (target - x), pressing down with limited strength.

    The defaults are of the order of a relaxed hand holding a handle.
    """

    mass_kg: Annotated[float, Field(ge=1e-3, le=100)] = 0.1
    """Mass of hand and handle together."""
    damping_n_s_per_m: Annotated[float, Field(ge=0, le=1e4)] = 6.0
    """Damping of the motion of hand and handle."""
    stiffness_n_per_m: Annotated[float, Field(ge=0.1, le=1e6)] = 300.0
    """Stiffness of the spring that pulls the hand to its target."""
    press_n: Annotated[float, Field(ge=0, le=1000)] = 1.5
    """Greatest pressing force, however far below the surface the target is: the hand follows hills and valleys."""


@final
class MovingHand:
    """A hand in motion, one period at a time; exact if the force and the target are constant during the period."""

    def __init__(self, hand: VirtualHand, position_m: Vector, period_s: float) -> None:
        self.position_m: Vector = position_m
        self.velocity_m_per_s: Vector = (0.0, 0.0, 0.0)
        self._stiffness = hand.stiffness_n_per_m
        self._reach_down_m = hand.press_n / hand.stiffness_n_per_m
        self._motion = free_motion(hand, period_s)

    def step(self, target_m: Vector, force: Force) -> None:
        """Move by one period under the device's force, towards the target."""
        down = max(target_m[2], self.position_m[2] - self._reach_down_m)
        rests = [target + push / self._stiffness for target, push in zip((*target_m[:2], down), force, strict=True)]
        states = [self._along_axis(*axis) for axis in zip(self.position_m, self.velocity_m_per_s, rests, strict=True)]
        (x, vx), (y, vy), (z, vz) = states
        self.position_m, self.velocity_m_per_s = (x, y, z), (vx, vy, vz)

    def _along_axis(self, position: float, velocity: float, rest: float) -> tuple[float, float]:
        (xx, xv), (vx, vv) = self._motion
        away = position - rest
        return rest + xx * away + xv * velocity, vx * away + vv * velocity


def free_motion(hand: VirtualHand, period_s: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the matrix that moves (x, v), relative to rest, by a period: exp(T [[0, 1], [-k/m, -b/m]]), exactly."""
    # m x'' + b x' + k x = 0 has the roots -a +- r, a = b / 2m, r^2 = a^2 - k/m: the hand alone is always stable.
    square = hand.stiffness_n_per_m / hand.mass_kg
    decay = hand.damping_n_s_per_m / (2 * hand.mass_kg)
    root = cmath.sqrt(decay * decay - square)
    if abs(root) * period_s < 1e-6:  # the two roots meet: their difference would cancel
        even, odd = math.exp(-decay * period_s), period_s * math.exp(-decay * period_s)
    else:
        slow = cmath.exp(-square / (decay + root) * period_s)  # -a + r without its cancellation
        fast = cmath.exp(-(decay + root) * period_s)
        even, odd = ((slow + fast) / 2).real, ((slow - fast) / (2 * root)).real
    return (even + decay * odd, odd), (-square * odd, even - decay * odd)
