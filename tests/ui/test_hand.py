"""Who holds the page's hand, which device is felt, and that no motor starts unasked: the desk, with a maker made up."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tangible_core import HapticSurface, load_method
from tangible_core.errors import ConfigError, DeviceError, TangibleError
from tangible_core.mapping import Placement, WorkspaceMapping
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.runtime.child_process import dumps
from tangible_core.servo import Safety, packed
from tangible_core.testing.loop_devices import Circling, Failing
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.feeling.hand import high_without_client
from tangible_ui.requests import REQUESTS
from tangible_ui.serving.serve import watch
from tangible_ui.state import session as desk_module
from tangible_ui.state.session import Desk
from waiting import LONGEST_S, happened

LEVEL = HapticSurface.from_heights(np.full((32, 32), 0.002, np.float32))


class Page:
    """A tab that remembers what it was told."""

    def __init__(self) -> None:
        self.told: list[dict[str, Any]] = []

    def say(self, event: dict[str, Any]) -> None:
        self.told.append(event)

    def last(self, event: str) -> dict[str, Any]:
        return next(each for each in reversed(self.told) if each["event"] == event)


class FakeMaker:
    """Makes a level surface at once, for whatever device the test says the document has."""

    device: HapticDevice | None = None

    def __init__(self, folder: Path, hear: Callable[..., None]) -> None:
        self.sets: list[str] = []

    async def ask(self, job: str, **told: Any) -> Any:
        self.sets = told.get("sets", [])
        own = next((each for each in self.sets if '"pointer"' in each), "")
        if own:
            device: HapticDevice = load_method("device", "pointer")(channel="ui-test", follow_s=0.012)
        else:
            assert self.device is not None
            device = self.device
        name = "pointer" if own else "the other"
        if job == "about_device":
            return {"name": name, "simulated": device.spec().simulated, "most_force_n": 8.0, "relief_m": 0.01}
        touch = packed(load_method("render", "proxy")(stiffness_n_per_m=500.0).touch(LEVEL), device.spec())
        return {
            "parcel": str(touch.parcel),
            "stiffness_n_per_m": touch.stiffness_n_per_m,
            "law": "proxy",
            "device_name": name,
            "device": dumps(device),
            "mapping": dumps(WorkspaceMapping()),
            "safety": dumps(Safety()),
        }

    def close(self) -> None:
        pass


@pytest.fixture
def at_desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """`at_desk(work)` does it with a desk that is watched over, and one page."""
    monkeypatch.setattr(desk_module, "Maker", FakeMaker)

    async def run(work: Callable[[Desk, Page], Awaitable[None]]) -> None:
        desk, page = Desk(tmp_path, Feeling("ui-test"), []), Page()
        watching = asyncio.ensure_future(watch(desk))
        desk.enter(page)
        try:
            await asyncio.wait_for(work(desk, page), 3 * LONGEST_S)
        finally:
            watching.cancel()
            await desk.close()

    return lambda work: asyncio.run(run(work))


class TestWhoHolds:
    def test_the_first_holds_and_who_comes_later_watches(self, at_desk) -> None:
        async def work(desk: Desk, page: Page) -> None:
            other = Page()
            desk.enter(other)
            assert (page.last("holding")["holding"], other.last("holding")["holding"]) == (True, False)
            await REQUESTS["hold"](desk, other)
            assert (page.last("holding")["holding"], other.last("holding")["holding"]) == (False, True)

        at_desk(work)

    def test_who_leaves_leaves_it_to_nobody_until_one_takes_it(self, at_desk) -> None:
        async def work(desk: Desk, page: Page) -> None:
            other = Page()
            desk.enter(other)
            desk.feeling.hand.point((0.0, 0.0, 0.0), 1, 1)
            desk.leave(page)
            assert not desk.feeling.hand.holding
            assert desk.holder is None
            assert other.last("holding") == {"event": "holding", "holding": False, "free": True}
            desk.leave(other)
            desk.enter(page)
            assert desk.holder is page

        at_desk(work)

    def test_who_takes_it_does_not_get_where_it_was(self, at_desk) -> None:
        async def work(desk: Desk, page: Page) -> None:
            desk.feeling.hand.point((0.0, 0.0, 0.0), 1, 1)
            desk.hold(Page())
            assert not desk.feeling.hand.holding

        at_desk(work)


class TestDevices:
    def test_a_motor_starts_only_for_who_said_yes(self, at_desk) -> None:
        async def work(desk: Desk, page: Page) -> None:
            FakeMaker.device = Failing(fault="none", simulated=False)
            with pytest.raises(ConfigError, match="has a motor"):
                await REQUESTS["choose_device"](desk, page, kind="document")
            assert desk.choice.kind == "hand"
            about = await REQUESTS["about_device"](desk, page, kind="document")
            assert not about["simulated"]
            await REQUESTS["choose_device"](desk, page, kind="document", sure=True)
            assert page.last("loop") | {"at_s": 0} == {
                "event": "loop", "at_s": 0, "running": True, "why": "", "device": "the other", "own_hand": False,
            }  # fmt: skip
            FakeMaker.device = Motor()  # the document was edited
            with pytest.raises(TangibleError, match="Motor has a motor"):
                await REQUESTS["make"](desk, page)
            assert desk.feeling.felt is not None
            assert isinstance(desk.feeling.felt.held, Failing)
            assert desk.feeling.running

        at_desk(work)

    def test_what_was_made_for_another_device_is_not_felt(self, at_desk) -> None:
        async def work(desk: Desk, page: Page) -> None:
            FakeMaker.device = Circling()
            made = await desk.maker.ask("make", sets=[])
            await desk.feel(made)
            assert not desk.feeling.running
            assert not Path(made["parcel"]).exists()

        at_desk(work)

    def test_a_device_that_is_pulled_out_is_told_of_and_waited_for(self, at_desk, tmp_path: Path) -> None:
        async def work(desk: Desk, page: Page) -> None:
            FakeMaker.device = Failing(fault="unplugged", at=100)
            with suppress(DeviceError):  # where it is gone before the law is felt on it
                await REQUESTS["choose_device"](desk, page, kind="document")
            await happened(lambda: not page.last("loop")["running"])
            assert page.last("loop")["why"] == "the failing device does not answer; plug it in"
            assert page.last("loop")["lost"]
            assert await REQUESTS["doctor"](desk, page) is None
            FakeMaker.device = Failing(fault="none", opens="second", record=str(tmp_path / "held"))
            await REQUESTS["wait_for_device"](desk, page)
            await happened(lambda: page.last("loop").get("waiting"))
            assert "in use by another program" in page.last("loop")["why"]
            await happened(lambda: page.last("loop")["running"])
            figures = await REQUESTS["doctor"](desk, page)
            assert figures is not None
            assert figures["how"] == desk.feeling.how

        at_desk(work)

    @pytest.mark.parametrize("ended_by", ["stop", "another choice"])
    def test_waiting_ends(self, at_desk, ended_by: str) -> None:
        async def work(desk: Desk, page: Page) -> None:
            FakeMaker.device = Failing(opens="never")
            with pytest.raises(DeviceError):
                await REQUESTS["choose_device"](desk, page, kind="document")
            await REQUESTS["wait_for_device"](desk, page)
            await happened(lambda: page.last("loop").get("waiting"))
            if ended_by == "stop":
                await REQUESTS["stop"](desk, page)
            else:
                await REQUESTS["choose_device"](desk, page, kind="hand")
            await happened(lambda: len(desk._tasks) == 0)
            assert desk.feeling.running == (ended_by != "stop")

        at_desk(work)

    def test_stop_holds_until_somebody_feels_again(self, at_desk) -> None:
        async def work(desk: Desk, page: Page) -> None:
            await REQUESTS["make"](desk, page)
            assert desk.feeling.running
            await REQUESTS["stop"](desk, page)
            assert page.last("loop")["stopped"]
            await REQUESTS["make"](desk, page)  # an option was changed
            assert not desk.feeling.running
            await REQUESTS["feel"](desk, page)
            assert desk.feeling.running
            assert page.last("loop")["running"]

        at_desk(work)

    @pytest.mark.parametrize("told", [{"kind": "hand", "name": "falcon"}, {"kind": "other"}, {"kind": "any"}])
    def test_no_choice(self, at_desk, told: dict[str, str]) -> None:
        async def work(desk: Desk, page: Page) -> None:
            with pytest.raises(ConfigError, match="a device is chosen as one of"):
                await REQUESTS["choose_device"](desk, page, **told)

        at_desk(work)


class Motor(HapticDevice):
    """One with a motor; never opened."""

    def spec(self):
        return Failing(simulated=False).spec()

    def open(self):
        raise DeviceError("it was opened")


@pytest.mark.parametrize(
    ("to", "high"),
    [
        (Placement(), True),
        (Placement(scale=50.0), False),
        (Placement(offset_z_m=0.9), False),
        (Placement(scale=0.1), True),
    ],
)
def test_whether_a_pointer_without_a_client_is_high(to: Placement, high: bool) -> None:
    assert high_without_client(to) == high
