"""Messages of a tab: otherwise a damaged frame moves the hand, or a bad request ends the server."""

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tangible_core.errors import TangibleError
from tangible_ui.requests import REQUESTS, find_request
from tangible_web import framing as wire
from tangible_web.hand import Hand
from tangible_web.live import LiveTab, _as_json
from tangible_web.parsing import BadRequest, parse

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda deeper: st.lists(deeper, max_size=3) | st.dictionaries(st.text(max_size=8), deeper, max_size=3),
    max_leaves=8,
)
WHOLE = {
    wire.POINTER: wire.POINTER_FRAME.pack(wire.POINTER, 1, 7, 1.7e12, 0.01, -0.02, 0.003),
    wire.ACK: wire.ACK_FRAME.pack(wire.ACK, 1),
    wire.RELEASE: wire.RELEASE_FRAME.pack(wire.RELEASE),
}


def tab() -> tuple[Any, Hand]:
    """A tab that holds the hand, and the hand."""
    hand = Hand("ui-test")
    tab: Any = LiveTab.__new__(LiveTab)
    tab._program, tab._seq, tab._last_drawn = SimpleNamespace(hand=hand, holds=lambda _: True), 2, 0
    tab._new_ack = SimpleNamespace(set=lambda: None)
    return tab, hand


class TestFrames:
    def test_frame_that_is_complete_is_handled(self) -> None:
        live, hand = tab()
        live._handle_frame(WHOLE[wire.POINTER])
        assert hand.holding
        live._handle_frame(WHOLE[wire.RELEASE])
        assert not hand.holding
        live._handle_frame(WHOLE[wire.ACK])
        assert live._last_drawn == 1

    @pytest.mark.parametrize("kind", WHOLE)
    def test_frame_that_is_damaged_is_ignored(self, kind: int) -> None:
        frame = WHOLE[kind]
        for damaged in [*(frame[:end] for end in range(1, len(frame))), frame + b"\0", frame * 2]:
            if damaged in WHOLE.values():
                continue
            live, hand = tab()
            hand.point((0.01, 0.0, 0.0), 0, 0)
            held = hand._position
            live._handle_frame(damaged)
            assert (hand._position, live._last_drawn) == (held, 0)

    @given(st.binary(min_size=1, max_size=100))
    def test_frame_of_any_bytes_leaves_a_finite_hand(self, frame: bytes) -> None:
        check(frame)


def check(frame: bytes) -> None:
    live, hand = tab()
    live._handle_frame(frame)
    assert all(abs(part) <= 1.0 for part in hand._position.at)
    assert 0 <= live._last_drawn <= live._seq


def ask(**said: Any) -> str:
    return json.dumps({"number": 1, **said})


class TestAsks:
    def test_request_that_is_valid_is_parsed(self) -> None:
        asked = parse(ask(ask="edit", text="scene: x", apply=True), find_request)
        assert (asked.number, asked.ask, asked.arguments) == (1, REQUESTS["edit"], {"text": "scene: x", "apply": True})

    def test_request_that_is_invalid_is_refused_with_a_sentence(self) -> None:
        for text, number, says in (
            ("", None, "not JSON"),
            ('{"number": NaN, "ask": "stop"}', None, "not JSON"),
            ("[" * 100_000, None, "not JSON"),
            ("[]", None, '"number"'),
            ('{"ask": "stop"}', None, '"number"'),
            ('{"number": true, "ask": "stop"}', None, '"number"'),
            ('{"number": 1.0, "ask": "stop"}', None, '"number"'),
            (ask(ask=["x"]), 1, "there is no request"),
            (ask(), 1, "there is no request"),
            (ask(ask="stop", session=None), 1, "session: Extra"),
            (ask(ask="edit"), 1, "text: Field required"),
            (ask(ask="edit", text=5), 1, "text: .*string"),
            (ask(ask="edit", text="", apply=1), 1, "apply: .*bool"),
            (ask(ask="begin", files=[1]), 1, "files.0: .*string"),
        ):
            with pytest.raises(BadRequest, match=says) as refused:
                parse(text, find_request)
            assert refused.value.number == number
            assert len(str(refused.value)) < 400 and "\n" not in str(refused.value)

    @given(JSON, st.sampled_from(sorted(REQUESTS)))
    @settings(suppress_health_check=[HealthCheck.too_slow])
    def test_request_of_any_json_is_parsed_or_refused(self, told: Any, name: str) -> None:
        for said in (told, {"number": 1, "ask": told}, {"number": 1, "ask": name, "path": told, "text": told}):
            try:
                asked = parse(json.dumps(said), find_request)
            except TangibleError as error:
                assert str(error)
            else:
                assert asked.name not in REQUESTS or asked.ask is REQUESTS[asked.name]


def test_event_with_numbers_that_json_lacks_is_sent() -> None:
    event = {"a": [1.5, math.nan, {"b": (math.inf, 2)}], "c": -math.inf, "d": Path("/x")}
    found = json.loads(_as_json(event), parse_constant=lambda constant: pytest.fail(f"{constant} is not JSON"))
    assert found == {"a": [1.5, None, {"b": [None, 2]}], "c": None, "d": "/x"}
