"""Python's logging on pages: otherwise a plugin's warning is not seen, or a flood of them stops the page."""

import logging
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tangible_ui.feeling.feeling import Feeling
from tangible_ui.logs import MAX_A_SECOND, PageHandler, silence, tell_pages
from tangible_ui.state.session import Session
from tangible_ui.state.tabs import MAX_LOGGED


@pytest.fixture
def told() -> list[dict[str, str]]:
    return []


@pytest.fixture
def telling(told: list[dict[str, str]], monkeypatch: pytest.MonkeyPatch) -> Iterator[PageHandler]:
    root = logging.getLogger()
    monkeypatch.setattr(root, "handlers", [*root.handlers])
    handler = tell_pages(lambda **each: told.append(each))
    yield handler
    silence(handler)


@pytest.mark.usefixtures("telling")
class TestPageHandler:
    def test_log_forwards_all_warnings_and_our_own_information(
        self, told: list[dict[str, str]], caplog: pytest.LogCaptureFixture
    ):
        own, other = logging.getLogger("tangible_core.cache"), logging.getLogger("somebody")
        for each in (own, other):
            caplog.set_level(logging.INFO, each.name)
            each.info("quiet")
            each.warning("%s is full", "the disk")
            each.error("lost")
        assert [(each["logger"], each["level"], each["text"]) for each in told] == [
            ("tangible_core.cache", "detail", "quiet"),
            ("tangible_core.cache", "warning", "the disk is full"),
            ("tangible_core.cache", "error", "lost"),
            ("somebody", "warning", "the disk is full"),
            ("somebody", "error", "lost"),
        ]

    def test_log_of_an_exception_is_one_sentence(self, told: list[dict[str, str]]):
        try:
            raise ValueError("no such thing")
        except ValueError:
            logging.getLogger("a").exception("it failed")
        assert told[0]["text"] == "it failed: ValueError: no such thing"

    def test_log_flood_is_counted_instead_of_forwarded(
        self, told: list[dict[str, str]], monkeypatch: pytest.MonkeyPatch
    ):
        now = [10.0]
        monkeypatch.setattr("tangible_ui.logs.time.monotonic", lambda: now[0])
        for _ in range(MAX_A_SECOND + 7):
            logging.getLogger("a").warning("again")
        assert len(told) == MAX_A_SECOND
        now[0] += 1
        logging.getLogger("a").warning("another")
        assert [each["text"] for each in told[MAX_A_SECOND:]] == [
            "7 more lines came in one second and are left out",
            "another",
        ]


def test_log_handler_never_raises(
    telling: PageHandler, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def closed(**_: str) -> None:
        raise RuntimeError("Event loop is closed")

    monkeypatch.setattr(telling, "_tell", closed)
    logging.getLogger("a").warning("late")
    assert "Event loop is closed" in capsys.readouterr().err


def test_history_of_a_flooded_log_keeps_the_other_events(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_ui.state.session.Worker", lambda *_: None)
    session = Session(tmp_path, Feeling("unheard"), [])
    session.tabs.tell("document", text="")
    session.tabs.tell("maker")
    for number in range(3000):
        session.tabs.tell("log", level="warning", logger="a", text=str(number))
    session.tabs.tell("touch", law="proxy")
    assert Counter(each["event"] for each in session.tabs.history) == {
        "document": 1,
        "maker": 1,
        "log": MAX_LOGGED,
        "touch": 1,
    }
    assert [each["at_s"] for each in session.tabs.history] == sorted(each["at_s"] for each in session.tabs.history)
    assert max(int(each["text"]) for each in session.tabs.history if each["event"] == "log") == 2999
