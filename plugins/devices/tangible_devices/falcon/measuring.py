"""Measuring a Falcon with the user's help: its axes, arms' zeros and motors' strength. Imports numba."""

import math
from collections.abc import Callable, Sequence
from typing import get_args

from tangible_core.data import NO_FORCE, Force, Vector
from tangible_core.errors import DeviceError
from tangible_core.plugins import Link

from .calibration import Axis, Calibration
from .kernels import kinematics

Ask = Callable[[str], str]
DIRECTIONS = ("to the right", "away from you", "up")
MIN_M = 0.010  # shortest move that identifies an axis
# Reads that are skipped after a question to the user, during which no packets were sent.
SETTLING = 20
# Stiffness of the virtual spring that carries the weight, which gives 4 mm for 100 g; and the time it is held.
HOLD_N_PER_M, HOLD_TICKS = 250.0, 2000
STANDARD_GRAVITY = 9.80665
RAW = ("x", "y", "z")  # the axes of an uncalibrated device: its own


def measure_axes(link: Link, ask: Ask) -> tuple[Axis, Axis, Axis]:
    """Measure which of the axes are the workspace's. link: of a device whose axes are RAW. Raises: DeviceError."""
    ask("Hold the grip in the middle of its reach, and press Enter.")
    axes: list[Axis] = []
    start = _place(link)
    for direction in DIRECTIONS:
        ask(f"Move it about 3 cm {direction}, hold it there, and press Enter.")
        end = _place(link)
        axes.append(_axis([after - before for before, after in zip(start, end, strict=True)], direction))
        start = end
    if len({axis[-1] for axis in axes}) < 3:
        raise DeviceError(f"two of the three moves went along one axis ({', '.join(axes)}); calibrate again")
    return axes[0], axes[1], axes[2]


def measure_offsets(link: Link, ask: Ask, offsets_deg: Vector) -> Vector:
    """Measure the angles at 0 counts. link: of a device whose axes are RAW, and whose offsets are these."""
    ask("Push the grip all the way in, straight along the device's axis, hold it there, and press Enter.")
    x, y, z = _place(link)
    arms = [math.degrees(arm) for arm in kinematics.inverse(x, y, z + kinematics.CENTRE_M)]
    mean = sum(arms) / 3  # on the device's axis, all three are equal; their mean is left unchanged
    top, right, left = (offset - (arm - mean) for offset, arm in zip(offsets_deg, arms, strict=True))
    return top, right, left


def measure_strength(link: Link, ask: Ask, counts_per_newton_metre: float) -> float:
    """Measure the motor counts for a newton metre by a weight that the device carries; unchanged without one."""
    grams = ask(
        "Now the motors push, up to a few newtons. Type the grams of a weight (100 to 300) that you can hang on the "
        "grip, or press Enter to leave their strength as it is."
    )
    if not grams:
        return counts_per_newton_metre
    weight_n = _number(grams) / 1000 * STANDARD_GRAVITY
    ask("Hold the grip in the middle of its reach, press Enter, and let go slowly.")
    height_m = _place(link)[2]
    alone_n = _mean_lift_n(link, height_m)  # so that friction and the mechanics' own weight cancel out
    ask("Hang the weight on the grip, and press Enter.")
    return counts_per_newton_metre * strength(alone_n, _mean_lift_n(link, height_m), weight_n)


def strength(alone_n: float, laden_n: float, weight_n: float) -> float:
    """Return the force commanded for a weight, over that weight. Raises: DeviceError if it is below 0.2 or above 5."""
    factor = (laden_n - alone_n) / weight_n
    if not 0.2 <= factor <= 5:
        raise DeviceError(f"{weight_n:.2f} N of weight changed the force by {laden_n - alone_n:.2f} N; calibrate again")
    return factor


def _mean_lift_n(link: Link, height_m: float) -> float:
    """Return the mean upward force of a soft virtual spring that carries the load, over the second half of the time."""
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
    """Return the position of the tip, after some exchanges that bring it up to date."""
    for _ in range(SETTLING):
        link.write(NO_FORCE)
        link.read()
    return link.read().position_m


def _axis(moved_m: Sequence[float], direction: str) -> Axis:
    farthest = max(range(3), key=lambda axis: abs(moved_m[axis]))
    if abs(moved_m[farthest]) < MIN_M:
        raise DeviceError(f"the grip did not move {direction} by {1000 * MIN_M:.0f} mm; calibrate again")
    return get_args(Axis)[2 * farthest + (moved_m[farthest] < 0)]


def _number(text: str) -> float:
    try:
        grams = float(text)
    except ValueError:
        grams = math.nan
    if not 20 <= grams <= 500:
        raise DeviceError(f"{text!r} is not a weight of 20 to 500 g; calibrate again")
    return grams


def measure(opener: Callable[[Calibration], Link], ask: Ask, before: Calibration) -> Calibration:
    """Measure a whole calibration. opener: opens the device with a calibration, and homes it."""
    with opener(before.model_copy(update={"axes": RAW})) as link:
        axes = measure_axes(link, ask)
        offsets = measure_offsets(link, ask, before.encoder_offset_deg)
    geometry = before.model_copy(update={"axes": axes, "encoder_offset_deg": offsets})
    with opener(geometry) as link:
        counts = measure_strength(link, ask, before.counts_per_newton_metre)
    return Calibration.model_validate({**geometry.model_dump(), "counts_per_newton_metre": counts})
