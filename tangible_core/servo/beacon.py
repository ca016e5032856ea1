"""A beacon: a gentle pull along the surface towards one of its parts, for a hand that looks for it.

The pull is the gradient of a potential over the plane, U = F (sqrt(D^2 + s^2) - s): a spring near the part that never
exceeds F far away. D is the distance to the nearest point of the part, zero within it; ridges of D, where two ways are
equally long, are rounded off. The potential is sampled on a grid and interpolated by a quadratic B-spline: its gradient
is exact and continuous, so that no closed path gains energy. `beacon_kernels` has the beacon's tick.
"""
# pyright: reportMissingTypeStubs=false

from dataclasses import dataclass
from typing import Any, NamedTuple, Self, cast, final

import numpy as np
from jaxtyping import Float32, Float64

from ..data import HapticSurface
from ..data.part_words import label_of_number, name_part, shown_number
from ..data.records import Record
from ..data.ticks import MAX_BEACON_PARTS
from ..errors import ConfigError, GeometryError, did_you_mean, quoted

# The pull far away from the part, N; and the greatest force of a beacon, with its damping.
PULL_N, MAX_N = 0.8, 1.0
SOFT_M = 0.005  # distance at which the pull is 0.7 of PULL_N, and the spring changes into a constant pull
# Damping along the surface, wherever the beacon pulls; its force is at most MAX_N - PULL_N.
DAMPING_N_S_PER_M = 0.5
BRAKED_FROM = 0.125
"""Share of the pull from which on the damping is whole: sampling a spring adds energy where it is steep, next to the
part, where the pull itself is nearly zero."""
RAMP_S = 0.5
STIFFNESS_N_PER_M = PULL_N / SOFT_M  # the steepest slope of the pull, next to the part
ROUNDED_M = 0.0015  # standard deviation of the Gaussian that rounds the ridges of the distance
# Margin of the grid around the picture, in which a hand is pulled back; beyond it the pull is along the edge alone.
MARGIN_M = 0.03
# Greatest number of cells of a beacon's grid, margins included: cells of 0.2 mm on a picture of 160 mm.
MAX_CELLS = 1 << 20
ALL_BUTTONS = 0x7FFFFFFF  # bits of every button of a device

(ASKED, PART, ROWS, COLUMNS, BUTTONS, SEEN, LET_GO, WHY, HELD, TICKS, WORDS) = range(11)
"""Indices of the words; the last is their number.

The program writes the number of its request (0 for no beacon), the part, the size of the grid, and the buttons that
release the beacon. The loop writes the request that acts now, the last request that ended and why, the buttons held in
the tick before (-1 before the first), and the number of ticks with a beacon.
"""
(LEFT_M, FAR_M, ACROSS_M, DOWN_M, RAMP, X_M, Y_M, U_J, NUMBERS) = range(9)
"""Indices of the numbers; the last is their number.

The program writes the place of the grid's first value and the pitches. The loop writes the factor by which the force
has faded in, and the place and the potential of the tick before.
"""
BY_BUTTON, BY_SCENE = 1, 2  # values of WHY: a button was pressed; another scene was swapped in
BUTTON, SCENE = "button", "scene"  # the same reasons in `BeaconState.why`
REASONS = {0: "", BY_BUTTON: BUTTON, BY_SCENE: SCENE}


@dataclass(frozen=True, eq=False)
class Beacon(Record):
    """The potential of a part's pull, by `beacon_to`, for a force loop; it can be sent to another process.

    potential_j: float32 (h, w), values at nodes `pitch_m` apart, the first at (left_m, far_m), rows towards the user.
    """

    part: int
    name: str
    """The part's name; empty if it has none."""
    potential_j: Float32[np.ndarray, "h w"]
    left_m: float
    far_m: float
    pitch_m: tuple[float, float]


class BeaconState(NamedTuple):
    """The state of a beacon: on, or off and why."""

    part: int | None
    """The number of the part that pulls; None if no beacon is on."""
    why: str = ""
    """`button` if a button released the beacon, `scene` if another scene was swapped in; else empty."""


@final
class BeaconMemory:
    """The memory that a program and its force loop share about a beacon."""

    def __init__(
        self, words: np.ndarray | None = None, numbers: np.ndarray | None = None, field: np.ndarray | None = None
    ) -> None:
        self.words: np.ndarray = np.zeros(WORDS, np.int64) if words is None else words
        self.numbers: np.ndarray = np.zeros(NUMBERS) if numbers is None else numbers
        self.field: np.ndarray = np.zeros(1, np.float32) if field is None else field

    @classmethod
    def ready(cls) -> Self:
        """Return a memory for a loop before its first tick."""
        memory = cls()
        memory.words[HELD] = -1
        return memory

    @classmethod
    def of(cls, beacon: Beacon | None) -> Self:
        """Return a memory for a loop in this process, with this beacon from the first tick on."""
        memory = cls.ready()
        if beacon is not None:
            memory.field = np.zeros(beacon.potential_j.size, np.float32)
            memory.put(beacon)
        return memory

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The words, numbers and field, as arguments of the kernels."""
        return self.words, self.numbers, self.field

    def put(self, beacon: Beacon, buttons: int = ALL_BUTTONS) -> None:
        """Request a beacon. No other one may act meanwhile (`SEEN` is 0), as its grid is overwritten."""
        rows, columns = beacon.potential_j.shape
        self.field[: rows * columns] = beacon.potential_j.ravel()
        self.numbers[[LEFT_M, FAR_M, ACROSS_M, DOWN_M]] = beacon.left_m, beacon.far_m, *beacon.pitch_m
        self.words[[PART, ROWS, COLUMNS, BUTTONS]] = beacon.part, rows, columns, buttons
        self.words[ASKED] = 1 + max(self.words[LET_GO], self.words[SEEN])

    def leave(self) -> None:
        """End the beacon, as another scene was swapped in. Only the loop calls this."""
        words = self.words
        if words[ASKED] and words[ASKED] != words[LET_GO]:
            words[LET_GO], words[WHY], words[SEEN] = words[ASKED], BY_SCENE, 0

    @property
    def state(self) -> BeaconState:
        """The state now."""
        request = int(self.words[ASKED])
        if request and request != self.words[LET_GO]:
            return BeaconState(int(self.words[PART]))
        return BeaconState(None, REASONS[int(self.words[WHY])] if request else "")


def part_number(surface: HapticSurface, part: str | int) -> int:
    """Return the label of a part, given by its label, or as text by its name or its number from 1."""
    names = surface.names
    if names is None or surface.labels is None:
        raise ConfigError("a beacon pulls to a part, and this surface has no parts; add `parts:` or `heights:`")
    if isinstance(part, int):
        if 0 <= part < min(len(names), MAX_BEACON_PARTS):
            return part
        raise ConfigError(f"there is no {name_part(part)}; the parts are {_list_parts(names)}")
    text = part.strip()
    numbers = [number for number, name in enumerate(names) if text and name == text]
    if len(numbers) > 1:
        choice = ", ".join(str(shown_number(each)) for each in numbers)
        raise ConfigError(f"{len(numbers)} parts are called {quoted(text)}; choose one by its number: {choice}")
    if numbers:
        return part_number(surface, numbers[0])
    if text.isdecimal():
        return part_number(surface, label_of_number(int(text)))
    hint = did_you_mean(text, [name for name in names if name])
    raise ConfigError(f"no part is called {quoted(text)}{hint}; the parts are {_list_parts(names)}")


def beacon_to(surface: HapticSurface, part: str | int) -> Beacon:
    """Return a beacon to a part of a surface, given as in `part_number`."""
    number = part_number(surface, part)
    assert surface.labels is not None and surface.names is not None
    cells = surface.labels == number
    if not cells.any():
        raise GeometryError(f"{name_part(number)} is too small for a cell of the surface; choose another one")
    across_m, down_m = surface.relief.pitch_m
    step = _step(cells.shape, (across_m, down_m))
    cells, above, left = _coarsen(cells, step, (across_m, down_m))
    across_m, down_m = step * across_m, step * down_m
    width_m, length_m = surface.extent_m
    distance_m = _distance(cells, across_m, down_m)
    return Beacon(
        part=number,
        name=surface.names[number],
        potential_j=np.ascontiguousarray(PULL_N * (np.hypot(distance_m, SOFT_M) - SOFT_M), np.float32),
        left_m=-width_m / 2 + (0.5 - left) * across_m,
        far_m=length_m / 2 - (0.5 - above) * down_m,
        pitch_m=(across_m, down_m),
    )


def _step(shape: tuple[int, int], pitch_m: tuple[float, float]) -> int:
    """Return the number of surface cells in one cell of the beacon, along each side."""
    step = 1
    while np.prod([-(-cells // step) + 2 * _margin(step * pitch)
                   for cells, pitch in zip(shape, reversed(pitch_m), strict=True)]) > MAX_CELLS:  # fmt: skip
        step += 1
    return step


def _margin(pitch_m: float) -> int:
    """Return the margin in cells: at least 2, which the spline needs, and at most 256."""
    return min(max(2, int(np.ceil(MARGIN_M / pitch_m))), 256)


def _coarsen(cells: np.ndarray, step: int, pitch_m: tuple[float, float]) -> tuple[np.ndarray, int, int]:
    """Return the part in blocks of step x step cells, with a margin, and the margins above and to the left."""
    across, down = (_margin(step * pitch) for pitch in pitch_m)
    rows, columns = cells.shape
    grid = np.pad(cells, ((0, -rows % step), (0, -columns % step)))
    blocks = grid.reshape(grid.shape[0] // step, step, grid.shape[1] // step, step).any(axis=(1, 3))
    return np.pad(blocks, ((down, down), (across, across))), down, across


def _distance(cells: np.ndarray, across_m: float, down_m: float) -> Float64[np.ndarray, "h w"]:
    """Return the distance to the nearest cell of the part, metres, its ridges rounded.

    A Gaussian lowers a distance only at its ridges: elsewhere the result is equal or greater, and the lesser of both
    counts. The distance is 0 on the cells around the part too, so that the spline is zero wherever in a cell of the
    part the tip may be.
    """
    from scipy import ndimage

    filters = cast(Any, ndimage)
    exact: np.ndarray = filters.distance_transform_edt(~cells, sampling=(down_m, across_m))
    smooth: np.ndarray = filters.gaussian_filter(exact, (ROUNDED_M / down_m, ROUNDED_M / across_m), mode="nearest")
    return np.maximum(np.minimum(exact, smooth) - 1.0001 * np.hypot(across_m, down_m), 0.0)


def _list_parts(names: tuple[str, ...]) -> str:
    """Return the parts with their names, or their numbers alone; few enough for a line."""
    labels = [f"{shown_number(number)}: {quoted(name)}" for number, name in enumerate(names) if name]
    if not labels:
        return f"1 to {len(names)}, none of which has a name"
    more = f" and {len(labels) - MAX_LISTED} others" if len(labels) > MAX_LISTED else ""
    return ", ".join(labels[:MAX_LISTED]) + more


MAX_LISTED = 20
