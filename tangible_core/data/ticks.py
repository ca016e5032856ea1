"""The records of a force loop: the flags and columns of a tick, and reports on the loop."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntFlag
from typing import NamedTuple

from .device import Force, HapticState


class TickFlag(IntFlag):
    """Events in one tick of a force loop; several may happen at once."""

    TOUCHING = 1
    """The force law gave a force."""
    FORCE_LIMITED = 2
    """The force exceeded the maximum and was scaled down."""
    SLEW_LIMITED = 4
    """The force changed by more than a tick allows, and was moved only part of the way."""
    STIFFNESS_LIMITED = 8
    """The force law is stiffer than this loop and device render stably, and was softened."""
    RAMPING = 16
    """The force is fading in."""
    NOT_FINITE = 32
    """The force law or the device gave NaN or infinity; the force was zero."""
    DAMPED = 64
    """The passivity controller dissipated energy that the loop had generated."""
    STALE = 128
    """The device had no fresh position for too long; the force was zero."""
    OVERRUN = 256
    """The tick began more than a period late."""
    SWAPPED = 512
    """The first tick on a new scene."""
    BEACON = 1024
    """A beacon pulled, or was about to; the bits above this one hold the number of its part (`beacon_part`)."""


BEACON_SHIFT = 11
"""The lowest bit of the number of a beacon's part in the flags of a tick."""
# The number of parts that a beacon can pull to: larger numbers do not fit into the flags.
MAX_BEACON_PARTS = 1 << 20


def beacon_part(flags: int) -> int | None:
    """Return the number of the part that a beacon pulled to in a tick with these flags; None without a beacon.

    >>> beacon_part(TickFlag.TOUCHING | TickFlag.BEACON | 6 << BEACON_SHIFT), beacon_part(TickFlag.TOUCHING)
    (6, None)
    """
    return flags >> BEACON_SHIFT if flags & TickFlag.BEACON else None


UNTOUCHED = TickFlag.TOUCHING | TickFlag.OVERRUN | TickFlag.SWAPPED
"""The flags that leave the force of the law unchanged; each of the others means a change."""

TICK_COLUMNS = (
    *("time_s", "late_s"),
    *("x_m", "y_m", "z_m"),
    *("vx_m_per_s", "vy_m_per_s", "vz_m_per_s"),
    *("proxy_x_m", "proxy_y_m", "proxy_z_m"),
    *("fx_n", "fy_n", "fz_n"),
    *("flags", "buttons"),
    "frame",
)
"""The columns of a recorded tick, each a float64: its start and delay, the tip's position and velocity, the proxy (NaN
without one), the force that the device was given, the sum of the `TickFlag`s, the buttons, and the number of the frame
that a moving surface went to (NaN for a static surface)."""


class Spread(NamedTuple):
    """Percentiles and maximum of a time, microseconds."""

    p50: float
    p99: float
    p999: float
    most: float


class FilmFelt(NamedTuple):
    """Statistics of a film that was played to a loop."""

    shown: int
    """The frames that were sent to the loop."""
    dropped: int
    """The frames sent that the loop never went to, because a later frame replaced them."""
    skipped: int
    """The frames that were over before they could be processed."""
    damaged: int
    """The frames that could not be read, or had no depth."""
    per_s: float
    """The frames shown per second."""
    age_ms: float | None
    """The delay from when a frame is due to when it is shown, median of the last thousand; None in simulated time."""


@dataclass(frozen=True)
class ServoReport:
    """Statistics of a force loop since it started."""

    ticks: int
    time_s: float
    state: HapticState
    force: Force
    peak_force_n: float
    work_j: float
    """The work done by the device on the hand; above 0 the loop has generated energy."""
    stopped: str = ""
    """The reason why the loop ended; "" while it runs."""
    period_us: Spread | None = None
    """The time from one tick to the next; None in simulated time."""
    late_us: Spread | None = None
    """The delay from when a tick was due to when it began; None in simulated time."""
    overruns: int = 0
    """The periods without a tick."""
    flagged: Mapping[str, int] = field(default_factory=dict[str, int])
    """The number of ticks by the name of their `TickFlag`; flags that no tick has are left out."""
    contact_share: float | None = None
    """The share of ticks in which the device was given a force; None in simulated time (see the recording)."""
    median_contact_force_n: float | None = None
    """The median of that force, within half a millinewton; 0 without contact."""
    part: str = ""
    """The name of the part under the tip; "" if the surface has no parts."""
    beacon: int | None = None
    """The number of the part that a beacon pulls to; None without a beacon."""
    material: str = ""
    """The name of the material under the tip; "" if the surface has no materials."""
    frame: int | None = None
    """The number of the frame that a moving surface goes to; None for a static surface."""
    film: FilmFelt | None = None
    """The statistics of the film; None for a static surface."""
