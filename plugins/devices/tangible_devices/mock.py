"""A device in simulated time: a scripted hand on a simulated handle, for demos, tests and comparisons."""

import math
from pathlib import Path
from typing import Annotated, Literal, Self, final

import numpy as np
from jaxtyping import Float64, Int64
from pydantic import Field, model_validator

from tangible_core.data import DeviceSpec, Force, HapticState, Vector
from tangible_core.plugins import HapticDevice, Link, Scripted

from .paths import DRAWN, Stroke, path_size, read_csv, walk
from .simulated import LIKE_A_FALCON, MovingHand, SimulatedLink, VirtualHand

Height = Annotated[float, Field(ge=-1, le=1)]
Size = Annotated[float, Field(ge=1e-6, le=1)]
MAX_M = (0.06, 0.04)


class Mock(HapticDevice, Scripted):
    """A hand that follows a path, in simulated time: every read is one period later.

    For demos, tests and comparisons, which it makes repeatable to the bit; it needs no device and no real time.

    >>> from tangible import Mock
    >>> with Mock(path="circle").open() as link:
    ...     link.read().position_m
    (0.03, 0.0, 0.03)

    With a virtual hand (the default) the path is the target of the hand. It lies below the surface, so that the hand
    presses and the force pushes it back. Without one (`hand: null`) the tip is exactly on the path, whatever the force.
    Not exclusive: every `open` gives a new device at the start of its path. Its limits are a Novint Falcon's.
    """

    path: Literal["raster", "circle", "spiral", "press", "csv"] = "raster"
    """Path of the hand: over the surface, straight down and up, or recorded in `csv_file`."""
    csv_file: Path | None = None
    """Recorded path with columns time_s, x_m, y_m, z_m; played once, linear between rows, then held at its end."""
    size_m: tuple[Size, Size] | None = None
    """Width and length of raster, circle and spiral, which are centred; null: 60 x 40 mm, or three quarters of
    a smaller surface."""
    lines: Annotated[int, Field(ge=2, le=200)] = 8
    """Number of lines of the raster, or turns of the spiral."""
    z_m: Height = -0.005
    """Height of the path above the base plane; below the surface, the hand presses. The lowest point of `press`."""
    lift_m: Height = 0.03
    """Height at which `press` and a virtual hand start."""
    speed_m_per_s: Annotated[float, Field(ge=1e-6, le=1000)] = 0.08
    """Speed along the path; a lap is rounded up to whole periods, and then repeats exactly."""
    hand: VirtualHand | None = VirtualHand()
    """Virtual hand on the handle; null keeps the tip on the path exactly."""
    tremor_m: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Greatest tremor along each axis, at 8 to 12 Hz as of a hand."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Seed of the tremor."""
    period_s: Annotated[float, Field(ge=1e-5, le=1)] = 0.001
    """Time between reads."""

    @model_validator(mode="after")
    def _agrees(self) -> Self:
        if (self.path == "csv") != (self.csv_file is not None):
            raise ValueError("path: csv and csv_file go together; give both or neither")
        if self.lift_m < self.z_m + 1e-6:
            raise ValueError(f"lift_m {self.lift_m:g} must be above z_m {self.z_m:g}")
        return self

    def spec(self) -> DeviceSpec:
        """Return the limits of a Novint Falcon."""
        return LIKE_A_FALCON

    def open(self) -> Link:
        """Open a new simulated device. Raises: DeviceError if the CSV file cannot be read or is invalid."""
        return SimulatedLink("mock", Motion(self, self._stroke()).step)

    def over(self, extent_m: tuple[float, float]) -> "Mock":
        """Return the device with its path within this width and length, unless it has a `size_m`."""
        return self if self.size_m else self.model_copy(update={"size_m": path_size(extent_m, MAX_M)})

    def wanted(self, ticks: Int64[np.ndarray, " n"]) -> Float64[np.ndarray, "n 3"]:
        """Return the path at these reads, with its tremor."""
        hand = Motion(self, self._stroke())
        return np.array([hand.target(tick) for tick in ticks.tolist()]).reshape(-1, 3)

    def _stroke(self) -> Stroke:
        if self.csv_file is not None:
            return read_csv(self.csv_file, self.period_s)
        points = DRAWN[self.path](self.size_m or MAX_M, self.lines, self.z_m, self.lift_m)
        return walk(points, self.speed_m_per_s, self.period_s)


@final
class Motion:
    """The motion of a hand along its path."""

    def __init__(self, options: Mock, stroke: Stroke) -> None:
        self._stroke = stroke
        self._tremor = Tremor(options.tremor_m, options.seed)
        self._period_s = options.period_s
        self._tick = -1
        x, y, z = self.target(0)
        self._hand = options.hand and MovingHand(options.hand, (x, y, max(z, options.lift_m)), options.period_s)

    def step(self, force: Force) -> HapticState:
        """Return the next state, a period later, under the force held until then; the first state is at time 0."""
        self._tick += 1
        position = self.target(self._tick)
        if self._hand is None:
            (x, y, z), (px, py, pz), period = position, self.target(self._tick - 1), self._period_s
            velocity = (x - px) / period, (y - py) / period, (z - pz) / period
            return HapticState(position, velocity, self._tick * period)
        if self._tick:
            self._hand.step(position, force)
        return HapticState(self._hand.position_m, self._hand.velocity_m_per_s, self._tick * self._period_s)

    def target(self, tick: int) -> Vector:
        """Return the target of the hand."""
        x, y, z = self._stroke.at(tick)
        dx, dy, dz = self._tremor.at(tick * self._period_s)
        return x + dx, y + dy, z + dz


@final
class Tremor:
    """Tremor as three sines an axis, 8 to 12 Hz, the band of physiological tremor; the sum is within the amplitude."""

    def __init__(self, amplitude_m: float, seed: int) -> None:
        numbers = np.random.default_rng(seed)
        rates = numbers.uniform(2 * math.pi * 8, 2 * math.pi * 12, (3, 3)).tolist()
        phases = numbers.uniform(0, 2 * math.pi, (3, 3)).tolist()
        self._waves = [list(zip(rate, phase, strict=True)) for rate, phase in zip(rates, phases, strict=True)]
        self._each_m = amplitude_m / 3

    def at(self, time_s: float) -> Vector:
        """Return the hand's deviation from its path."""
        if not self._each_m:
            return 0.0, 0.0, 0.0
        x, y, z = (self._each_m * sum(math.sin(rate * time_s + phase) for rate, phase in axis) for axis in self._waves)
        return x, y, z
