"""A Falcon measured with its user's help: its axes, where its arms are at zero, how strong its motors are.

Imports numba.
"""

import math
from collections.abc import Callable, Sequence
from typing import get_args

from tangible_core.data import NO_FORCE, Force, Vector
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import Link

from .calibration import Axis, Calibration
from .kernels import kinematics

Ask = Callable[[str], str]
DIRECTIONS = ("to the right", "away from you", "up")
LEAST_M = 0.010
"""Shorter moves do not tell an axis."""
SETTLING = 20
"""Reads that are passed over after the user was asked: meanwhile nobody spoke to the device."""
HOLD_N_PER_M, HOLD_TICKS = 250.0, 2000
"""Of the spring that carries the weight; it stretches by 4 mm for 100 g."""
STANDARD_GRAVITY = 9.80665
RAW = ("x", "y", "z")
"""Axes that leave the device's own as they are."""


def measure_axes(link: Link, ask: Ask) -> tuple[Axis, Axis, Axis]:
    """Which of the device's axes are the workspace's x, y and z. link: of a device whose axes are RAW.

    Raises: DeviceError if a move was too short, or two went along one axis.
    """
    ask("Hold the grip in the middle of its reach, and press Enter.")
    found: list[Axis] = []
    start = _place(link)
    for direction in DIRECTIONS:
        ask(f"Move it about 3 cm {direction}, hold it there, and press Enter.")
        end = _place(link)
        found.append(_axis([after - before for before, after in zip(start, end, strict=True)], direction))
        start = end
    if len({axis[-1] for axis in found}) < 3:
        raise DeviceError(f"two of the three moves went along one axis ({', '.join(found)}); calibrate again")
    return found[0], found[1], found[2]


def measure_offsets(link: Link, ask: Ask, offsets_deg: Vector) -> Vector:
    """Angles of the arms at 0 counts, such that all three are alike where they must be: on the device's axis.

    Their mean stays as it was. link: of a device whose axes are RAW, and whose offsets are these.
    """
    ask("Push the grip all the way in, straight along the device's axis, hold it there, and press Enter.")
    x, y, z = _place(link)
    arms = [math.degrees(arm) for arm in kinematics.inverse(x, y, z + kinematics.CENTRE_M)]
    mean = sum(arms) / 3
    top, right, left = (offset - (arm - mean) for offset, arm in zip(offsets_deg, arms, strict=True))
    return top, right, left


def measure_strength(link: Link, ask: Ask, counts_per_newton_metre: float) -> float:
    """Motor counts for a newton metre, by a weight that the device carries; as before if the user has none.

    The weight adds its own force to whatever friction and the mechanics need, so these drop out.
    """
    grams = ask(
        "Now the motors push, up to a few newtons. Type the grams of a weight (100 to 300) that you can hang on the "
        "grip, or press Enter to leave their strength as it is."
    )
    if not grams:
        return counts_per_newton_metre
    weight_n = _number(grams) / 1000 * STANDARD_GRAVITY
    ask("Hold the grip in the middle of its reach, press Enter, and let go slowly.")
    height_m = _place(link)[2]
    alone_n = _carried(link, height_m)
    ask("Hang the weight on the grip, and press Enter.")
    return counts_per_newton_metre * strength(alone_n, _carried(link, height_m), weight_n)


def strength(alone_n: float, laden_n: float, weight_n: float) -> float:
    """By what the counts a newton metre must be multiplied: the force commanded for a weight, over that weight.

    Raises: DeviceError if it is beyond belief.
    """
    factor = (laden_n - alone_n) / weight_n
    if not 0.2 <= factor <= 5:
        raise DeviceError(f"{weight_n:.2f} N of weight changed the force by {laden_n - alone_n:.2f} N; calibrate again")
    return factor


def _carried(link: Link, height_m: float) -> float:
    """The force up, by which a soft spring carries what hangs on it, over the second half of the time."""
    forces: list[float] = []
    for _ in range(HOLD_TICKS):
        state = link.read()
        up_n = HOLD_N_PER_M * (height_m - state.position_m[2]) - 4.0 * state.velocity_m_per_s[2]
        link.write(Force(0.0, 0.0, up_n))
        forces.append(link.applied.z)
    link.write(NO_FORCE)
    late = forces[HOLD_TICKS // 2 :]
    return sum(late) / len(late)


def _place(link: Link) -> Vector:
    """Where the tip is now, after what was said to it meanwhile."""
    for _ in range(SETTLING):
        link.write(NO_FORCE)
        link.read()
    return link.read().position_m


def _axis(moved_m: Sequence[float], direction: str) -> Axis:
    farthest = max(range(3), key=lambda axis: abs(moved_m[axis]))
    if abs(moved_m[farthest]) < LEAST_M:
        raise DeviceError(f"the grip did not move {direction} by {1000 * LEAST_M:.0f} mm; calibrate again")
    return get_args(Axis)[2 * farthest + (moved_m[farthest] < 0)]


def _number(text: str) -> float:
    try:
        grams = float(text)
    except ValueError:
        grams = math.nan
    if not 20 <= grams <= 500:
        raise DeviceError(f"{text!r} is not a weight of 20 to 500 g; calibrate again")
    return grams


def measure(opened: Callable[[Calibration], Link], ask: Ask, before: Calibration) -> Calibration:
    """All of it. opened: the homed device by a calibration."""
    with opened(before.model_copy(update={"axes": RAW})) as link:
        axes = measure_axes(link, ask)
        offsets = measure_offsets(link, ask, before.encoder_offset_deg)
    placed = before.model_copy(update={"axes": axes, "encoder_offset_deg": offsets})
    with opened(placed) as link:
        counts = measure_strength(link, ask, before.counts_per_newton_metre)
    return Calibration.model_validate({**placed.model_dump(), "counts_per_newton_metre": counts})
