"""What devices without a motor share: the limits of a Novint Falcon, and a link that only holds what is written."""

from collections.abc import Callable
from typing import final

from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import Link
from tangible_core.session import limited

LIKE_A_FALCON = DeviceSpec(
    max_force_n=8.0,
    max_stiffness_n_per_m=3000.0,
    damping_n_s_per_m=20.0,
    workspace_m=(0.08, 0.08, 0.08),
    resolution_m=1e-12,
    simulated=True,
)
"""As in CHAI3D's tables; positions are not rounded, which a picometre stands for."""


@final
class SimulatedLink(Link):
    """A simulated device in use."""

    def __init__(self, name: str, move: Callable[[Force], HapticState]) -> None:
        """move: the next state, under the force that has been held since the last one."""
        self._name, self._move = name, move
        self._applied = NO_FORCE
        self._closed = False

    def read(self) -> HapticState:
        """The next state, under the force written last."""
        self._check_open()
        return self._move(self._applied)

    def write(self, force: Force) -> None:
        """Hold this force until the next write; zero if not finite, scaled down to the device's maximum."""
        self._check_open()
        self._applied = limited(force, LIKE_A_FALCON.max_force_n)

    @property
    def applied(self) -> Force:
        """The force on the hand now."""
        return self._applied

    def close(self) -> None:
        """Let go: no force, and no more reading or writing."""
        self._applied = NO_FORCE
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise DeviceError(f"the {self._name} device is closed; open it again")
