"""The ring: memory that a force loop shares with its observers, of fixed layout, mapped by all of them.

It has the name of a file, in memory; on Windows, which has no such files, of a section of the paging file.

All numbers are in the machine's own byte order, one section after the other, each starting at a multiple of 64 bytes:

| section | type | meaning |
|---|---|---|
| header | int64 (64,) | the words named below |
| sums | float64 (64,) | the sums named below |
| guard | float64 (128,) | memory and counts of the guard (`guard`) |
| late | int64 (4096,) | histogram of lateness in microseconds; the last bin holds all later ticks |
| period | int64 (4096,) | histogram of the time since the tick before, in microseconds |
| contact | int64 (32768,) | histogram of forces above zero in millinewtons; the last bin holds all stronger forces |
| stamps | int64 (n,) | number of the tick in each slot, -1 while it is written |
| ticks | float64 (n, 17) | `data.TICK_COLUMNS`; tick k is in slot k modulo n |
| asked | int64 (16,) | the requested beacon and the active one (`beacon`) |
| pull | float64 (16,) | the place of the beacon's grid, and how far its pull has faded in (`beacon`) |
| field | float32 (1048576,) | the beacon's potential; without memory until a beacon is requested |

Only the loop writes, with two exceptions: the word STOP, which anybody may set and nobody clears, and the request for a
beacon, which the program writes that started the loop. A reader of a slot compares its stamp before and after: if it
differs, the slot was overwritten meanwhile, and is read again or given up.
"""

from pathlib import Path
from typing import Self, final

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS
from ..errors import DeviceError
from ..runtime.system import shared_memory
from ..runtime.system.shared_memory import shared_folder
from .beacon import HELD, MAX_CELLS, BeaconMemory

MAGIC, LAYOUT = 0x54414E47_49424C45, 5  # the first word of every ring, and the version of this layout
(
    IS_MAGIC,
    IS_LAYOUT,
    SLOTS,
    COUNT,
    STOP,
    PERIOD_NS,
    START_NS,
    NEXT_NS,
    OVERRUNS,
    LEAD_NS,
    LAST,
    PREVIOUS_NS,
    SPINS,
    MARKS,
    SWAP,
) = range(15)
"""Words of the header, after the first two: number of slots; number of ticks so far; 1 if the loop is to end, or has
ended; the period; the time of its first tick and of the next one, in nanoseconds of the monotonic clock; number of
periods without a tick; lead with which the loop wakes before a tick; number of ticks after which it ends; time of the
last tick; 1 if it may spin before a tick; flags for the next tick; 1 if another scene is ready."""
# Indices of the sums: greatest force; work on the hand; greatest lateness of a tick; longest period.
PEAK_N, WORK_J, MAX_LATE_S, LONGEST_S = range(4)
WIDEST_US = 4096  # number of bins of `late` and `period`, 1 us each
STRONGEST_MN = 32768  # number of bins of `contact`, 1 mN each
ALIGN = 64  # alignment of the sections, bytes: a cache line


@final
class Ring:
    """The sections of a ring as arrays; `create` makes the memory, `attach` opens it."""

    def __init__(self, path: Path, memory: memoryview, slots: int) -> None:
        self.path = path
        sections = _sections(slots)
        at = 0
        arrays: dict[str, np.ndarray] = {}
        for name, (kind, shape) in sections.items():
            arrays[name] = np.frombuffer(memory, kind, int(np.prod(shape)), at).reshape(shape)
            at += _padded_size(arrays[name].nbytes)
        self.header: np.ndarray = arrays["header"]
        self.sums: np.ndarray = arrays["sums"]
        self.guard: np.ndarray = arrays["guard"]
        self.late: np.ndarray = arrays["late"]
        self.period: np.ndarray = arrays["period"]
        self.contact: np.ndarray = arrays["contact"]
        self.stamps: np.ndarray = arrays["stamps"]
        self.ticks: np.ndarray = arrays["ticks"]
        self.beacon: BeaconMemory = BeaconMemory(arrays["asked"], arrays["pull"], arrays["field"])

    @classmethod
    def create(cls, slots: int = 8192) -> Self:
        """Create a ring of zeros, with slots for this number of ticks. Raises: DeviceError if there is no room."""
        shared_memory.delete_stale()
        try:
            path, memory = shared_memory.create("ring", _size(slots), _padded_size(4 * MAX_CELLS))
        except OSError as error:
            why = error.strerror or error
            raise DeviceError(f"{shared_folder()}: no room for the loop's shared memory: {why}") from error
        ring = cls(path, memory, slots)
        ring.header[[IS_MAGIC, IS_LAYOUT, SLOTS]] = MAGIC, LAYOUT, slots
        ring.beacon.words[HELD] = -1
        return ring

    @classmethod
    def attach(cls, path: Path) -> Self:
        """Open the ring of this name. Raises: DeviceError if it is not a ring, or has another layout."""
        try:
            memory = shared_memory.attach(path)
        except (OSError, ValueError) as error:
            raise DeviceError(f"{path}: no force loop runs there: {error}") from error
        magic, layout, slots = np.frombuffer(memory, np.int64, 3).tolist() if len(memory) >= 24 else (0, 0, 0)
        if magic != MAGIC or layout != LAYOUT or len(memory) != _size(slots):
            raise DeviceError(f"{path}: is not a ring of layout {LAYOUT}; watch it with the version that wrote it")
        return cls(path, memory, slots)

    def allocate_beacon(self) -> None:
        """Allocate memory for the field: otherwise a process that writes there while memory is full would be killed."""
        size = self.beacon.field.nbytes
        try:
            shared_memory.make_room(self.path, _size(len(self.stamps)) - size, size)
        except FileNotFoundError as error:  # the loop removes it as it ends
            raise DeviceError("the force loop has ended") from error
        except OSError as error:
            raise DeviceError(f"{self.path.parent}: no room for a beacon: {error.strerror or error}") from error

    def remove(self) -> None:
        """Remove the name; processes that have mapped the memory may go on reading."""
        shared_memory.remove(self.path)

    @property
    def count(self) -> int:
        """The number of ticks so far, and so the number of the next one."""
        return int(self.header[COUNT])

    @property
    def start_ns(self) -> int:
        """The time at which the first tick was due, nanoseconds of the monotonic clock; origin of a tick's `time_s`."""
        return int(self.header[START_NS])

    @property
    def overruns(self) -> int:
        """The number of periods without a tick."""
        return int(self.header[OVERRUNS])

    def latest(self) -> Float64[np.ndarray, "c"] | None:
        """Return the newest tick, a row of `TICK_COLUMNS`; None before the first, or if overwritten during the read."""
        number = self.count - 1
        if number < 0:
            return None
        slot = number % len(self.stamps)
        row = self.ticks[slot].copy()
        return row if self.stamps[slot] == number else None  # as in `since`, reading the stamp afterwards is enough

    def since(self, first: int) -> tuple[Float64[np.ndarray, "n c"], int]:
        """Return the ticks from number `first` on that still exist, and the number of the next tick."""
        count = self.count
        numbers = np.arange(max(first, count - len(self.stamps), 0), count)
        slots = numbers % len(self.stamps)
        # Ticks below COUNT are stamped, and no slot ever gets an earlier stamp again, so reading the stamp afterwards
        # would do. Reading it before too is the rule that the table above gives to other readers, and costs nothing.
        before = self.stamps[slots]
        rows = self.ticks[slots]
        whole = (before == numbers) & (self.stamps[slots] == numbers)
        return rows[whole], count


def _sections(slots: int) -> dict[str, tuple[type, tuple[int, ...]]]:
    return {
        "header": (np.int64, (64,)),
        "sums": (np.float64, (64,)),
        "guard": (np.float64, (128,)),
        "late": (np.int64, (WIDEST_US,)),
        "period": (np.int64, (WIDEST_US,)),
        "contact": (np.int64, (STRONGEST_MN,)),
        "stamps": (np.int64, (slots,)),
        "ticks": (np.float64, (slots, len(TICK_COLUMNS))),
        "asked": (np.int64, (16,)),
        "pull": (np.float64, (16,)),
        "field": (np.float32, (MAX_CELLS,)),
    }


def _padded_size(size: int) -> int:
    return -(-size // ALIGN) * ALIGN


def _size(slots: int) -> int:
    return sum(_padded_size(np.dtype(kind).itemsize * int(np.prod(shape))) for kind, shape in _sections(slots).values())
