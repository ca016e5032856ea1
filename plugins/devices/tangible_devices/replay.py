"""A device in simulated time whose tip repeats a recorded motion."""

from dataclasses import replace
from pathlib import Path
from typing import final

import numpy as np

from tangible_core.data import DeviceSpec, Force, HapticState
from tangible_core.errors import DeviceError, OutputError
from tangible_core.plugins import HapticDevice, Link
from tangible_core.session import Recording

from .simulated import LIKE_A_FALCON, SimulatedLink


class Replay(HapticDevice):
    """A recording's positions, velocities and buttons, a tick a read, whatever the force; then held at its end.

    Time is the recording's own, with its jitter. Ticks that are not finite are skipped. Not exclusive: every `open`
    starts at the first tick. Its limits are a Novint Falcon's.
    """

    file: Path | None = None
    """Recording to play: .nc, .npz or .csv; null: the hand moves down to the base plane and up within a second."""

    def spec(self) -> DeviceSpec:
        """Return the limits of a Novint Falcon."""
        return replace(LIKE_A_FALCON, buttons=4)

    def open(self) -> Link:
        """Start at the first tick. Raises: DeviceError if the file is unreadable or empty, or its time stands still."""
        return SimulatedLink("replay", Playback(_stroke() if self.file is None else _load(self.file)).step)


@final
class Playback:
    """The state of a recording that is being played."""

    def __init__(self, recording: Recording) -> None:
        self._rows = recording.rows
        self._period_s = float(np.median(np.diff(recording.time_s))) if len(recording.rows) > 1 else 0.001
        self._tick = -1

    def step(self, force: Force) -> HapticState:
        """Return the next state, whatever the force; after the last one the tip rests, and time advances regularly."""
        self._tick += 1
        rests = max(0, self._tick - len(self._rows) + 1)
        time_s, _, x, y, z, vx, vy, vz, *_, buttons, _ = self._rows[self._tick - rests].tolist()
        velocity = (0.0, 0.0, 0.0) if rests else (vx, vy, vz)
        return HapticState((x, y, z), velocity, time_s + rests * self._period_s, int(buttons))


def _load(file: Path) -> Recording:
    try:
        rows = Recording.load(file).rows
    except OutputError as error:
        raise DeviceError(str(error)) from error
    rows = rows[np.isfinite(rows[:, [0, 2, 3, 4, 5, 6, 7, 15]]).all(axis=1)]
    if not len(rows):
        raise DeviceError(f"{file}: has no complete tick; record it again")
    stands = np.flatnonzero(np.diff(rows[:, 0]) <= 0)
    if stands.size:
        raise DeviceError(f"{file}: time does not increase after {rows[stands[0], 0]} s; record it again")
    return Recording(rows)


def _stroke() -> Recording:
    """Return a sinusoidal motion at the centre, 30 mm straight down and up again."""
    time_s = np.arange(1001) * 0.001
    turn = 2 * np.pi * time_s
    z_m, vz = 0.015 * (1 + np.cos(turn)), -0.03 * np.pi * np.sin(turn)
    still = np.zeros_like(turn)
    return Recording.of(
        time_s=time_s,
        position_m=np.column_stack([still, still, z_m]),
        velocity_m_per_s=np.column_stack([still, still, vz]),
        force_n=np.zeros((1001, 3)),
    )
