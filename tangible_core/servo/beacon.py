"""A beacon: a gentle pull along the surface to one of its parts, for a hand that looks for it.

The pull is U' of a potential over the plane, U = F (sqrt(D^2 + s^2) - s): a spring near the part that grows no stronger
than F far away. D is the distance to the nearest point of the part, zero within it; ridges of D, where two ways are
equally long, are rounded off. The potential is sampled on a grid, and a quadratic B-spline between: its gradient is
exact and steady, so that no closed path gains energy. `beacon_kernels` has what happens in a tick.
"""
# pyright: reportMissingTypeStubs=false

from dataclasses import dataclass
from typing import Any, NamedTuple, Self, cast, final

import numpy as np
from jaxtyping import Float32, Float64

from ..data import HapticSurface, TickFlag
from ..data.records import Record
from ..data.ticks import BEACON_SHIFT, MOST_BEACON_PARTS
from ..errors import ConfigError, GeometryError, did_you_mean, quoted

PULL_N, MOST_N = 0.8, 1.0
"""The pull far away from the part; and the most that it is with its damping."""
SOFT_M = 0.005
"""Distance at which the pull is 0.7 of that; over it the spring goes over into a steady pull."""
DAMPING_N_S_PER_M = 0.5
"""Across the surface, wherever it pulls; never more than MOST_N - PULL_N."""
BRAKED_FROM = 0.125
"""Share of the pull from which on the damping is whole: sampling a spring adds energy where it is steep, next to the
part, where the pull itself is nearly nothing."""
RAMP_S = 0.5
"""Over which a pull fades in."""
STIFFNESS_N_PER_M = PULL_N / SOFT_M
"""The steepest rise of the pull, next to the part."""
ROUNDED_M = 0.0015
"""Standard deviation by which ridges of the distance are rounded."""
MARGIN_M = 0.03
"""So far beyond the picture a hand is pulled back to it; farther away along its side alone."""
MOST_CELLS = 1 << 20
"""Of a beacon's grid, margins included: cells of 0.2 mm on a picture of 160 mm."""
ALL_BUTTONS = 0x7FFFFFFF
"""Every button of a device."""

(ASKED, PART, ROWS, COLUMNS, BUTTONS, SEEN, LET_GO, WHY, HELD, TICKS, WORDS) = range(11)
"""Words. Whoever asks writes the number of the ask (0 for no beacon), the part, the size of the grid, and the buttons
that release it; the loop writes the ask that is felt now, the last one that is over and why, the buttons that were held
in the tick before (-1 before the first), and in how many ticks a beacon was on. The last is how many there are."""
(LEFT_M, FAR_M, ACROSS_M, DOWN_M, RAMP, X_M, Y_M, U_J, NUMBERS) = range(9)
"""Numbers: where the grid's first value stands, and its pitches; of the loop, the share of the force that has faded in,
and the place and the potential of the tick before. The last is how many there are."""
BY_BUTTON, BY_SCENE = 1, 2
"""Of WHY: a button was pressed; another scene is felt."""
BUTTON, SCENE = "button", "scene"
REASONS = {0: "", BY_BUTTON: BUTTON, BY_SCENE: SCENE}


@dataclass(frozen=True, eq=False)
class Beacon(Record):
    """Where a part pulls from everywhere, as a loop takes it. Made by `beacon_to`; it can be sent to another process.

    potential_j: float32 (h, w), values at nodes `pitch_m` apart, the first at (left_m, far_m), rows towards the user.
    """

    part: int
    name: str
    """Empty where nobody gave the part one."""
    potential_j: Float32[np.ndarray, "h w"]
    left_m: float
    far_m: float
    pitch_m: tuple[float, float]


class BeaconState(NamedTuple):
    """Whether a beacon is on, and why not."""

    part: int | None
    """The number of the part that pulls; none where none is."""
    why: str = ""
    """`button` where a button released it, `scene` where another scene is felt since; else empty."""


@final
class BeaconMemory:
    """The numbers by which whoever asks for a beacon and the loop that gives it know of each other."""

    def __init__(
        self, words: np.ndarray | None = None, numbers: np.ndarray | None = None, field: np.ndarray | None = None
    ) -> None:
        self.words = np.zeros(WORDS, np.int64) if words is None else words
        self.numbers = np.zeros(NUMBERS) if numbers is None else numbers
        self.field = np.zeros(1, np.float32) if field is None else field

    @classmethod
    def ready(cls) -> Self:
        """A memory before the first tick."""
        made = cls()
        made.words[HELD] = -1
        return made

    @classmethod
    def of(cls, beacon: Beacon | None) -> Self:
        """For a loop in this process, with this beacon from the first tick on."""
        made = cls.ready()
        if beacon is not None:
            made.field = np.zeros(beacon.potential_j.size, np.float32)
            made.put(beacon)
        return made

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As kernels take them."""
        return self.words, self.numbers, self.field

    def put(self, beacon: Beacon, buttons: int = ALL_BUTTONS) -> None:
        """Ask for it. No other may be felt meanwhile (`SEEN` is 0): the grid is written over."""
        rows, columns = beacon.potential_j.shape
        self.field[: rows * columns] = beacon.potential_j.ravel()
        self.numbers[[LEFT_M, FAR_M, ACROSS_M, DOWN_M]] = beacon.left_m, beacon.far_m, *beacon.pitch_m
        self.words[[PART, ROWS, COLUMNS, BUTTONS]] = beacon.part, rows, columns, buttons
        self.words[ASKED] = 1 + max(self.words[LET_GO], self.words[SEEN])

    def leave(self) -> None:
        """Another scene is felt: a beacon is over. For the loop alone."""
        words = self.words
        if words[ASKED] and words[ASKED] != words[LET_GO]:
            words[LET_GO], words[WHY], words[SEEN] = words[ASKED], BY_SCENE, 0

    @property
    def state(self) -> BeaconState:
        """As it is now."""
        asked = int(self.words[ASKED])
        if asked and asked != self.words[LET_GO]:
            return BeaconState(int(self.words[PART]))
        return BeaconState(None, REASONS[int(self.words[WHY])] if asked else "")


def beacon_flags(part: int) -> int:
    """Of a tick in which a beacon to this part was on."""
    return int(TickFlag.BEACON) | part << BEACON_SHIFT


def part_number(surface: HapticSurface, part: str | int) -> int:
    """The number of a part by its number or its name. Raises: ConfigError with what there is, if there is none such."""
    names = surface.names
    if names is None or surface.labels is None:
        raise ConfigError("a beacon pulls to a part, and this surface has no parts; say `parts:` or `heights:`")
    if isinstance(part, int):
        if 0 <= part < min(len(names), MOST_BEACON_PARTS):
            return part
        raise ConfigError(f"there is no part {part}; the parts are {_told(names)}")
    wanted = part.strip()
    found = [number for number, name in enumerate(names) if wanted and name == wanted]
    if len(found) > 1:
        raise ConfigError(f"{len(found)} parts are called {quoted(wanted)}; say which by its number: {_listed(found)}")
    if found:
        return part_number(surface, found[0])
    if wanted.isdecimal():
        return part_number(surface, int(wanted))
    hint = did_you_mean(wanted, [name for name in names if name])
    raise ConfigError(f"no part is called {quoted(wanted)}{hint}; the parts are {_told(names)}")


def beacon_to(surface: HapticSurface, part: str | int) -> Beacon:
    """A beacon to a part of a surface, by its number or its name.

    Raises: ConfigError if there is none such, GeometryError if the part has no cell on this surface.
    """
    number = part_number(surface, part)
    assert surface.labels is not None and surface.names is not None
    cells = surface.labels == number
    if not cells.any():
        raise GeometryError(f"part {number} is too small for a cell of the surface that is felt; choose another one")
    across_m, down_m = surface.relief.pitch_m
    step = _step(cells.shape, (across_m, down_m))
    cells, above, beside = _coarse(cells, step, (across_m, down_m))
    across_m, down_m = step * across_m, step * down_m
    width_m, length_m = surface.extent_m
    return Beacon(
        part=number,
        name=surface.names[number],
        potential_j=_potential(_distance(cells, across_m, down_m)),
        left_m=-width_m / 2 + (0.5 - beside) * across_m,
        far_m=length_m / 2 - (0.5 - above) * down_m,
        pitch_m=(across_m, down_m),
    )


def _step(shape: tuple[int, int], pitch_m: tuple[float, float]) -> int:
    """Cells of the surface to one of the beacon's, along each side."""
    step = 1
    while np.prod([-(-cells // step) + 2 * _margin(step * pitch)
                   for cells, pitch in zip(shape, reversed(pitch_m), strict=True)]) > MOST_CELLS:  # fmt: skip
        step += 1
    return step


def _margin(pitch_m: float) -> int:
    """Cells beyond the picture; of very large ones two, which the spline needs, of very small ones 256."""
    return min(max(2, int(np.ceil(MARGIN_M / pitch_m))), 256)


def _coarse(cells: np.ndarray, step: int, pitch_m: tuple[float, float]) -> tuple[np.ndarray, int, int]:
    """The part in cells of so many, each of which holds any of it; and how many were added above and to the left."""
    across, down = (_margin(step * pitch) for pitch in pitch_m)
    rows, columns = cells.shape
    filled = np.pad(cells, ((0, -rows % step), (0, -columns % step)))
    blocks = filled.reshape(filled.shape[0] // step, step, filled.shape[1] // step, step).any(axis=(1, 3))
    return np.pad(blocks, ((down, down), (across, across))), down, across


def _distance(cells: np.ndarray, across_m: float, down_m: float) -> Float64[np.ndarray, "h w"]:
    """To the nearest cell of the part, metres, its ridges rounded; 0 on the part's cells and on those around it.

    A Gaussian lowers a distance at its ridges alone: elsewhere, it is as it was or lies above, and the less counts. As
    those around the part are 0 as well, the spline is nothing wherever in a cell of the part the tip may be.
    """
    from scipy import ndimage

    filters = cast(Any, ndimage)
    exact: np.ndarray = filters.distance_transform_edt(~cells, sampling=(down_m, across_m))
    smooth: np.ndarray = filters.gaussian_filter(exact, (ROUNDED_M / down_m, ROUNDED_M / across_m), mode="nearest")
    return np.maximum(np.minimum(exact, smooth) - 1.0001 * np.hypot(across_m, down_m), 0.0)


def _potential(distance_m: Float64[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    return np.ascontiguousarray(PULL_N * (np.hypot(distance_m, SOFT_M) - SOFT_M), np.float32)


def _told(names: tuple[str, ...]) -> str:
    """The parts with their names, or their numbers alone; few enough for a line."""
    named = [f"{number}: {quoted(name)}" for number, name in enumerate(names) if name]
    if not named:
        return f"0 to {len(names) - 1}, none of which has a name"
    more = f" and {len(named) - MOST_TOLD} others" if len(named) > MOST_TOLD else ""
    return ", ".join(named[:MOST_TOLD]) + more


MOST_TOLD = 20


def _listed(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers))
