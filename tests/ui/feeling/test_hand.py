"""The page's hand and the device: otherwise a motor starts unasked, or two tabs move one hand."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from loop_devices import Failing
from sessions import Heard
from tangible_core import HapticSurface, load_method
from tangible_core.errors import ConfigError, DeviceError, TangibleError
from tangible_core.mapping import Placement, WorkspaceMapping
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.runtime.child_process import dumps
from tangible_core.servo import Safety, pack_touch
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.requests import REQUESTS
from tangible_ui.serving.serve import watch
from tangible_ui.state import session as session_module
from tangible_ui.state.session import Session
from tangible_web.hand import high_without_client
from waiting import happened

pytestmark = pytest.mark.anyio
LEVEL = HapticSurface.from_heights(np.full((32, 32), 0.002, np.float32))


class FakeWorker:
    """LongJobs a level surface at once, for whatever device the test says the document has."""

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
        touch = pack_touch(load_method("render", "proxy")(stiffness_n_per_m=500.0).touch(LEVEL), device.spec())
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
async def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Session]:
    """A session that is watched over."""
    monkeypatch.setattr(session_module, "Worker", FakeWorker)
    session = Session(tmp_path, Feeling("ui-test"), [])
    watching = asyncio.ensure_future(watch(session))
    yield session
    watching.cancel()
    await session.close()


@pytest.fixture
def page(session: Session) -> Heard:
    """The session's tab."""
    page = Heard()
    session.tabs.enter(page)
    return page


class TestWhoHolds:
    async def test_hand_belongs_to_the_first_tab_until_another_takes_it(self, session: Session, page: Heard) -> None:
        other = Heard()
        session.tabs.enter(other)
        assert (page.last("holding")["holding"], other.last("holding")["holding"]) == (True, False)
        session.feeling.hand.point((0.0, 0.0, 0.0), 1, 1)
        await REQUESTS["hold"](session, other)
        assert not session.feeling.hand.holding
        assert (page.last("holding")["holding"], other.last("holding")["holding"]) == (False, True)

    async def test_hand_of_a_closed_tab_belongs_to_nobody(self, session: Session, page: Heard) -> None:
        other = Heard()
        session.tabs.enter(other)
        session.feeling.hand.point((0.0, 0.0, 0.0), 1, 1)
        session.tabs.leave(page)
        assert not session.feeling.hand.holding
        assert session.tabs.holder is None
        assert other.last("holding") == {"event": "holding", "holding": False, "free": True}
        session.tabs.leave(other)
        session.tabs.enter(page)
        assert session.tabs.holder is page


@pytest.mark.usefixtures("loop_in_thread")
class TestDevices:
    async def test_motor_starts_only_after_consent(self, session: Session, page: Heard) -> None:
        FakeWorker.device = Failing(fault="none", simulated=False)
        with pytest.raises(ConfigError, match="has a motor"):
            await REQUESTS["choose_device"](session, page, kind="document")
        assert session.choice.kind == "hand"
        about = await REQUESTS["about_device"](session, page, kind="document")
        assert not about["simulated"]
        await REQUESTS["choose_device"](session, page, kind="document", sure=True)
        assert page.last("loop") | {"at_s": 0} == {
            "event": "loop", "at_s": 0, "running": True, "why": "", "device": "the other", "own_hand": False,
        }  # fmt: skip
        FakeWorker.device = Motor()  # the document was edited
        with pytest.raises(TangibleError, match="Motor has a motor"):
            await REQUESTS["make"](session, page)
        assert session.feeling.loop_input is not None
        assert isinstance(session.feeling.loop_input.unmapped_device, Failing)
        assert session.feeling.running

    async def test_unplugged_device_is_reported_and_can_be_waited_for(
        self, session: Session, page: Heard, tmp_path: Path
    ) -> None:
        FakeWorker.device = Failing(fault="unplugged", at=100)
        with suppress(DeviceError):  # where it is gone before the law is felt on it
            await REQUESTS["choose_device"](session, page, kind="document")
        await happened(lambda: not page.last("loop")["running"])
        assert page.last("loop")["why"] == "the failing device does not answer; plug it in"
        assert page.last("loop")["lost"]
        assert await REQUESTS["doctor"](session, page) is None
        FakeWorker.device = Failing(fault="none", opens="second", record=str(tmp_path / "held"))
        await REQUESTS["wait_for_device"](session, page)
        await happened(lambda: page.last("loop").get("waiting"))
        assert "in use by another program" in page.last("loop")["why"]
        await happened(lambda: page.last("loop")["running"])
        figures = await REQUESTS["doctor"](session, page)
        assert figures is not None
        assert figures["how"] == session.feeling.how

    async def test_waiting_for_a_device_ends_by_stop_or_another_choice(self, session: Session, page: Heard) -> None:
        FakeWorker.device = Failing(opens="never")
        for request, choice, runs in (("choose_device", {"kind": "hand"}, True), ("stop", {}, False)):
            with pytest.raises(DeviceError):
                await REQUESTS["choose_device"](session, page, kind="document")
            await REQUESTS["wait_for_device"](session, page)
            await happened(lambda: page.last("loop").get("waiting"))
            await REQUESTS[request](session, page, **choice)
            await happened(lambda: len(session._tasks) == 0)
            assert session.feeling.running == runs

    async def test_stop_lasts_until_the_request_feel(self, session: Session, page: Heard) -> None:
        await REQUESTS["make"](session, page)
        assert session.feeling.running
        await REQUESTS["stop"](session, page)
        assert page.last("loop")["stopped"]
        await REQUESTS["make"](session, page)  # an option was changed
        assert not session.feeling.running
        await REQUESTS["feel"](session, page)
        assert session.feeling.running
        assert page.last("loop")["running"]

    async def test_invalid_choice_of_a_device_is_refused(self, session: Session, page: Heard) -> None:
        for told in ({"kind": "hand", "name": "falcon"}, {"kind": "other"}, {"kind": "any"}):
            with pytest.raises(ConfigError, match="a device is chosen as one of"):
                await REQUESTS["choose_device"](session, page, **told)


class Motor(HapticDevice):
    """A device with a motor; never opened."""

    def spec(self):
        return Failing(simulated=False).spec()

    def open(self):
        raise DeviceError("it was opened")


def test_released_pointer_is_above_the_surface_unless_mapped_into_it() -> None:
    for scale, offset_z_m, high in (
        (1, 0, True), (0.1, 0, True), (2.0, 0, True), (2.01, 0, False), (50.0, 0, False),
        (1, 0.5, True), (1, 0.51, False), (0.5, 0.7, True), (0.5, 0.8, False),
    ):  # fmt: skip
        assert high_without_client(Placement(scale=scale, offset_z_m=offset_z_m)) == high
