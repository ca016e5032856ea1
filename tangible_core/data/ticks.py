"""What a force loop keeps of its ticks, and says of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntFlag
from typing import NamedTuple

from .device import Force, HapticState


class TickFlag(IntFlag):
    """What happened in one tick of a force loop; any number of them at once."""

    TOUCHING = 1
    """The law gave a force."""
    FORCE_LIMITED = 2
    """The force was over the greatest allowed, and scaled down."""
    SLEW_LIMITED = 4
    """The force changed by more than is allowed in a tick, and only went part of the way."""
    STIFFNESS_LIMITED = 8
    """The law is stiffer than this loop and device hold stably, and was softened."""
    RAMPING = 16
    """The force is fading in."""
    NOT_FINITE = 32
    """The law gave NaN or infinity, or the device did; the force was zero."""
    DAMPED = 64
    """The passivity controller took back energy that the loop had given away."""
    STALE = 128
    """The device had no fresh position for too long; the force was zero."""
    OVERRUN = 256
    """The tick began more than a period late."""
    SWAPPED = 512
    """The first tick on a new scene."""
    BEACON = 1024
    """A beacon pulled, or was about to; the number of its part stands in the bits above this one (`beacon_part`)."""


BEACON_SHIFT = 11
"""Where the number of a beacon's part begins among the flags of a tick."""
MOST_BEACON_PARTS = 1 << 20
"""Numbers from here on do not fit there."""


def beacon_part(flags: int) -> int | None:
    """The number of the part that a beacon pulled to in a tick with these flags; None for no beacon.

    >>> beacon_part(TickFlag.TOUCHING | TickFlag.BEACON | 6 << BEACON_SHIFT), beacon_part(TickFlag.TOUCHING)
    (6, None)
    """
    return flags >> BEACON_SHIFT if flags & TickFlag.BEACON else None


UNTOUCHED = TickFlag.TOUCHING | TickFlag.OVERRUN | TickFlag.SWAPPED
"""Flags that leave the law's force as it was. Each of the others names what changed it."""

TICK_COLUMNS = (
    *("time_s", "late_s"),
    *("x_m", "y_m", "z_m"),
    *("vx_m_per_s", "vy_m_per_s", "vz_m_per_s"),
    *("proxy_x_m", "proxy_y_m", "proxy_z_m"),
    *("fx_n", "fy_n", "fz_n"),
    *("flags", "buttons"),
    "frame",
)
"""What is kept of a tick, each a float64: when it began and how late, the tip, the proxy (NaN where there is none), the
force that the device was given, the sum of its `TickFlag`s, the buttons, and the number of the frame that a surface
which moves went to (NaN of one that stands still)."""


class Spread(NamedTuple):
    """How a time scatters, in microseconds."""

    p50: float
    p99: float
    p999: float
    most: float


class FilmFelt(NamedTuple):
    """How a film was played to a loop."""

    shown: int
    """Frames that the surface was sent to."""
    dropped: int
    """Of these, those that the loop never went to, as a later one took their place."""
    skipped: int
    """Frames that were over before they could be looked at."""
    damaged: int
    """Frames that could not be read, or showed no depth."""
    per_s: float
    """Frames shown a second."""
    age_ms: float | None
    """From when a frame is due to when it is shown, the median of the last thousand; none where time is simulated."""


@dataclass(frozen=True)
class ServoReport:
    """How a force loop is doing since it started."""

    ticks: int
    time_s: float
    state: HapticState
    force: Force
    peak_force_n: float
    work_j: float
    """Work done by the device on the hand; above 0 the loop gave energy away."""
    stopped: str = ""
    """Why the loop ended; empty while it runs."""
    period_us: Spread | None = None
    """From one tick to the next; none where time is simulated."""
    late_us: Spread | None = None
    """From when a tick was due to when it began."""
    overruns: int = 0
    """Periods that had no tick."""
    flagged: Mapping[str, int] = field(default_factory=dict[str, int])
    """Ticks by the name of the `TickFlag` that they have, those that none has left out."""
    contact_share: float | None = None
    """Share of the ticks in which the device was given a force; none where time is simulated: see the recording."""
    median_contact_force_n: float | None = None
    """Of that force, within half a millinewton; 0 where there was none."""
    part: str = ""
    """What the part of the picture under the tip is called; empty where the surface has none."""
    beacon: int | None = None
    """Number of the part that a beacon pulls to; none where no beacon is on."""
    material: str = ""
    """The name of the material under the tip, of parts or of segments; empty where the surface has none."""
    frame: int | None = None
    """Number of the frame that a surface which moves goes to; none where it stands still."""
    film: FilmFelt | None = None
    """How the film is played that is felt; none where the surface stands."""
