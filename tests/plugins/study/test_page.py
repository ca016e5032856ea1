"""The page as a desk: what it serves, and answers over HTTP as a browser sends them."""

import json
import re
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import numpy as np
import pytest

from studies import write_study
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import DeviceError
from tangible_core.translation import translate
from tangible_study.desks.desk import Left
from tangible_study.desks.page import Page
from tangible_study.desks.page_hand import PageHand
from tangible_study.presenting.held_loop import HeldLoop
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.start import begin
from tangible_study.study_file import parse_study
from tangible_study.trials import read_answers
from tangible_web.framing import ACK, POINTER, POINTER_FRAME, RELEASE, RELEASE_FRAME, STATE_FRAME
from waiting import LONGEST_S, until

FORCE = [TICK_COLUMNS.index(each) for each in ("fx_n", "fy_n", "fz_n")]


def request(page: Page, path: str, body: bytes | None = None) -> Request:
    """A request as the page sends it."""
    return Request(page.address + path, body, {"Origin": page.address.rpartition("/")[0].rpartition("/")[0]})


def fetch(page: Page, path: str, body: object = None):
    with urlopen(request(page, path, None if body is None else json.dumps(body).encode())) as answer:
        return json.loads(answer.read())


def test_whole_study_is_answered_on_the_page(tmp_path: Path):
    study = write_study(tmp_path)
    file = parse_study(study.read_text(), study)
    with Page("de", lambda text: translate(text, "de")) as page, ThreadPoolExecutor(1) as background:

        def run() -> int:
            session = begin(file, Stimuli(file), "P1", tmp_path / "out", page, in_real_time=False)
            session.wait = lambda _: None
            return session.run()

        done, said = background.submit(run), list[str]()
        while "Das war der letzte Durchgang. Vielen Dank." not in said:
            for event in fetch(page, f"events?after={len(said)}"):
                said.append(event["text"])
                if event["choices"] is not None:
                    keys = [key for key, _ in event["choices"]]
                    for key, taken in (("9", False), ("y" if "y" in keys else keys[-1], True), (keys[0], False)):
                        assert fetch(page, "answer", {"number": event["number"], "key": key}) == taken
            assert not done.done() or done.result() == 7
        assert done.result() == 7
    assert {"Welcher Abschnitt war anders als die übrigen?", "Abschnitt 3."} <= set(said)
    answers = read_answers(tmp_path / "out/sub-P1/beh/sub-P1_task-small_beh.tsv")
    assert [each.response for each in answers if each.comparison == "odd"] == ["3"] * 5
    assert [each.response for each in answers if each.comparison == "rate"] == ["7"] * 2


def test_stop_ends_the_force_of_the_interval_and_leave_the_study():
    with Page("en", str) as page, ThreadPoolExecutor(1) as background:
        assert not page.stop.is_set()
        fetch(page, "stop", {})
        assert page.stop.is_set()
        asked = background.submit(page.ask, "Which?", {"1": ""})
        [event] = fetch(page, "events?after=0")
        assert fetch(page, "answer", {"number": event["number"], "key": "q"})
        with pytest.raises(Left):
            asked.result()


def test_page_asks_nobody_else_and_nobody_else_finds_it():
    with Page("en", str) as page:
        with urlopen(page.address) as answer:
            html, policy = answer.read().decode(), answer.headers["Content-Security-Policy"]
        assert policy.startswith("default-src 'none'; script-src 'nonce-")
        assert not re.search(r"https?:|src=|href=|url\(", html)
        assert html.count("</script>") == 1
        for path in ("", "events?after=0", "x/events?after=0", "../"):
            with pytest.raises(HTTPError, match="404"):
                urlopen(page.address.rpartition("/")[0].rpartition("/")[0] + "/" + path)


def test_answer_to_an_earlier_question_is_not_taken():
    with Page("en", str) as page, ThreadPoolExecutor(1) as background:
        for number in (1, 2):
            asked = background.submit(page.ask, "Which?", {"1": ""})
            until(lambda number=number: len(page.events_after(0)) == number, "the question")
            if number == 2:
                assert not fetch(page, "answer", {"number": 1, "key": "1"})
            assert fetch(page, "answer", {"number": number, "key": "1"})
            assert asked.result() == "1"


@pytest.mark.usefixtures("loop_in_thread")
class TestHand:
    """The page as the device: a surface is felt for as long as a test needs, at the address that the page asks."""

    @pytest.fixture
    def feel(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> Iterator[Callable[[], tuple[Page, list[np.ndarray], Future[None]]]]:
        monkeypatch.setattr(
            "tangible_study.desks.page.SURFACE_S", LONGEST_S
        )  # the tests are a slow page on a busy machine
        study, hand = write_study(tmp_path), PageHand()
        stimuli = Stimuli(parse_study(study.read_text(), study), hand.device)
        comparison, stimulus = next(iter(stimuli.recipes))
        feeling, rows = stimuli.feeling(comparison, stimulus), list[np.ndarray]()
        feeling.touch  # noqa: B018 - made before the interval begins
        with ThreadPoolExecutor(1) as background, Page("en", str, hand, ["force"]) as page, HeldLoop() as loop:

            def start() -> tuple[Page, list[np.ndarray], Future[None]]:
                return page, rows, background.submit(loop.feel, feeling, 600.0, rows.append, page, lambda: None, None)

            yield start
            page.stop.set()

    def test_surface_is_there_while_it_is_felt_alone(self, feel: Any):
        page, _, done = feel()
        told = begun(page)
        assert told["surface"] == 1 and told["sounds"] == ["force"] and told["lead"] is None
        for number in (0, 2):
            with pytest.raises(HTTPError, match="404"):
                fetch(page, f"surface?{number}")
        page.stop.set()
        assert isinstance(done.exception(), DeviceError)
        assert page.events_after(0)[-1]["surface"] == 0
        with pytest.raises(HTTPError, match="404"):
            fetch(page, "surface?1")

    def test_hand_that_leaves_or_falls_silent_feels_nothing(self, feel: Any):
        page, rows, _ = feel()
        begun(page)
        for message in (b"", b"x", pointer()[:-1], pointer() + b"0", bytes([ACK]) * 8):
            assert exchange(page, message) == b"", "whole messages alone are taken"
        assert not newest_n(rows)
        press_until_felt(page, rows)
        assert len(exchange(page, RELEASE_FRAME.pack(RELEASE))) == STATE_FRAME.size
        assert not page.hand._hand.holding, "released by the message, not by the silence after it"
        until(lambda: not newest_n(rows), "the force falls to zero")
        press_until_felt(page, rows)
        until(lambda: not newest_n(rows), "the force falls to zero in silence")

    def test_page_that_does_not_answer_interrupts_the_trial(self, feel: Any, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr("tangible_study.desks.page.SURFACE_S", 0.05)
        _, rows, done = feel()
        assert "does not answer" in str(done.exception())
        assert not newest_n(rows)


def begun(page: Page) -> dict[str, Any]:
    """Fetch the surface as the page does, and return the event that told of it."""
    event = until(lambda: next(filter(lambda event: event.get("surface"), page.events_after(0)), None), "the surface")
    fetch(page, f"surface?{event['surface']}")
    return event


def pointer() -> bytes:
    """The message of a hand that is in the middle of the surface."""
    return POINTER_FRAME.pack(POINTER, 1, 7, 0.0, 0.0, 0.0, 0.002)


def exchange(page: Page, message: bytes) -> bytes:
    with urlopen(request(page, "hand", message)) as answer:
        return answer.read()


def press_until_felt(page: Page, rows: list[np.ndarray]) -> None:
    """Press as the page does, until a state has a force, and the ticks that are kept, which come later, have it too."""

    def is_felt() -> bool:
        state = exchange(page, pointer())
        return bool(state) and STATE_FRAME.unpack(state)[15] > 0.05 and newest_n(rows) > 0.05

    until(is_felt, "a force")


def newest_n(rows: list[np.ndarray]) -> float:
    """The greatest component of the force of the last tick, newtons; 0 before the first one."""
    return float(np.abs(rows[-1][-1, FORCE]).max()) if rows else 0.0
