"""The newest tick as a page gets it: otherwise the page draws the hand or its force elsewhere."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tangible_web import framing, state_frame
from tangible_web.state_frame import OtherLaw, frame_without_loop, newest_frame

pytestmark = pytest.mark.usefixtures("unchecked_shapes")

HAND, VELOCITY, PROXY = (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), (7.0, 8.0, 9.0)
FORCE, OTHER = (10.0, 11.0, 12.0), (13.0, 14.0, 15.0)
TAG, BUTTONS = 77, 0b101


def servo(row: list[float] | None) -> Any:
    """A loop that began 2 s ago."""
    ring = SimpleNamespace(start_ns=5_000_000_000, overruns=9, latest=lambda: None if row is None else np.array(row))
    return SimpleNamespace(ring=ring)


def tick(flags: int = 0) -> list[float]:
    """A tick 1.5 s after the start, 0.25 ms late."""
    buttons = (TAG << framing.BUTTON_BITS) | BUTTONS
    return [1.5, 0.00025, *HAND, *VELOCITY, *PROXY, *FORCE, flags, buttons, 0.0]


@pytest.fixture(autouse=True)
def clocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(state_frame, "now_ns", lambda: 7_000_000_000)
    monkeypatch.setattr(state_frame, "time", SimpleNamespace(time=lambda: 1000.0))


def test_frame_has_every_number_of_the_tick_or_of_none() -> None:
    frame = newest_frame(servo(tick(flags=3)), 41, framing.RUNNING, OtherLaw(OTHER))
    assert frame is not None
    kind, status, flags, seq, tag, overruns, sample_ms, *numbers, late_us = framing.STATE_FRAME.unpack(frame)
    assert (kind, status, flags, seq, tag, overruns) == (framing.STATE, framing.RUNNING, 3, 41, TAG, 9)
    assert sample_ms == 999_500.0  # the tick came half a second ago
    assert tuple(numbers) == (*HAND, *PROXY, *FORCE, *VELOCITY, *OTHER)
    assert late_us == 250
    kind, status, flags, seq, tag, overruns, sample_ms, *numbers, late_us = framing.STATE_FRAME.unpack(
        frame_without_loop(2**32 + 3, framing.HOLDING)
    )
    assert (kind, status, flags, seq, tag, overruns) == (framing.STATE, framing.HOLDING, 0, 3, 0, 0)
    assert (sample_ms, late_us) == (1_000_000.0, 0)
    assert all(map(math.isnan, numbers[3:6])) and not any(numbers[6:])


def test_frame_hides_the_proxy_and_bits_that_nobody_may_see() -> None:
    frame = newest_frame(servo(tick()), 0, 0, OtherLaw(OTHER, blind=True))
    assert frame is not None
    numbers = framing.STATE_FRAME.unpack(frame)[7:-1]
    assert all(map(math.isnan, numbers[3:6]))
    assert (*numbers[:3], *numbers[6:]) == (*HAND, *FORCE, *VELOCITY, *OTHER)
    frame = newest_frame(servo(tick(flags=framing.FLAG_BITS + 1 + 5)), 2**32 + 6, 0)
    assert frame is not None
    _, _, flags, seq, *_ = framing.STATE_FRAME.unpack(frame)
    assert (flags, seq) == (5, 6)
