"""A beacon on the page: otherwise a hand is pulled elsewhere, or is not let go by a button."""

import asyncio
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sessions import TEXT, SmallSession
from tangible_core import load_method
from tangible_core.data import HapticSurface, Relief, TickFlag
from tangible_core.errors import ConfigError, DeviceError
from tangible_core.mapping import WorkspaceMapping
from tangible_core.servo import Beacon, Safety, beacon_to, pack_touch
from tangible_core.servo.ring import shared_folder
from tangible_ui.feeling.feeling import Feeling, LoopInput
from tangible_ui.requests.document import take
from tangible_ui.serving.serve import watch
from tangible_ui.state.document import Text
from tangible_web.framing import STATE_FRAME
from waiting import happened, until

pytestmark = pytest.mark.anyio
IN_PARTS = TEXT.replace("want: touch", "want: touch\nparts: {1: {name: wall}}")


@pytest.mark.usefixtures("own_memory")
async def test_beacon_requested_by_a_tab_is_announced_to_all_tabs(
    small: SmallSession, ask: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pulled, runs = list[Beacon | None](), [False]
    monkeypatch.setattr(Feeling, "running", property(lambda _: runs[0]))
    monkeypatch.setattr(Feeling, "pull_to", lambda _, beacon: pulled.append(beacon))
    with pytest.raises(DeviceError, match="nothing is felt"):
        await ask("beacon", part=0)
    runs[0] = True
    await take(small.session, Text(IN_PARTS, tmp_path / "mine.yaml"))
    with pytest.raises(ConfigError, match="not made yet"):
        await ask("beacon", part=0)
    await ask("make", want="surface")
    assert await ask("beacon", part=0) == {"part": 0, "name": "wall"}
    told = small.tab.last("beacon")
    assert (told["part"], told["name"], told["why"]) == (0, "wall", "asked")
    assert pulled[-1] is not None and pulled[-1].part == 0
    with pytest.raises(ConfigError, match="there is no part 1000"):
        await ask("beacon", part=999)
    assert await ask("beacon", part=None) == {"part": None, "name": ""}
    assert pulled[-1] is None and small.tab.last("beacon")["part"] is None
    assert [each["event"] for each in small.session.tabs.history].count("beacon") == 1, "who comes later hears the last"
    small.worker.close()
    assert not [*shared_folder().glob("*.parcel")], "nothing is left of what was handed on"


@pytest.mark.usefixtures("loop_in_thread")
def test_beacon_ends_by_a_button_a_scene_and_a_stop() -> None:
    labels = np.zeros((32, 32), np.int32)
    labels[10:14, 24:28] = 3000
    names = tuple("" for _ in range(3001))
    surface = HapticSurface(Relief(np.full((32, 32), 0.002, np.float32), (0.08, 0.08)), labels, None, names)
    feeling, beacon = Feeling("ui-beacon"), beacon_to(surface, 3000)
    options = {name: value for name, value in feeling.own_device.items() if name != "use"}
    device = load_method("device", "pointer")(**options)

    def loop_input() -> LoopInput:
        touch = pack_touch(load_method("render", "proxy")().touch(surface), device.spec())
        return LoopInput(touch, "proxy", "it", device, True, WorkspaceMapping(), Safety(ramp_s=0, passivity="off"))

    tag = [0]

    def pulls(button: int = 0) -> bool:
        """Move the hand, as a page does all the time, and return True if it is pulled with this button held."""
        tag[0] += 1
        feeling.hand.point((-0.03, -0.03, 0.02), button, tag[0])
        assert feeling.servo is not None
        row = feeling.servo.ring.latest()
        if row is None or int(row[15]) & 0xFF != button or abs(row[2] + 0.03) > 1e-3:
            return False
        return float(np.hypot(row[11], row[12])) > 0.5

    try:
        with pytest.raises(DeviceError, match="nothing is felt"):
            feeling.pull_to(beacon)
        feeling.feel(loop_input())
        assert not pulls() and feeling.beacon_over() == ""
        feeling.pull_to(beacon)
        until(pulls)
        assert feeling.beacon_over() == ""
        frame = feeling.frame(1, 0)
        assert frame is not None and STATE_FRAME.unpack(frame)[2] == TickFlag.BEACON
        until(lambda: pulls(1))  # pressed down, it is pulled on
        until(lambda: not pulls(4))
        until(lambda: feeling.beacon_over() == "button")
        assert feeling.beacon_over() == "", "it is said once"
        feeling.pull_to(beacon)
        until(lambda: pulls(4))
        feeling.feel(loop_input())
        assert feeling.beacon_over() == "scene"
        feeling.pull_to(beacon)
        until(pulls)
        feeling.pull_to(None)
        until(lambda: not pulls())
        assert feeling.beacon_over() == "", "who let go of it knows"
        feeling.pull_to(beacon)
        feeling.cut()()
        assert feeling.beacon_over() == "ended"
    finally:
        feeling.stop()


async def test_beacon_that_ends_is_announced_with_the_reason() -> None:
    told: list[dict[str, Any]] = []
    ends = iter(["", "button", "", "ended"])
    feeling = SimpleNamespace(
        hand=SimpleNamespace(keep=lambda: None), beacon_over=lambda: next(ends, ""), loop_end=lambda: None
    )
    session: Any = SimpleNamespace(
        feeling=feeling,
        laws=SimpleNamespace(follow=lambda _: None, comparison=SimpleNamespace(loop_end=lambda: "")),
        tabs=SimpleNamespace(tell=lambda event, **said: told.append({"event": event, **said})),
    )

    task = asyncio.ensure_future(watch(session))
    await happened(lambda: len(told) >= 2)
    task.cancel()
    off = {"event": "beacon", "part": None, "name": ""}
    assert told == [{**off, "why": "button"}, {**off, "why": "ended"}]
