"""The common parts of devices without a motor: the limits of a Novint Falcon, and a link that holds the last force."""

from collections.abc import Callable
from typing import final

from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState
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
