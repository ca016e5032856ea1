"""A recording would be played differently from how it was felt, or a broken one would be played at all."""

from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import Force, HapticSurface
from tangible_core.errors import DeviceError
from tangible_core.session import Recording, run_simulated
from tangible_devices.mock import Mock
from tangible_devices.replay import Replay
from tangible_render.penalty_gradient import PenaltyGradient


def save_recording(folder: Path, rows: np.ndarray, suffix: str = ".npz") -> Path:
    path = folder / f"hand{suffix}"
    Recording(rows).save(path)
    return path


def rows(count: int) -> np.ndarray:
    """Jittered times, and positions, velocities and buttons that float32 holds."""
    table = np.random.default_rng(0).integers(-40, 40, (count, 17)) / 1024
    table[:, 0] = 7 + np.cumsum(np.random.default_rng(1).uniform(0.0005, 0.002, count))
    table[:, 15] = np.arange(count) % 16
    return table


@pytest.mark.parametrize("column", [0, 2, 3, 4, 5, 6, 7])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_replay_tick_with_nonfinite_column_is_skipped(tmp_path: Path, column: int, bad: float):
    table = rows(3)
    table[1, column] = bad
    with Replay(file=save_recording(tmp_path, table)).open() as link:
        assert [link.read().time_s for _ in range(2)] == table[[0, 2], 0].tolist()


@pytest.mark.parametrize("suffix", [".nc", ".npz", ".csv"])
def test_replay_read_is_a_recorded_tick(tmp_path: Path, suffix: str):
    table = rows(30)
    with Replay(file=save_recording(tmp_path, table, suffix)).open() as link:
        for row in table:
            link.write(Force(0.0, 0.0, 5.0))  # which moves nothing
            state = link.read()
            assert (state.time_s, *state.position_m, *state.velocity_m_per_s, state.buttons) == (
                *row[[0, 2, 3, 4, 5, 6, 7]],
                row[15],
            )


def test_replay_at_end_rests_while_time_advances(tmp_path: Path):
    table = rows(3)
    table[:, 0] = 5, 5.002, 5.004
    with Replay(file=save_recording(tmp_path, table)).open() as link:
        states = [link.read() for _ in range(5)]
    assert [state.time_s for state in states] == pytest.approx([5, 5.002, 5.004, 5.006, 5.008], abs=1e-12)
    assert {state.position_m for state in states[2:]} == {tuple(table[2, 2:5])}
    assert [state.velocity_m_per_s for state in states[3:]] == [(0, 0, 0)] * 2
    with Replay().open() as link:
        z_m = np.array([link.read().position_m[2] for _ in range(1001)])
    assert (z_m[0], z_m[500], z_m[-1]) == pytest.approx((0.03, 0.0, 0.03), abs=1e-15)
    assert (np.diff(z_m[:501]) < 0).all()
    assert (np.diff(z_m[500:]) > 0).all()


def test_replay_of_a_session_gives_the_same_forces(tmp_path: Path):
    touch = PenaltyGradient().touch(HapticSurface.from_heights(np.random.default_rng(0).uniform(0, 0.004, (9, 9))))
    first = run_simulated(touch, Mock(speed_m_per_s=0.2), 0.5)
    first.save(tmp_path / "hand.npz")
    again = run_simulated(touch, Replay(file=tmp_path / "hand.npz"), 0.5)
    assert np.array_equal(again.rows, first.rows, equal_nan=True)


@pytest.mark.parametrize(
    "change",
    [
        lambda table: table[:0],
        lambda table: np.where(np.arange(17) < 14, np.nan, table),
        lambda table: table[::-1],
        lambda table: table[[0, 1, 1]],
    ],
)
def test_replay_of_invalid_recording_is_refused(tmp_path: Path, change):
    with np.errstate(invalid="ignore"):
        path = save_recording(tmp_path, change(rows(5)))
    with pytest.raises(DeviceError, match="hand"):
        Replay(file=path).open()


def test_replay_of_unreadable_file_is_refused(tmp_path: Path):
    (tmp_path / "text.nc").write_text("no recording")
    for name in ("none.nc", "text.nc"):
        with pytest.raises(DeviceError, match=name):
            Replay(file=tmp_path / name).open()
