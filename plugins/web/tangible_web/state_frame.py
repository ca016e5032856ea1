"""The newest tick of a force loop as a frame for a page."""

import math
import time
from typing import NamedTuple

from tangible_core.data import Vector
from tangible_core.runtime.system import now_ns
from tangible_core.servo import Servo

from .framing import BUTTON_BITS, FLAG_BITS, STATE, STATE_FRAME
from .hand import HIGH_M

NOBODY: Vector = (0.0, 0.0, 0.0)
UNKNOWN: Vector = (math.nan, math.nan, math.nan)


class OtherLaw(NamedTuple):
    """The second force law, as frames show it."""

    force_n: Vector = NOBODY  # force of that law on the same hand
    # True if the page must not reveal which law acts: the proxy is then hidden too, as not every law has one.
    blind: bool = False


ALONE = OtherLaw()


def frame_without_loop(seq: int, status: int) -> bytes:
    """Return a STATE frame with a hand that is nowhere."""
    nowhere = *HIGH_M, *UNKNOWN, *NOBODY, *NOBODY, *NOBODY
    return STATE_FRAME.pack(STATE, status, 0, seq & 0xFFFFFFFF, 0, 0, 1e3 * time.time(), *nowhere, 0.0)


def newest_frame(servo: Servo, seq: int, status: int, other_law: OtherLaw = ALONE) -> bytes | None:
    """Return the newest tick of a loop as a STATE frame; None if it was overwritten meanwhile."""
    if (row := servo.ring.latest()) is None:
        return None
    t, late, x, y, z, vx, vy, vz, px, py, pz, fx, fy, fz, flags, buttons, _ = row.tolist()
    sample_ms = 1e3 * ((servo.ring.start_ns - now_ns()) / 1e9 + t + time.time())
    tag = int(buttons) >> BUTTON_BITS
    return STATE_FRAME.pack(
        STATE, status, int(flags) & FLAG_BITS, seq & 0xFFFFFFFF, tag, servo.ring.overruns, sample_ms,
        x, y, z, *(UNKNOWN if other_law.blind else (px, py, pz)), fx, fy, fz, vx, vy, vz,
        *other_law.force_n, 1e6 * late,
    )  # fmt: skip
