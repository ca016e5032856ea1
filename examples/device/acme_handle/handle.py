"""The driver: the maker's library on one side, metres and newtons on the other."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core import Force, HapticState
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins import DeviceSpec, HapticDevice, Link

if TYPE_CHECKING:
    from .maker import Box

SPEC = DeviceSpec(
    max_force_n=5.0,
    max_stiffness_n_per_m=1500.0,
    damping_n_s_per_m=5.0,
    workspace_m=(0.08, 0.08, 0.06),
    resolution_m=5e-5,
    simulated=True,  # of a box with motors: False
)


class Handle(HapticDevice):
    """Acme's handle on three axes, through the library of its maker."""

    def spec(self) -> DeviceSpec:
        """Return the data sheet's values; the box is not contacted."""
        return SPEC

    def open(self) -> Link:
        """Open the box. Raises: DeviceAbsent without a box, DeviceError if another program has it."""
        from .maker import Box

        try:
            return HandleLink(Box())
        except OSError as error:
            if str(error) == "busy":
                raise DeviceError("the acme handle is in use; close the other program") from error
            raise DeviceAbsent("no acme handle is connected; plug it in and switch it on") from error


class HandleLink(Link):
    """The handle, open."""

    def __init__(self, box: "Box") -> None:
        super().__init__("the acme handle", SPEC.max_force_n)
        self._box = box
        self._ms, self._position_m = self._poll()

    def _read(self) -> HapticState:
        """Read the box; the velocity is the step from the position before."""
        before_ms, before_m = self._ms, self._position_m
        self._ms, self._position_m = self._poll()
        seconds = (self._ms - before_ms) / 1000
        vx, vy, vz = ((now - then) / seconds for now, then in zip(self._position_m, before_m, strict=True))
        return HapticState(self._position_m, (vx, vy, vz), self._ms / 1000)

    def _send(self, force: Force) -> None:
        """Convert to the maker's units and frame."""
        x, y, z = force
        self._ask(self._box.push, (1000 * x, 1000 * z, -1000 * y))

    @property
    def applied(self) -> Force:
        """Return the force that the box applies."""
        right, up, near = self._box.held_mn
        return Force(right / 1000, -near / 1000, up / 1000)

    def _release(self) -> None:
        """Motors off."""
        self._box.shut()

    def _poll(self) -> tuple[int, tuple[float, float, float]]:
        ms, (right, up, near) = self._ask(self._box.poll)
        return ms, (right / 1000, -near / 1000, up / 1000)

    def _ask(self, what: Callable[..., Any], *args: Any) -> Any:
        try:
            return what(*args)
        except OSError as error:
            raise DeviceError("the acme handle stopped answering; look at its cable and open it again") from error
