"""The Haply Inverse3, through its maker's local service."""

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from tangible_core.data import DeviceSpec, Finding, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins import HapticDevice, Link, Serviceable

Metres = Annotated[float, Field(ge=-1, le=1)]


class Haply(HapticDevice, Serviceable):
    """A Haply Inverse3 (or Minverse), through the Haply Inverse Service 3.5 or newer on this machine.

    The axes of the service are those of the workspace: x right, y away from the user, z up. The origin is the base of
    the arm, in front of which the hand moves; `centre_m` is the point that becomes the picture's centre. A wired
    VerseGrip's button is button 0.
    """

    uri: Annotated[str, Field(pattern=r"^wss?://")] = "ws://localhost:10001"
    """Address at which the service listens."""
    device_id: str | None = None
    """Identifier of the Inverse3, as `tangible devices` lists it; null selects the first."""
    centre_m: tuple[Metres, Metres, Metres] = (0.0, -0.14, 0.1)
    """Position, in the service's frame, that becomes the origin; the default is a guess at a comfortable place."""
    max_force_n: Annotated[float, Field(gt=0, le=20)] = 5.0
    """Greatest force that is sent; less than the arm's short-term peak, because motors heat up."""
    timeout_s: Annotated[float, Field(gt=0, le=60)] = 1.0
    """Time without an answer after which the service counts as lost."""

    def spec(self) -> DeviceSpec:
        """Return the option's force, and cautious guesses of the rest: the maker states no stiffness or damping."""
        return DeviceSpec(
            max_force_n=self.max_force_n,
            max_stiffness_n_per_m=2000.0,
            damping_n_s_per_m=5.0,
            workspace_m=(0.2, 0.2, 0.2),
            resolution_m=1e-4,
            buttons=1,
        )

    def open(self) -> Link:
        """Connect to the arm. Raises: DeviceAbsent if service, arm or websockets is missing; DeviceError on failure."""
        from .service import HaplyLink, Session

        session = Session(self.uri, self.timeout_s)
        return HaplyLink(session, session.choose(self.device_id), self.centre_m, self.max_force_n)

    def connected(self) -> tuple[Unit, ...]:
        """Return the arms that the service lists. Raises: DeviceError as `open`."""
        from .service import Session

        session = Session(self.uri, self.timeout_s)
        try:
            return session.arms
        finally:
            session.close()

    def examine(self) -> Iterator[Finding]:
        """Check the library, the service, and the status that each arm reports."""
        try:
            arms = self.connected()
        except DeviceAbsent as absent:
            yield Finding("service", "not asked", str(absent))
            return
        except DeviceError as error:
            yield Finding("service", "failed", str(error), "restart the Haply Inverse Service")
            return
        yield Finding("service", "fine", f"answers at {self.uri}")
        for arm in arms:
            verdict = "failed" if arm.problem else "fine"
            cure = "look into Haply Hub" if arm.problem else ""
            yield Finding(f"{arm.name} {arm.serial}", verdict, arm.problem or "is ready", cure)
