"""What a device whose hand follows a path knows of it, in the metres of the picture, whatever mapping lies between."""

import numpy as np
from jaxtyping import Float64, Int64

from ..plugins.interfaces import HapticDevice, Scripted
from .device import MappedDevice, placement_of
from .placement import Placement


def over(device: HapticDevice, extent_m: tuple[float, float]) -> HapticDevice:
    """The device, its path within a picture of this width and length where its own options leave that open."""
    if isinstance(device, Scripted):
        return device.over(extent_m)
    if isinstance(device, MappedDevice) and isinstance(device.device, Scripted):
        return device.model_copy(update={"device": device.device.over(_under_the_hand(device, extent_m))})
    return device


def wanted(device: HapticDevice, ticks: Int64[np.ndarray, " n"]) -> Float64[np.ndarray, "n 3"] | None:
    """Where the hand wants to be at these ticks, the first of which is 0; None where the device does not know."""
    to = placement_of(device)
    if isinstance(device, MappedDevice):
        device = device.device
    found = device.wanted(ticks) if isinstance(device, Scripted) else None
    return None if found is None else _placed(to, found)


def _placed(to: Placement, hand_m: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    turned_back = np.array([[to.cos, to.sin, 0.0], [-to.sin, to.cos, 0.0], [0.0, 0.0, 1.0]])
    from_m = hand_m - np.array([to.offset_x_m, to.offset_y_m, to.offset_z_m])
    return np.einsum("ni,ji->nj", from_m, turned_back) / to.scale + np.array([to.centre_x_m, to.centre_y_m, 0.0])


def _under_the_hand(device: MappedDevice, extent_m: tuple[float, float]) -> tuple[float, float]:
    """Width and length, in the hand's metres, of what about the device's centre lies over the picture."""
    to = placement_of(device)
    ((x, y, _),) = _placed(to, np.zeros((1, 3)))
    width, length = (to.scale * (side - 2 * abs(off)) for side, off in zip(extent_m, (x, y), strict=True))
    if width <= 0 or length <= 0:
        return to.scale * extent_m[0], to.scale * extent_m[1]
    if abs(to.cos) in (0.0, 1.0):
        return (width, length) if to.cos else (length, width)
    side = min(width, length) / (abs(to.cos) + abs(to.sin))
    return side, side
