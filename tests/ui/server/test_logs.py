"""Python's logging on pages: each level, never a flood, never an error in the code that logs."""

import io
import logging
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tangible_ui import logs
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.logs import MOST_A_SECOND, PageHandler, silence, tell_pages
from tangible_ui.state.session import MOST_HISTORY, MOST_LOGGED, Session


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

    def test_log_leaves_out_events_of_stages(self, told: list[dict[str, str]], caplog: pytest.LogCaptureFixture):
        caplog.set_level(logging.INFO, logs.KNOWN)
        logging.getLogger(logs.KNOWN).info("relief: ran")
        assert told == []

    def test_log_forwards_a_plugin_s_warning(self, told: list[dict[str, str]]):
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            logging.captureWarnings(False)  # catch_warnings put its own in the place
            logging.captureWarnings(True)
            warnings.warn("the picture is dark", stacklevel=1)
        assert told[0]["level"] == "warning" and "the picture is dark" in told[0]["text"]

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
        for _ in range(MOST_A_SECOND + 7):
            logging.getLogger("a").warning("again")
        assert len(told) == MOST_A_SECOND
        now[0] += 1
        logging.getLogger("a").warning("another")
        assert [each["text"] for each in told[MOST_A_SECOND:]] == [
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


@pytest.mark.parametrize(("asked", "level"), [({}, logging.NOTSET), ({"information": True}, logging.INFO)])
def test_our_own_information_is_let_through_only_where_it_is_asked_for(
    monkeypatch: pytest.MonkeyPatch, asked: dict[str, bool], level: int
):
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    loggers = [logging.getLogger(name) for name in logs.OWN]
    before = [each.level for each in loggers]
    try:
        for each in loggers:
            each.setLevel(logging.NOTSET)
        silence(tell_pages(lambda **_: None, **asked))
        assert {each.level for each in loggers} == {level}
    finally:
        for each, was in zip(loggers, before, strict=True):
            each.setLevel(was)


def test_standard_error_gets_the_log_as_before(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    monkeypatch.setattr("sys.stderr", stderr := io.StringIO())
    handler = tell_pages(lambda **_: None)
    logging.getLogger("a").warning("heard")
    silence(handler)
    assert stderr.getvalue() == "heard\n"


def test_history_of_a_flooded_log_keeps_the_other_events(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_ui.state.session.Worker", lambda *_: None)
    session = Session(tmp_path, Feeling("unheard"), [])
    session.tell("document", text="")
    for number in range(3000):
        session.tell("log", level="warning", logger="a", text=str(number))
    session.tell("touch", law="proxy")
    assert Counter(each["event"] for each in session.history) == {"document": 1, "log": MOST_LOGGED, "touch": 1}
    assert [each["at_s"] for each in session.history] == sorted(each["at_s"] for each in session.history)
    assert max(int(each["text"]) for each in session.history if each["event"] == "log") == 2999


def test_history_of_many_events_keeps_the_worker_and_the_description(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_ui.state.session.Worker", lambda *_: None)
    session = Session(tmp_path, Feeling("unheard"), [])
    session.tell("maker")
    for digest in ("a", "b"):
        session.tell("described", digest=digest)
    for number in range(2 * MOST_HISTORY):
        session.tell("stage", product=str(number))
    assert Counter(each["event"] for each in session.history) == {"maker": 1, "described": 1, "stage": MOST_HISTORY}
    assert [each["digest"] for each in session.history if each["event"] == "described"] == ["b"]
