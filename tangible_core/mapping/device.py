"""A device whose hand's space is laid over the picture's."""

from typing import Any, cast, final

import numpy as np
from pydantic import SerializeAsAny

from ..compiled.touch import CompiledLink, LinkKernels
from ..data import DeviceSpec, Force, HapticState
from ..plugins.interfaces import HapticDevice, Link
from .options import WorkspaceMapping
from .placement import Placement


def mapped(device: HapticDevice, mapping: WorkspaceMapping) -> HapticDevice:
    """The device seen through a mapping; the device itself where that changes nothing."""
    if mapping.placement(device.spec().workspace_m) == Placement():
        return device
    return MappedDevice(device=device, mapping=mapping)


@final
class MappedDevice(HapticDevice):
    """Another device, in the metres of the picture."""

    device: SerializeAsAny[HapticDevice]
    """What the hand holds."""
    mapping: WorkspaceMapping
    """How the picture lies under it."""

    def spec(self) -> DeviceSpec:
        """The device's, in the metres of the picture and the newtons of the hand."""
        return self.mapping.felt_spec(self.device.spec())

    def open(self) -> Link:
        """Raises: DeviceError as the device does."""
        link = self.device.open()
        to = self.mapping.placement(self.device.spec().workspace_m)
        return MappedCompiledLink(link, to) if isinstance(link, CompiledLink) else MappedLink(link, to)


@final
class MappedLink(Link):
    """A link in the metres of the picture; the clock stays the device's."""

    def __init__(self, link: Link, to: Placement) -> None:
        from . import kernels

        self._link, self.to = link, to
        self.kernels = cast(Any, kernels)
        self.memory = np.zeros(kernels.MEMORY)

    def read(self) -> HapticState:
        """Where in the picture the tip is now."""
        state = self._link.read()
        numbers = np.array([*state.position_m, *state.velocity_m_per_s, state.buttons], np.float64)
        self.kernels.place(self.to, self.memory, numbers)
        x, y, z, vx, vy, vz, _ = numbers.tolist()
        return HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons)

    def write(self, force: Force) -> None:
        """A force in the picture's directions."""
        self._link.write(Force(*self.kernels.push(self.to, self.memory, *force)))

    @property
    def applied(self) -> Force:
        """The force the device holds, in the picture's directions."""
        held = self._link.applied
        return Force(*self.to.turned_back(held.x, held.y), held.z)

    def close(self) -> None:
        """Let go of the device."""
        self._link.close()


@final
class MappedCompiledLink(CompiledLink):
    """As `MappedLink`, for a device of kernels: they are called by kernels, and a loop still needs no Python."""

    def __init__(self, link: CompiledLink, to: Placement) -> None:
        self._link = link
        self._plain = MappedLink(link, to)
        self._kernels: LinkKernels = self._plain.kernels.around(link.kernels(), to, self._plain.memory)

    def read(self) -> HapticState:
        """Where in the picture the tip is now."""
        return self._plain.read()

    def write(self, force: Force) -> None:
        """A force in the picture's directions."""
        self._plain.write(force)

    @property
    def applied(self) -> Force:
        """The force the device holds, in the picture's directions."""
        return self._plain.applied

    def close(self) -> None:
        """Let go of the device."""
        self._link.close()

    def kernels(self) -> LinkKernels:
        """The device's own, each called by one that turns what goes through."""
        return self._kernels

    @property
    def exchanges(self) -> bool:
        """As the device."""
        return self._link.exchanges

    def exchange(self) -> None:
        """As the device."""
        self._link.exchange()
