"""The path of a scripted device, in metres of the picture, through any mapping."""

import numpy as np
from jaxtyping import Float64, Int64

from ..plugins.interfaces import HapticDevice, Scripted
from .device import MappedDevice, placement_of
from .placement import Placement


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
