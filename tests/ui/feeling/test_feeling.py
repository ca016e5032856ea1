"""The force loop of the page's server: otherwise a stop leaves a force, or a loop ends and nobody is told."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from loop_devices import Failing
from tangible_core import HapticSurface, load_method
from tangible_core.data import TICK_COLUMNS, Vector
from tangible_core.errors import DeviceError
from tangible_core.mapping import WorkspaceMapping, map_device
from tangible_core.plugins.interfaces import HapticDevice, Touch
from tangible_core.servo import Safety, pack_touch
from tangible_core.servo.ring import STOP, shared_folder
from tangible_ui.feeling.feeling import Feeling, LoopInput
from tangible_web.framing import STATE_FRAME
from waiting import LONGEST_S, until

pytestmark = pytest.mark.usefixtures("own_memory")

LEVEL_M = 0.002
LEVEL = HapticSurface.from_heights(np.full((32, 32), LEVEL_M, np.float32))
AT_ONCE = Safety(ramp_s=0, max_step_n=10, passivity="off")
PLACE = slice(TICK_COLUMNS.index("x_m"), TICK_COLUMNS.index("x_m") + 3)
FORCE = slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)
INSIDE: Vector = (0.0, 0.0, 0.0)
NO_MAPPING = WorkspaceMapping()


def law(k: float = 500.0) -> Touch:
    return load_method("render", "proxy")(stiffness_n_per_m=k).touch(LEVEL)


def loop_input(
    feeling: Feeling,
    device: HapticDevice | None = None,
    touch: Touch | None = None,
    mapping: WorkspaceMapping = NO_MAPPING,
) -> LoopInput:
    """A scene for a device, the page's own without one."""
    options = {name: value for name, value in feeling.own_device.items() if name != "use"}
    seen = map_device(device or load_method("device", "pointer")(**options), mapping)
    return LoopInput(pack_touch(touch or law(), seen.spec()), "proxy", "it", seen, device is None, mapping, AT_ONCE)


def newest(feeling: Feeling) -> np.ndarray:
    """The newest whole tick."""
    assert feeling.servo is not None
    until(lambda: feeling.servo and feeling.servo.ring.count)
    return feeling.servo.ring.since(feeling.servo.ring.count - 1)[0][-1]


def state(feeling: Feeling) -> tuple[float, ...]:
    frame = feeling.frame(1, 0)
    assert frame is not None
    return STATE_FRAME.unpack(frame)


class Server:
    """A stand-in for the page's server: it moves the page's hand, and tells the loop that it lives."""

    def __init__(self, feeling: Feeling) -> None:
        self.at: Vector | None = None
        self.stands_still = False
        self._feeling, self._over = feeling, threading.Event()
        self._thread = threading.Thread(target=self._work)

    def _work(self) -> None:
        while not self._over.wait(0.01):
            if self.stands_still:
                continue
            if self.at is not None:
                self._feeling.hand.point(self.at, 1, 7)
            self._feeling.hand.keep()

    def __enter__(self) -> "Server":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()


@pytest.fixture
def feeling() -> Iterator[Feeling]:
    """A force loop that leaves no process and no file."""
    feeling = Feeling("ui-test")
    yield feeling
    feeling.stop()
    assert not feeling.running
    assert not list(shared_folder().glob("*.ring"))
    assert not list(shared_folder().glob("*.parcel"))


@pytest.fixture
def server(feeling: Feeling) -> Iterator[Server]:
    """Moves its hand."""
    with Server(feeling) as server:
        yield server


@pytest.mark.usefixtures("loop_in_thread")
class TestTheHandIsWhereThePageSays:
    @pytest.mark.parametrize(
        "mapping",
        [
            NO_MAPPING,
            WorkspaceMapping(region_m=(0.01, -0.005, 0.02, 0.01), rotation_deg=30.0, offset_m=(0.01, 0.02, 0.03)),
            WorkspaceMapping(scale=500.0),
        ],
        ids=["plain", "a region, turned", "much enlarged"],
    )
    def test_hand_is_where_the_page_points_under_any_mapping(
        self, feeling: Feeling, server: Server, mapping: WorkspaceMapping
    ) -> None:
        """A released hand is over every surface: a metre up in the pointer's own frame may be inside one."""
        assert feeling.feel(loop_input(feeling, mapping=mapping)) is not None
        until(lambda: newest(feeling)[PLACE][2] > 0.4)
        server.at = at = (0.012, -0.004, LEVEL_M - 0.001)
        until(lambda: np.allclose(newest(feeling)[PLACE], at, atol=2e-5))
        until(lambda: newest(feeling)[FORCE][2] > 0.49)
        np.testing.assert_allclose(newest(feeling)[FORCE], (0, 0, 0.5), atol=0.02)
        assert state(feeling)[4] == 7  # the tag of what was said
        server.at = None
        feeling.hand.release()
        until(lambda: newest(feeling)[PLACE][2] > 0.4)
        assert not newest(feeling)[FORCE].any()

    def test_hand_is_released_by_silence_of_page_or_server(self, feeling: Feeling, server: Server) -> None:
        """Silence of the page releases the hand, and silence of the server, which the loop itself watches."""
        feeling.feel(loop_input(feeling))
        server.at = INSIDE
        until(lambda: newest(feeling)[FORCE][2] > 0.5)
        server.at = None
        until(lambda: not feeling.hand.holding)
        until(lambda: newest(feeling)[PLACE][2] > 0.4)
        assert not newest(feeling)[FORCE].any()
        server.at = INSIDE
        until(lambda: newest(feeling)[FORCE][2] > 0.5)
        server.stands_still = True
        until(lambda: not newest(feeling)[FORCE].any())


@pytest.mark.usefixtures("loop_in_thread")
class TestSwaps:
    def test_swap_of_the_law_keeps_the_loop(self, feeling: Feeling) -> None:
        feeling.start()
        first = feeling.servo
        feeling.feel(loop_input(feeling, touch=FaultyTouch()))
        assert feeling.servo is first
        assert "the tick is in Python" in feeling.how
        feeling.feel(loop_input(feeling))
        assert feeling.servo is first
        assert "the tick is in Python" not in feeling.how

    def test_swap_of_the_device_starts_another_loop(self, feeling: Feeling, server: Server) -> None:
        feeling.start()
        first = feeling.servo
        feeling.feel(loop_input(feeling, Failing(fault="none")))
        assert feeling.servo is not first
        until(lambda: state(feeling)[15] > 0.4)
        server.at = INSIDE  # of no use now
        time.sleep(0.05)
        server.at = None
        feeling.feel(loop_input(feeling))
        until(lambda: newest(feeling)[PLACE][2] > 0.4)
        assert feeling.loop_end() is None

    def test_swap_to_a_missing_device_raises_and_can_be_repeated(self, feeling: Feeling, tmp_path: Path) -> None:
        device = Failing(fault="none", opens="second", record=str(tmp_path / "held"))
        with pytest.raises(DeviceError, match="in use by another program"):
            feeling.feel(loop_input(feeling, device))
        assert not feeling.running
        assert state(feeling)[9] == 1.0  # the hand is nowhere
        assert feeling.feel(loop_input(feeling, device)) is not None
        assert feeling.running


class TestWhatEndsByItself:
    @pytest.mark.parametrize(
        ("device", "touch", "why", "lost"),
        [
            (Failing(fault="unplugged", at=1500), None, "the failing device does not answer; plug it in", True),
            pytest.param(Failing(fault="blocks", at=1500), None, "stood still", True, marks=pytest.mark.whole),
            pytest.param(Failing(fault="bug", at=1500), None, "the driver's own fault", False, marks=pytest.mark.whole),
            pytest.param(Failing(fault="none"), FaultyTouch("odd error"), "OddError", False, marks=pytest.mark.whole),
        ],
        ids=["unplugged", "stands still", "a fault of the driver", "a law that raises"],
    )
    def test_loop_that_ends_by_itself_is_reported_once_with_the_reason(
        self, feeling: Feeling, device: HapticDevice, touch: Touch | None, why: str, lost: bool
    ) -> None:
        feeling.feel(loop_input(feeling))  # so that all is compiled
        with suppress(DeviceError):  # the device may be gone before the scene is swapped
            feeling.feel(loop_input(feeling, device, touch))
        found = []
        until(lambda: found.append(feeling.loop_end()) or found[-1] is not None)
        assert why in found[-1].why
        assert found[-1].why
        assert found[-1].is_lost == lost
        assert feeling.loop_end() is None
        assert state(feeling)[13:16] == (0, 0, 0)
        assert feeling.feel(loop_input(feeling)) is not None
        assert feeling.running


class TestStop:
    def stops(self, feeling: Feeling, doing: Callable[[], Any]) -> list[Any]:
        """Press stop while something is done; what that gave."""
        gave: list[Any] = []

        def work() -> None:
            try:
                gave.append(doing())
            except Exception as error:  # noqa: BLE001 - it is looked at
                gave.append(error)

        thread = threading.Thread(target=work)
        thread.start()
        time.sleep(0.05)
        feeling.cut()
        feeling.stop()
        thread.join(LONGEST_S)
        assert not thread.is_alive()
        assert not feeling.running
        return gave

    @pytest.mark.usefixtures("loop_in_thread")
    def test_stop_of_a_running_loop_leaves_no_force_until_allowed(self, feeling: Feeling, server: Server) -> None:
        feeling.feel(loop_input(feeling))
        servo = feeling.servo
        assert servo is not None
        server.at = INSIDE
        until(lambda: newest(feeling)[FORCE][2] > 0.5)
        feeling.cut()
        assert (servo.ring.header[STOP], state(feeling)[13:16]) == (1, (0, 0, 0))
        until(lambda: not servo.running)
        assert feeling.loop_end() is None
        assert feeling.feel(loop_input(feeling)) is None  # what is made later is not felt
        assert not feeling.running
        feeling.allow()
        assert feeling.feel(loop_input(feeling)) is not None

    @pytest.mark.usefixtures("loop_in_thread")
    def test_stop_followed_by_a_new_loop_leaves_that_loop(self, feeling: Feeling) -> None:
        """The loop that was stopped is still there, and who waits for its end does not end the next one."""
        feeling.start()
        ended = feeling.cut()
        feeling.allow()
        assert feeling.feel(loop_input(feeling)) is not None
        ended()
        assert feeling.running
        assert feeling.loop_end() is None

    def test_stop_while_a_loop_starts_or_a_device_is_homed_ends_it(self, feeling: Feeling) -> None:
        assert self.stops(feeling, feeling.start) == [None]
        assert self.stops(feeling, lambda: feeling.feel(loop_input(feeling, Failing(opens="late")))) == [None]
