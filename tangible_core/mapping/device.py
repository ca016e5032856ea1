"""A device whose hand's space is laid over the picture's."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, cast, final

import numpy as np
from pydantic import SerializeAsAny

from ..compiled.touch import CompiledLink, LinkKernels
from ..data import DeviceSpec, Force, HapticState
from ..plugins.interfaces import HapticDevice, Link
from .options import WorkspaceMapping
from .placement import Placement

NAME = "the mapped device"


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
        link, to = self.device.open(), placement_of(self)
        return MappedCompiledLink(link, to) if isinstance(link, CompiledLink) else MappedLink(link, to)


def placement_of(device: HapticDevice) -> Placement:
    """How the picture lies under this device's hand: as its mapping says, or as it is where it has none."""
    if isinstance(device, MappedDevice):
        return device.mapping.placement(device.device.spec().workspace_m)
    return Placement()


@final
class MappedLink(Link):
    """A link in the metres of the picture; the clock stays the device's, and its own link limits the force."""

    def __init__(self, link: Link, to: Placement) -> None:
        super().__init__(NAME, math.inf)
        self._link, self._between = link, _Between(to)

    def _read(self) -> HapticState:
        """Where in the picture the tip is now."""
        return self._between.placed(self._link.read())

    def _send(self, force: Force) -> None:
        """A force in the picture's directions."""
        self._link.write(Force(*self._between.push(*force)))

    @property
    def applied(self) -> Force:
        """The force the device holds, in the picture's directions."""
        return self._between.turned_back(self._link.applied)

    def _release(self) -> None:
        """Let go of the device."""
        self._link.close()


@final
class MappedCompiledLink(CompiledLink):
    """As `MappedLink`, for a device of kernels: they are called by kernels, and a loop still needs no Python."""

    def __init__(self, link: CompiledLink, to: Placement) -> None:
        super().__init__(NAME, math.inf)
        self._link, self._between = link, _Between(to)
        self._kernels = self._between.around(link.kernels())

    def _read(self) -> HapticState:
        """Where in the picture the tip is now."""
        return self._between.placed(self._link.read())

    def _send(self, force: Force) -> None:
        """A force in the picture's directions."""
        self._link.write(Force(*self._between.push(*force)))

    @property
    def applied(self) -> Force:
        """The force the device holds, in the picture's directions."""
        return self._between.turned_back(self._link.applied)

    def _release(self) -> None:
        """Let go of the device."""
        self._link.close()

    def kernels(self) -> LinkKernels:
        """The device's own, each called by one that turns what goes through."""
        return self._kernels

    @property
    def exchanges(self) -> bool:
        """As the device."""
        return self._link.exchanges

    def _exchange(self) -> None:
        """As the device."""
        self._link.exchange()


@final
class _Between:
    """What turns states and forces on their way, and remembers the clutch."""

    def __init__(self, to: Placement) -> None:
        from . import kernels

        self._to, self._kernels = to, cast(Any, kernels)
        self._memory = np.zeros(kernels.MEMORY)
        self._place = partial(self._kernels.place, to, self._memory)
        self.push: Callable[[float, float, float], tuple[float, float, float]]
        self.push = partial(self._kernels.push, to, self._memory)

    def placed(self, state: HapticState) -> HapticState:
        numbers = np.array([*state.position_m, *state.velocity_m_per_s, state.buttons], np.float64)
        self._place(numbers)
        x, y, z, vx, vy, vz, _ = numbers.tolist()
        return HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons)

    def turned_back(self, held: Force) -> Force:
        return Force(*self._to.turned_back(held.x, held.y), held.z)

    def around(self, kernels: LinkKernels) -> LinkKernels:
        return self._kernels.around(kernels, self._to, self._memory)
