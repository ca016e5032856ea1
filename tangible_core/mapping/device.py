"""A device whose workspace is mapped to the picture, and the path of a scripted one through any mapping."""

import math
from typing import Any, cast, final

import numpy as np
from jaxtyping import Float64, Int64
from pydantic import SerializeAsAny

from ..compiled.touch import CompiledLink, LinkKernels
from ..data import DeviceSpec, Force, HapticState
from ..plugins.interfaces import HapticDevice, Link, Scripted
from .placement import Placement, WorkspaceMapping

NAME = "the mapped device"


def map_device(device: HapticDevice, mapping: WorkspaceMapping) -> HapticDevice:
    """Return the device seen through a mapping; the device itself if the mapping changes nothing."""
    if mapping.placement(device.spec().workspace_m) == Placement():
        return device
    return MappedDevice(device=device, mapping=mapping)


@final
class MappedDevice(HapticDevice):
    """Another device, in the metres of the picture."""

    device: SerializeAsAny[HapticDevice]
    """The device that the hand holds."""
    mapping: WorkspaceMapping
    """The mapping from hand to picture."""

    def spec(self) -> DeviceSpec:
        """Return the device's specification in metres of the picture and newtons of the hand."""
        return self.mapping.spec_on_picture(self.device.spec())

    def open(self) -> Link:
        """Open the device. Raises: DeviceError as the device does."""
        link, to = self.device.open(), placement_of(self)
        return MappedCompiledLink(link, to) if isinstance(link, CompiledLink) else MappedLink(link, to)

    def follows(self, channel: str) -> bool:
        """Return True if the device follows this channel."""
        return self.device.follows(channel)


def placement_of(device: HapticDevice) -> Placement:
    """Return the placement of the picture under this device's hand; the identity if the device has no mapping."""
    if isinstance(device, MappedDevice):
        return device.mapping.placement(device.device.spec().workspace_m)
    return Placement()


class _ThroughMapping:
    """The methods of a link that passes states and forces through a mapping, and remembers the clutch."""

    def _map(self, link: Link, to: Placement) -> None:
        from . import kernels

        self._link, self._to, self._kernels = link, to, cast(Any, kernels)
        self._memory = np.zeros(kernels.MEMORY)

    def _read(self) -> HapticState:
        state = self._link.read()
        numbers = np.array([*state.position_m, *state.velocity_m_per_s, state.buttons], np.float64)
        self._kernels.place(self._to, self._memory, numbers)
        x, y, z, vx, vy, vz, _ = numbers.tolist()
        return HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons)

    def _send(self, force: Force) -> None:
        self._link.write(Force(*self._kernels.push(self._to, self._memory, *force)))

    @property
    def applied(self) -> Force:
        """The force that the device holds, in the picture's directions."""
        force = self._link.applied
        return Force(*self._to.rotate_back(force.x, force.y), force.z)

    def _release(self) -> None:
        self._link.close()


@final
class MappedLink(_ThroughMapping, Link):
    """A link in metres of the picture; the clock is the device's, and the device's own link limits the force."""

    def __init__(self, link: Link, to: Placement) -> None:
        super().__init__(NAME, math.inf)
        self._map(link, to)


@final
class MappedCompiledLink(_ThroughMapping, CompiledLink):
    """A `MappedLink` for a device of kernels: its own kernels call the device's, and a loop still needs no Python."""

    def __init__(self, link: CompiledLink, to: Placement) -> None:
        super().__init__(NAME, math.inf)
        self._map(link, to)
        self._device = link
        self._around: LinkKernels = self._kernels.around(link.kernels(), to, self._memory)

    def kernels(self) -> LinkKernels:
        """Return the kernels that convert states and forces, and call the device's."""
        return self._around

    @property
    def exchanges(self) -> bool:
        """True if the device exchanges."""
        return self._device.exchanges

    def _exchange(self) -> None:
        self._device.exchange()


def over(device: HapticDevice, extent_m: tuple[float, float]) -> HapticDevice:
    """Return the device with its path within a picture of this size, where its own options leave that open."""
    if isinstance(device, Scripted):
        return device.over(extent_m)
    if isinstance(device, MappedDevice) and isinstance(device.device, Scripted):
        return device.model_copy(update={"device": device.device.over(_under_the_hand(device, extent_m))})
    return device


def intended_path(device: HapticDevice, ticks: Int64[np.ndarray, " n"]) -> Float64[np.ndarray, "n 3"] | None:
    """Return the intended positions of the hand at these ticks, counted from 0; None if the device has no path."""
    to = placement_of(device)
    if isinstance(device, MappedDevice):
        device = device.device
    hand_m = device.wanted(ticks) if isinstance(device, Scripted) else None
    return None if hand_m is None else _on_picture(to, hand_m)


def _on_picture(to: Placement, hand_m: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    rotation = np.array([[to.cos, to.sin, 0.0], [-to.sin, to.cos, 0.0], [0.0, 0.0, 1.0]])
    from_m = hand_m - np.array([to.offset_x_m, to.offset_y_m, to.offset_z_m])
    return np.einsum("ni,ji->nj", from_m, rotation) / to.scale + np.array([to.centre_x_m, to.centre_y_m, 0.0])


def _under_the_hand(device: MappedDevice, extent_m: tuple[float, float]) -> tuple[float, float]:
    """Return width and length, in the hand's metres, of the area about the device's centre over the picture."""
    to = placement_of(device)
    ((x, y, _),) = _on_picture(to, np.zeros((1, 3)))
    width, length = (to.scale * (side - 2 * abs(off)) for side, off in zip(extent_m, (x, y), strict=True))
    if width <= 0 or length <= 0:
        return to.scale * extent_m[0], to.scale * extent_m[1]
    if abs(to.cos) in (0.0, 1.0):
        return (width, length) if to.cos else (length, width)
    side = min(width, length) / (abs(to.cos) + abs(to.sin))
    return side, side
