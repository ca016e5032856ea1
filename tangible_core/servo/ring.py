"""The memory that a force loop shares with whoever watches it: a file of fixed layout, mapped by both.

All numbers are in the machine's own byte order, one section after the other, each starting at a multiple of 64 bytes:

| section | type | meaning |
|---|---|---|
| header | int64 (64,) | the words named below |
| sums | float64 (64,) | those named below |
| guard | float64 (128,) | what the guard remembers and has counted (`guard`) |
| late | int64 (4096,) | ticks that began so many microseconds late; the last for all that were later |
| period | int64 (4096,) | ticks that came so many microseconds after the one before |
| contact | int64 (32768,) | ticks with a force, by whole millinewtons of it; the last for all that were stronger |
| stamps | int64 (n,) | number of the tick that lies in each slot, -1 while it is written |
| ticks | float64 (n, 17) | `data.TICK_COLUMNS`; tick k lies in slot k modulo n |
| asked | int64 (16,) | which beacon is asked for, and which is felt (`beacon`) |
| pull | float64 (16,) | where the beacon's grid lies, and how far its pull has faded in (`beacon`) |
| field | float32 (1048576,) | the beacon's potential; without memory of its own until one is asked for |

The loop alone writes, but for the word STOP, which anybody may set and nobody clears, and what asks for a beacon, which
the program writes that started the loop. Who reads a slot looks at its
stamp before and after: if it is not the same, the slot was overwritten meanwhile, and is read again or given up.
"""

import mmap
import os
import re
import stat
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Self, final

import numpy as np
from jaxtyping import Float64

from ..data import TICK_COLUMNS
from ..errors import DeviceError
from ..runtime.child_process import is_alive
from .beacon import HELD, MOST_CELLS, BeaconMemory

MAGIC, LAYOUT = 0x54414E47_49424C45, 5
"""The word that begins every ring, and the version of this layout."""
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
"""Words of the header, after the first two: ticks that it has room for; ticks so far; 1 when the loop is to end, or
has; the period; when it started, and when the next tick is due, in nanoseconds of the monotonic clock; periods that had
no tick; how long before a tick the loop wakes; after how many ticks it ends; when the last one began; whether it may
wait for a tick awake; flags for the next tick; 1 when another scene is ready to be felt."""
PEAK_N, WORK_J, MOST_LATE_S, LONGEST_S = range(4)
"""Where the sums stand: greatest force; work done on the hand; the latest tick; the longest period."""
WIDEST_US = 4096
STRONGEST_MN = 32768
ALIGN = 64


@final
class Ring:
    """The sections of a ring's file as arrays; `create` makes the file, `attach` finds it."""

    def __init__(self, path: Path, file: mmap.mmap, slots: int) -> None:
        self.path = path
        self._file = file
        sections = _sections(slots)
        at = 0
        arrays: dict[str, np.ndarray] = {}
        for name, (kind, shape) in sections.items():
            arrays[name] = np.frombuffer(file, kind, int(np.prod(shape)), at).reshape(shape)
            at += _padded(arrays[name].nbytes)
        self.header, self.sums, self.guard = arrays["header"], arrays["sums"], arrays["guard"]
        self.late, self.period, self.contact = arrays["late"], arrays["period"], arrays["contact"]
        self.stamps, self.ticks = arrays["stamps"], arrays["ticks"]
        self.beacon = BeaconMemory(arrays["asked"], arrays["pull"], arrays["field"])

    @classmethod
    def create(cls, slots: int = 8192) -> Self:
        """A new ring of zeros, for so many ticks. Raises: DeviceError if there is no room for it."""
        _sweep()
        folder = shared_folder()
        try:
            number, name = tempfile.mkstemp(".ring", f"{PREFIX}{os.getpid()}-", folder)
            with os.fdopen(number, "r+b") as file:
                file.truncate(_size(slots))
                ring = cls(Path(name), mmap.mmap(file.fileno(), 0), slots)
        except OSError as error:
            raise DeviceError(f"{folder}: no room for the loop's shared memory: {error.strerror or error}") from error
        ring.header[[IS_MAGIC, IS_LAYOUT, SLOTS]] = MAGIC, LAYOUT, slots
        ring.beacon.words[HELD] = -1
        return ring

    @classmethod
    def attach(cls, path: Path) -> Self:
        """The ring in this file. Raises: DeviceError if it is none, or of another layout."""
        try:
            with path.open("r+b") as file:
                mapped = mmap.mmap(file.fileno(), 0)
        except (OSError, ValueError) as error:
            raise DeviceError(f"{path}: no force loop runs there: {error}") from error
        magic, layout, slots = np.frombuffer(mapped, np.int64, 3).tolist() if len(mapped) >= 24 else (0, 0, 0)
        if magic != MAGIC or layout != LAYOUT or len(mapped) != _size(slots):
            raise DeviceError(f"{path}: is not a ring of layout {LAYOUT}; watch it with the version that wrote it")
        return cls(path, mapped, slots)

    def room_for_a_beacon(self) -> None:
        """Have memory under the field: a file without it ends whoever writes there when the memory is full.

        Raises: DeviceError if there is no room.
        """
        if not hasattr(os, "posix_fallocate"):
            return
        size = self.beacon.field.nbytes
        try:
            with self.path.open("r+b") as file:
                os.posix_fallocate(file.fileno(), _size(len(self.stamps)) - size, size)
        except OSError as error:
            raise DeviceError(f"{self.path.parent}: no room for a beacon: {error.strerror or error}") from error

    def remove(self) -> None:
        """Take the file away; who has it mapped may go on reading."""
        self.path.unlink(missing_ok=True)

    @property
    def count(self) -> int:
        """Ticks so far, which is the number of the next one."""
        return int(self.header[COUNT])

    @property
    def start_ns(self) -> int:
        """When the first tick was due, in nanoseconds of the monotonic clock; a tick's `time_s` counts from then."""
        return int(self.header[START_NS])

    @property
    def overruns(self) -> int:
        """Periods that had no tick."""
        return int(self.header[OVERRUNS])

    def latest(self) -> Float64[np.ndarray, "c"] | None:
        """The newest tick, a row of `TICK_COLUMNS`; None before the first, and for one overwritten while it is read."""
        number = self.count - 1
        if number < 0:
            return None
        slot = number % len(self.stamps)
        row = self.ticks[slot].copy()
        return row if self.stamps[slot] == number else None  # as in `since`: a look afterwards is enough

    def since(self, first: int) -> tuple[Float64[np.ndarray, "n c"], int]:
        """Ticks from number `first` on, those still there, and the number of the next one to come.

        If the loop has overwritten some of them there are fewer rows than numbers.
        """
        count = self.count
        numbers = np.arange(max(first, count - len(self.stamps), 0), count)
        slots = numbers % len(self.stamps)
        # Ticks below COUNT are stamped, and no slot gets a stamp back that it had: the look after would do. The one
        # before is the rule that the table above gives to other readers, and costs nothing.
        before = self.stamps[slots]
        rows = self.ticks[slots]
        whole = (before == numbers) & (self.stamps[slots] == numbers)
        return rows[whole], count


def shared_folder() -> Path:
    """$TANGIBLE_SHARED_DIR, or where files are memory alone, if there is such a place: a disk would stop the loop."""
    if named := os.environ.get("TANGIBLE_SHARED_DIR"):
        return Path(named)
    memory = Path("/dev/shm")
    return memory if sys.platform == "linux" and os.access(memory, os.W_OK) else Path(tempfile.gettempdir())


PREFIX = "tangible-"
NAME = re.compile(rf"{PREFIX}([0-9]{{1,9}})-\w+\.(ring|parcel)")
"""Of a file there: the process that made it stands in it."""


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
        "field": (np.float32, (MOST_CELLS,)),
    }


def _padded(size: int) -> int:
    return -(-size // ALIGN) * ALIGN


def _size(slots: int) -> int:
    return sum(_padded(np.dtype(kind).itemsize * int(np.prod(shape))) for kind, shape in _sections(slots).values())


def _sweep() -> None:
    """Take away the files of this user's processes that were killed; what cannot be looked at or removed stays."""
    with suppress(OSError):
        for path in shared_folder().glob(f"{PREFIX}*"):
            with suppress(OSError):
                if _left_behind(path):
                    path.unlink()


def _left_behind(path: Path) -> bool:
    """Whether this file was made by `Ring.create` or `parcel.pack`, for this user, in a process that is gone."""
    named = NAME.fullmatch(path.name)
    about = path.lstat()
    ours = hasattr(os, "getuid") and about.st_uid == os.getuid() and stat.S_ISREG(about.st_mode)
    return bool(named and ours and not is_alive(int(named[1])))
