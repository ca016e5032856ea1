"""The three kinds of loop on a simulated clock: a late tick must neither be made up for nor leave an old force."""

import ctypes
from collections.abc import Iterator

import numpy as np
import pytest
from numba import float64, int32, int64, njit, types, uintp, void

from loop_devices import SPEC
from tangible_core import HapticSurface, load_method
from tangible_core.compiled.touch import CompiledLink, LinkKernels
from tangible_core.data import TICK_COLUMNS, Force, HapticState, TickFlag
from tangible_core.mapping.device import MappedLink, Placement
from tangible_core.plugins.interfaces import Touch
from tangible_core.servo import Ring, Safety
from tangible_core.servo.reports import report
from tangible_core.servo.ring import LAST, LEAD_NS, PERIOD_NS
from tangible_core.servo.ticks import clock, loop

PERIOD = 1_000_000
SECOND = 1_000_000_000
START = 7 * SECOND + 3
AT_ONCE = Safety(ramp_s=0, max_step_n=10)
HEIGHT_M = 2**-9  # exact in float32
LEVEL = HapticSurface.from_heights(np.full((16, 16), HEIGHT_M, np.float32))
FLAGS, FORCE = TICK_COLUMNS.index("flags"), slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)
LOOPS = pytest.mark.parametrize("how", ["whole", "exchanges", "python"])
KERNEL = (int64[::1], float64[::1])


@njit(int64(*KERNEL, float64[::1]), nogil=True)
def read(counts, force_n, state):
    """A tip that sinks by 10 um a read, to and fro along x; none is fresh from one read to another."""
    counts[0] += 1
    at = counts[0]
    if counts[1] <= at < counts[2]:
        return 0
    state[0], state[1], state[2] = 1e-4 * (at % 7), 0.001, HEIGHT_M - 1e-5 * at
    state[3], state[4], state[5], state[6] = 0.01 * (at % 5), 0.0, -0.01, at % 3
    return 1


@njit(void(*KERNEL, float64, float64, float64), nogil=True)
def write(counts, force_n, fx, fy, fz):
    force_n[0], force_n[1], force_n[2] = fx, fy, fz


class Sinking(CompiledLink):
    """A device of kernels, which exchanges or not."""

    def __init__(self, exchanges: bool, first_waiting: int = 0, fresh_again: int = 0) -> None:
        super().__init__("the sinking device", 8.0)
        self.fixed = np.array([0, first_waiting, fresh_again]), np.zeros(3)
        self._exchanges, self._newest_s = exchanges, 0.0

    def kernels(self) -> LinkKernels:
        return LinkKernels(read, write, self.fixed)

    def _read(self) -> HapticState:
        state = np.zeros(7)
        if read(*self.fixed, state):
            self._newest_s = float(self.fixed[0][0])
        x, y, z, vx, vy, vz, buttons = state.tolist()
        return HapticState((x, y, z), (vx, vy, vz), self._newest_s, int(buttons))

    def _send(self, force: Force) -> None:
        write(*self.fixed, *force)

    @property
    def applied(self) -> Force:
        return Force(*self.fixed[1].tolist())

    @property
    def exchanges(self) -> bool:
        return self._exchanges

    def _exchange(self) -> None:
        pass

    def _release(self) -> None:
        pass


class Clock:
    """A simulated clock that advances with each read and sleep, some sleeps being longer or shorter than requested."""

    def __init__(self) -> None:
        self.now, self.reads, self.read_ns = START, 0, 0
        self.wakes: list[int] = []
        """When each sleep was to end."""
        self.over: dict[int, int] = {}
        """By how much longer each of some sleeps takes, nanoseconds."""

    def read_now_ns(self) -> int:
        self.reads += 1
        self.now += self.read_ns
        return self.now

    def until(self, wake_ns: int) -> None:
        self.now = wake_ns + self.over.get(len(self.wakes), 0)
        self.wakes.append(wake_ns)

    def sleep(self, seconds: float) -> None:
        self.until(self.now + round(seconds * SECOND))


class Foreign(types.WrapperAddressProtocol):
    """A Python function where compiled code calls one of the C library."""

    def __init__(self, function, signature) -> None:
        self.kept = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_size_t] * len(signature.args))(function)
        self._signature = signature

    def signature(self):
        return self._signature

    def __wrapper_address__(self):
        return ctypes.cast(self.kept, ctypes.c_void_p).value


@pytest.fixture
def simulated_clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """Put a simulated clock into the loops in Python and the compiled ones."""
    time, words = Clock(), np.zeros(2, np.int64)

    def tell(which: int, place: int) -> int:
        words[:] = divmod(time.read_now_ns(), SECOND)
        return 0

    def sleep(which: int, flags: int, place: int, rest: int) -> int:
        time.until(int(words[0]) * SECOND + int(words[1]))
        return 0

    foreign = Foreign(tell, int32(int32, uintp)), Foreign(sleep, int32(int32, int32, uintp, uintp))
    monkeypatch.setattr(loop, "time", time)
    monkeypatch.setattr(loop, "now_ns", time.read_now_ns)
    monkeypatch.setattr(clock, "clock", lambda: (words, *foreign))
    monkeypatch.setattr(clock, "SLEEPS", True)
    return time


@pytest.fixture
def ring() -> Iterator[Ring]:
    made = Ring.create(128)
    yield made
    made.remove()


def run_loop(
    ring: Ring, how: str, ticks: int, safety: Safety = AT_ONCE, link: Sinking | None = None, real_time: bool = False
) -> np.ndarray:
    """Return the rows of a number of ticks of one kind of loop."""
    law: Touch = load_method("render", "penalty")(stiffness_n_per_m=400.0).touch(LEVEL)
    settings, memory = safety.arrays(SPEC, 400.0)
    ring.guard[: memory.size] = memory
    ring.header[[PERIOD_NS, LAST]] = PERIOD, ticks
    tip = link or Sinking(how == "exchanges")
    ready = loop.prepare(MappedLink(tip, Placement()) if how == "python" else tip, law, ring, settings)
    loop.start_clock(ring.header, real_time)
    ready.run()
    rows, count = ring.since(0)
    assert (len(rows), count) == (ticks, ticks)
    return rows


@LOOPS
def test_late_tick_is_an_overrun_and_missed_ticks_are_skipped(how: str, simulated_clock: Clock, ring: Ring):
    """The sixth tick is 3.5 periods late: three were missed, and the next one is half a period later, in step."""
    simulated_clock.over[5] = 7 * PERIOD // 2
    rows = run_loop(ring, how, 12)
    due = [0, 1, 2, 3, 4, 8.5, 9, 10, 11, 12, 13, 14]
    np.testing.assert_allclose(rows[:, 0], np.multiply(due, 1e-3), atol=1e-12)
    np.testing.assert_allclose(rows[:, 1], [0] * 5 + [0.0035] + [0] * 6, atol=1e-12)
    overrun = rows[:, FLAGS].astype(int) & TickFlag.OVERRUN
    assert np.flatnonzero(overrun).tolist() == [5]
    said = report(ring)
    assert said.overruns == 3
    assert said.late_us is not None and said.late_us.most == pytest.approx(3500)
    assert said.period_us is not None and said.period_us.most == pytest.approx(4500)


@LOOPS
@pytest.mark.parametrize(("late_ns", "overrun"), [(PERIOD - 1, False), (PERIOD, True)])
def test_tick_one_period_late_is_an_overrun(how: str, late_ns: int, overrun: bool, simulated_clock: Clock, ring: Ring):
    simulated_clock.over[3] = late_ns
    rows = run_loop(ring, how, 6)
    assert bool(int(rows[3, FLAGS]) & TickFlag.OVERRUN) == overrun
    assert report(ring).overruns == overrun


@LOOPS
def test_position_that_is_too_late_gives_no_force(how: str, simulated_clock: Clock, ring: Ring):
    """30 ms pass between two ticks, and 20 are allowed: the force is zero, then fades in again."""
    simulated_clock.over[20] = 30 * PERIOD
    rows = run_loop(ring, how, 40, Safety(ramp_s=0.004, max_step_n=10))
    flags = rows[:, FLAGS].astype(int)
    assert np.flatnonzero(flags & TickFlag.STALE).tolist() == [20]
    assert not rows[20, FORCE].any()
    assert np.flatnonzero(flags & TickFlag.RAMPING).tolist() == [0, 1, 2, 21, 22, 23]
    assert rows[19, FORCE].any() and rows[21, FORCE].any()


@pytest.mark.parametrize("how", ["exchanges", "python"])
@pytest.mark.parametrize("safety", [Safety(), Safety(ramp_s=0, coupling="auto", passivity="strict", delay_ticks=2)])
def test_each_kind_of_loop_has_the_same_ticks(how: str, safety: Safety, simulated_clock: Clock, ring: Ring):
    simulated_clock.over = {7: 300_000, 13: 3 * PERIOD, 30: 25 * PERIOD}
    whole = run_loop(ring, "whole", 100, safety)
    simulated_clock.now, simulated_clock.wakes = START, []
    other = Ring.create(128)
    try:
        np.testing.assert_allclose(run_loop(other, how, 100, safety), whole, rtol=1e-12, atol=1e-12)
    finally:
        other.remove()
    assert whole[-1, FORCE].any()


@pytest.mark.parametrize("how", ["whole", "exchanges"])
def test_force_without_fresh_position_is_held_until_stale(how: str, simulated_clock: Clock, ring: Ring):
    """The tip of the ninth read is the last for 30 ms: its force stays for 20, and then is none."""
    tip = Sinking(how == "exchanges", 10, 40)
    rows = run_loop(ring, how, 50, Safety(ramp_s=0, max_step_n=10, stale_s=0.0205), tip)
    flags = rows[:, FLAGS].astype(int)
    assert (rows[9:29, FORCE] == rows[8, FORCE]).all() and rows[8, FORCE].any()
    assert not (flags[9:29] & TickFlag.STALE).any()
    assert not rows[29:40, FORCE].any()
    assert (flags[29:40] & TickFlag.STALE).all()
    assert rows[40, FORCE].any() and tip.applied == tuple(rows[-1, FORCE])


@LOOPS
def test_loop_that_may_spin_wakes_early_and_spins(how: str, simulated_clock: Clock, ring: Ring):
    simulated_clock.read_ns = 500
    ring.header[LEAD_NS] = 50_000
    rows = run_loop(ring, how, 5, real_time=True)
    first = min(simulated_clock.wakes)
    assert first == pytest.approx(START + PERIOD - 50_000, abs=2_000)
    assert simulated_clock.reads > 5 * 50, "it reads the clock until the time has come"
    assert ((rows[:, 1] >= 0) & (rows[:, 1] <= 1e-6)).all()


def test_sleep_ended_by_a_signal_is_resumed(simulated_clock: Clock, ring: Ring):
    simulated_clock.read_ns, simulated_clock.over = 1, {2: -600_000}
    rows = run_loop(ring, "whole", 5)
    assert len(simulated_clock.wakes) == 6
    assert simulated_clock.wakes[2] == simulated_clock.wakes[3]
    assert simulated_clock.reads < 100
    np.testing.assert_allclose(rows[:, 0], np.arange(5) * 1e-3, atol=1e-6)
