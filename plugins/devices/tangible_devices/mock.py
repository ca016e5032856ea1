"""A device in simulated time: a scripted hand on a simulated handle, for demos, tests and comparisons."""

import math
from pathlib import Path
from typing import Annotated, Literal, Self, final

import numpy as np
from pydantic import Field, model_validator

from tangible_core.data import DeviceSpec, Force, HapticState, Vector
from tangible_core.plugins.interfaces import HapticDevice, Link

from .hand import MovingHand, VirtualHand
from .paths import DRAWN, Stroke, read_csv, walk
from .simulated import LIKE_A_FALCON, SimulatedLink

Height = Annotated[float, Field(ge=-1, le=1)]
Size = Annotated[float, Field(ge=1e-6, le=1)]


class Mock(HapticDevice):
    """A hand that follows a path, in simulated time: every read is one period later.

    With a virtual hand (the default) the path is where the hand wants to be: below the surface, so that it leans on
    whatever is there and the force pushes it back. Without one (`hand: null`) the tip is on the path exactly, whatever
    the force. Not exclusive: every `open` is a device of its own, at the start of its path. Its limits are a Novint
    Falcon's.
    """

    path: Literal["raster", "circle", "spiral", "press", "csv"] = "raster"
    """Way of the hand: over the surface, straight down and up, or as recorded in csv_file."""
    csv_file: Path | None = None
    """Recorded path: columns time_s, x_m, y_m, z_m; played once, straight between rows, then held at its end."""
    size_m: tuple[Size, Size] = (0.06, 0.04)
    """Width and length of raster, circle and spiral, centred."""
    lines: Annotated[int, Field(ge=2, le=200)] = 8
    """Lines of the raster, turns of the spiral."""
    z_m: Height = -0.005
    """Height of the path over the base plane; below it, a hand presses everywhere. The lowest point of a press."""
    lift_m: Height = 0.03
    """Where a press comes from, and how high a virtual hand starts."""
    speed_m_per_s: Annotated[float, Field(ge=1e-6, le=1000)] = 0.08
    """Along the path; a lap is rounded up to whole periods, and then repeats exactly."""
    hand: VirtualHand | None = VirtualHand()
    """The hand on the handle; null puts the tip on the path exactly."""
    tremor_m: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Most that the path trembles along each axis, at 8 to 12 Hz as a hand does."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Of the tremor."""
    period_s: Annotated[float, Field(ge=1e-5, le=1)] = 0.001
    """Time from one read to the next."""

    @model_validator(mode="after")
    def _agrees(self) -> Self:
        if (self.path == "csv") != (self.csv_file is not None):
            raise ValueError("path: csv and csv_file go together; give both or neither")
        if self.lift_m < self.z_m + 1e-6:
            raise ValueError(f"lift_m {self.lift_m:g} must be above z_m {self.z_m:g}")
        return self

    def spec(self) -> DeviceSpec:
        """A Novint Falcon's limits, as in CHAI3D's tables; positions are not rounded, which a picometre stands for."""
        return LIKE_A_FALCON

    def open(self) -> Link:
        """A new simulated device. Raises: DeviceError if the CSV file cannot be read or makes no sense."""
        return SimulatedLink("mock", Motion(self, self._stroke()).step)

    def _stroke(self) -> Stroke:
        if self.csv_file is not None:
            return read_csv(self.csv_file, self.period_s)
        points = DRAWN[self.path](self.size_m, self.lines, self.z_m, self.lift_m)
        return walk(points, self.speed_m_per_s, self.period_s)


@final
class Motion:
    """A hand on its way."""

    def __init__(self, options: Mock, stroke: Stroke) -> None:
        self._stroke = stroke
        self._tremor = Tremor(options.tremor_m, options.seed)
        self._period_s = options.period_s
        self._tick = -1
        x, y, z = self._target(0)
        self._hand = options.hand and MovingHand(options.hand, (x, y, max(z, options.lift_m)), options.period_s)

    def step(self, held: Force) -> HapticState:
        """The first state is at time 0; each further one is a period later, under the force held until then."""
        self._tick += 1
        position = self._target(self._tick)
        if self._hand is None:
            (x, y, z), (px, py, pz), period = position, self._target(self._tick - 1), self._period_s
            velocity = (x - px) / period, (y - py) / period, (z - pz) / period
            return HapticState(position, velocity, self._tick * period)
        if self._tick:
            self._hand.step(position, held)
        return HapticState(self._hand.position_m, self._hand.velocity_m_per_s, self._tick * self._period_s)

    def _target(self, tick: int) -> Vector:
        x, y, z = self._stroke.at(tick)
        dx, dy, dz = self._tremor.at(tick * self._period_s)
        return x + dx, y + dy, z + dz


@final
class Tremor:
    """Three sines an axis, 8 to 12 Hz, the band of physiological tremor; together never over the amplitude."""

    def __init__(self, amplitude_m: float, seed: int) -> None:
        numbers = np.random.default_rng(seed)
        rates = numbers.uniform(2 * math.pi * 8, 2 * math.pi * 12, (3, 3)).tolist()
        phases = numbers.uniform(0, 2 * math.pi, (3, 3)).tolist()
        self._waves = [list(zip(rate, phase, strict=True)) for rate, phase in zip(rates, phases, strict=True)]
        self._each_m = amplitude_m / 3

    def at(self, time_s: float) -> Vector:
        """How far the hand is off its path."""
        if not self._each_m:
            return 0.0, 0.0, 0.0
        x, y, z = (self._each_m * sum(math.sin(rate * time_s + phase) for rate, phase in axis) for axis in self._waves)
        return x, y, z
