"""Devices for tests of a force loop: a compiled one, and one that fails in the ways that devices do."""

import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, cast, final

import numpy as np
from pydantic import Field

from tangible_core.compiled.touch import CompiledLink, LinkKernels
from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import HapticDevice, Link

SPEC = DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.1, 0.1), 1e-6, simulated=True)


class Circling(HapticDevice):
    """A tip on a level circle, one step a read; only kernels, so that a loop on it needs no Python."""

    radius_m: float = 0.02
    z_m: float = 0.0
    steps: Annotated[int, Field(ge=1)] = 1000
    """Reads in one turn."""
    exchanges: bool = False
    """Call Python once a tick, as for a device on a wire."""

    def spec(self) -> DeviceSpec:
        """Return the specification of a device like the Novint Falcon."""
        return SPEC

    def open(self) -> Link:
        """Return a new tip, on the circle's right."""
        return CirclingLink(self)


@final
class CirclingLink(CompiledLink):
    """A tip on its way around the circle."""

    def __init__(self, options: Circling) -> None:
        super().__init__("the circling device", SPEC.max_force_n)
        turn = np.linspace(0, 2 * np.pi, options.steps, endpoint=False)
        wheel = np.column_stack([np.cos(turn), np.sin(turn)]) * options.radius_m
        self._fixed = wheel, float(options.z_m), np.zeros(1, np.int64), np.zeros(3)
        self._exchanges = options.exchanges

    def kernels(self) -> LinkKernels:
        """See `loop_kernels`."""
        import loop_kernels

        kernels = cast(Any, loop_kernels)
        return LinkKernels(kernels.read, kernels.write, self._fixed)

    @property
    def exchanges(self) -> bool:
        """The option `exchanges`."""
        return self._exchanges

    def _exchange(self) -> None:
        """Do nothing, as there is no wire."""

    def _read(self) -> HapticState:
        """Return the next step."""
        state = np.zeros(7)
        self.kernels().read(*self._fixed, state)
        x, y, z = state[:3].tolist()
        return HapticState((x, y, z), time_s=time.monotonic())

    def _send(self, force: Force) -> None:
        """Hold this force."""
        self._fixed[3][:] = force

    @property
    def applied(self) -> Force:
        """The force written last."""
        return Force(*self._fixed[3].tolist())

    def _release(self) -> None:
        """Do nothing, as nothing is held."""


class Failing(HapticDevice):
    """A tip at rest in the surface, on a device that does something wrong at one of its reads."""

    at: int = 100
    """Number of the read with the fault."""
    fault: Literal[
        "unplugged", "bug", "nan", "hangs", "blocks", "exits", "none", "repeats", "alternates", "time goes back",
        "time is NaN", "time is infinite",
    ] = "unplugged"  # fmt: skip
    """Fault: no answer any more; an exception of the driver; NaN once; 50 ms; no answer ever; an exit of the driver;
    and, from that read on: the last state again, the last two in turn, older and older times, no times."""
    opens: Literal["always", "once", "second", "never", "late"] = "always"
    """Times it can be opened: `once` without a record, and then it does not answer; `second` only with a record, which
    the first attempt writes; `late` never answers."""
    record: str = ""
    """File that the force held is written to whenever it changes, to see which force is left."""
    simulated: bool = True
    """Field of the specification: a real device is asked again to let go if its loop is killed."""

    def spec(self) -> DeviceSpec:
        """Return the specification of a device like the Novint Falcon."""
        return replace(SPEC, simulated=self.simulated)

    def open(self) -> Link:
        """Open the device. Raises: DeviceError if it cannot be opened."""
        if self.opens == "late" or (self.opens == "once" and os.path.exists(self.record)):  # noqa: PTH110
            time.sleep(3600)
        if self.opens == "never" or (self.opens == "second" and not os.path.exists(self.record)):  # noqa: PTH110
            Path(self.record).touch() if self.record else None
            raise DeviceError("the failing device is in use by another program; close that")
        return FailingLink(self)


@final
class FailingLink(Link):
    """A device that is about to fail."""

    def __init__(self, options: Failing) -> None:
        super().__init__("the failing device", SPEC.max_force_n)
        self._options = options
        self._reads, self._good_s = 0, time.monotonic()
        self._applied = NO_FORCE
        self._write_record()

    def _read(self) -> HapticState:
        """Return a millimetre under the base plane, all the time."""
        self._reads += 1
        z = -0.001
        if self._reads == self._options.at:
            z = self._fail()
        return HapticState((0.0, 0.0, z), time_s=self._time_s())

    def _time_s(self) -> float:
        after = self._reads - self._options.at
        if after < 0:
            self._good_s = time.monotonic()
            return self._good_s
        match self._options.fault:
            case "repeats":
                return self._good_s
            case "alternates":
                return self._good_s - 0.001 * (after % 2)
            case "time goes back":
                return self._good_s - 0.001 * after
            case "time is NaN":
                return float("nan")
            case "time is infinite":
                return float("inf")
            case _:
                return time.monotonic()

    def _fail(self) -> float:
        match self._options.fault:
            case "unplugged":
                raise DeviceError("the failing device does not answer; plug it in")
            case "bug":
                raise ZeroDivisionError("the driver's own fault")
            case "hangs":
                time.sleep(0.05)
            case "blocks":
                time.sleep(3600)
            case "exits":
                sys.exit(3)
            case "nan":
                return float("nan")
            case _:
                pass
        return -0.001

    def _send(self, force: Force) -> None:
        """Hold this force."""
        if force != self._applied:
            self._applied = force
            self._write_record()

    def _write_record(self) -> None:
        if self._options.record:
            with open(self._options.record, "w", encoding="ascii") as file:  # noqa: PTH123 - a string, in a tick
                file.write(f"{self._applied.z}")

    @property
    def applied(self) -> Force:
        """The force written last."""
        return self._applied

    def _release(self) -> None:
        """Do nothing, as nothing is held."""
