"""A device in simulated time whose tip goes where a recorded one went."""

from pathlib import Path
from typing import final

import numpy as np

from tangible_core.data import NO_FORCE, DeviceSpec, Force, HapticState
from tangible_core.errors import DeviceError, OutputError
from tangible_core.interfaces import HapticDevice, Link
from tangible_core.session import Recording, limited


class Replay(HapticDevice):
    """A recording's positions, velocities and buttons, a tick a read, whatever the force; then held at its end.

    Time is the recording's own, with its jitter. Ticks that are not finite are passed over. Not exclusive: every `open`
    starts at the first tick. Its limits are a Novint Falcon's.
    """

    file: Path | None = None
    """The recording, .nc, .npz or .csv; without one, a stroke of a second down to the base plane and up."""

    def spec(self) -> DeviceSpec:
        """A Novint Falcon's limits, as in CHAI3D's tables; positions are not rounded, which a picometre stands for."""
        return DeviceSpec(
            max_force_n=8.0,
            max_stiffness_n_per_m=3000.0,
            damping_n_s_per_m=20.0,
            workspace_m=(0.08, 0.08, 0.08),
            resolution_m=1e-12,
            buttons=4,
            simulated=True,
        )

    def open(self) -> Link:
        """From its start. Raises: DeviceError if the recording cannot be read, is empty, or its time stands still."""
        return ReplayLink(_stroke() if self.file is None else _load(self.file), self.spec().max_force_n)


@final
class ReplayLink(Link):
    """A recording in use."""

    def __init__(self, recording: Recording, max_force_n: float) -> None:
        self._rows = recording.rows
        self._period_s = float(np.median(np.diff(recording.time_s))) if len(recording.rows) > 1 else 0.001
        self._max_force_n = max_force_n
        self._tick = -1
        self._applied = NO_FORCE
        self._closed = False

    def read(self) -> HapticState:
        """The next state; after the last one the tip rests, and time goes on by the usual period."""
        self._check_open()
        self._tick += 1
        rests = max(0, self._tick - len(self._rows) + 1)
        time_s, _, x, y, z, vx, vy, vz, *_, buttons = self._rows[self._tick - rests].tolist()
        velocity = (0.0, 0.0, 0.0) if rests else (vx, vy, vz)
        return HapticState((x, y, z), velocity, time_s + rests * self._period_s, int(buttons))

    def write(self, force: Force) -> None:
        """Hold this force until the next write; zero if not finite, scaled down to the device's maximum."""
        self._check_open()
        self._applied = limited(force, self._max_force_n)

    @property
    def applied(self) -> Force:
        """The force on the hand now."""
        return self._applied

    def close(self) -> None:
        """Let go: no force, and no more reading or writing."""
        self._applied = NO_FORCE
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise DeviceError("the replay device is closed; open it again")


def _load(file: Path) -> Recording:
    try:
        rows = Recording.load(file).rows
    except OutputError as error:
        raise DeviceError(str(error)) from error
    rows = rows[np.isfinite(rows[:, [0, 2, 3, 4, 5, 6, 7, 15]]).all(axis=1)]
    if not len(rows):
        raise DeviceError(f"{file}: has no whole tick; record it again")
    stands = np.flatnonzero(np.diff(rows[:, 0]) <= 0)
    if stands.size:
        raise DeviceError(f"{file}: time stands still or goes back after {rows[stands[0], 0]} s; record it again")
    return Recording(rows)


def _stroke() -> Recording:
    """30 mm straight down at the centre, and up again, as smooth as a swing."""
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
