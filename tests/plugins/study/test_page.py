"""The page as a desk: what it serves, tells and answers, and the surface as it gets it."""

import re
from base64 import b64decode
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import numpy as np
import pytest

from participants import Participant
from studies import write_study
from tangible_core import HapticSurface
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import DeviceError
from tangible_core.materials.assignment import library
from tangible_core.translation import translate
from tangible_study.desks.desk import ParticipantLeft
from tangible_study.desks.page import MAX_CELLS, Page, hand_changes, new_hand, surface_for_page
from tangible_study.presenting.presenter import HeldLoop
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.running import begin
from tangible_study.study_file import parse_study
from tangible_study.trials import read_answers
from waiting import LONGEST_S, until

FORCE = [TICK_COLUMNS.index(each) for each in ("fx_n", "fy_n", "fz_n")]


def test_whole_study_is_answered_on_the_page(tmp_path: Path):
    study = write_study(tmp_path)
    file = parse_study(study.read_text(), study)
    with Page("de", lambda text: translate(text, "de")) as page, ThreadPoolExecutor(1) as background:

        def run() -> int:
            session = begin(file, Stimuli(file), "P1", tmp_path / "out", page, in_real_time=False)
            assert session is not None
            session.wait = lambda _: None
            return session.run()

        with Participant(page) as tab:
            done, said = background.submit(run), list[str]()
            while "Das war der letzte Durchgang. Vielen Dank." not in said:
                event = tab.hear()
                said.append(event["text"])
                if event["choices"] is not None:
                    keys = [key for key, _ in event["choices"]]
                    for key, taken in (("9", False), ("y" if "y" in keys else keys[-1], True), (keys[0], False)):
                        assert tab.answer(event, key) == taken
            assert done.result() == 7
    assert {"Welcher Abschnitt war anders als die übrigen?", "Abschnitt 3."} <= set(said)
    answers = read_answers(tmp_path / "out/sub-P1/beh/sub-P1_task-small_beh.tsv")
    assert [answer.response for answer in answers if answer.comparison == "odd"] == ["3"] * 5
    assert [answer.response for answer in answers if answer.comparison == "rate"] == ["7"] * 2


def test_stop_ends_the_force_of_the_interval_and_leave_the_study():
    with Page("en", str) as page, ThreadPoolExecutor(1) as background, Participant(page) as tab:
        assert not page.stop.is_set()
        tab.ask("stop")
        assert page.stop.is_set()
        page.stop.clear()
        origin = page.address.rpartition("/")[0].rpartition("/")[0]
        assert urlopen(Request(f"{page.address}stop", b"", {"Origin": origin})).status == 204
        assert page.stop.is_set()
        asked = background.submit(page.ask, "Which?", {"1": ""})
        assert tab.answer(tab.hear(), "q")
        with pytest.raises(ParticipantLeft):
            asked.result()


def test_answers_are_asked_of_one_page_and_told_to_later_tabs():
    with Page("en", str) as page, ThreadPoolExecutor(1) as background, Participant(page) as tab:
        for number in (1, 2):
            asked = background.submit(page.ask, "Which?", {"1": ""})
            question = tab.hear()
            assert question["line"] == number
            assert number == 1 or not tab.answer({"line": 1}, "1")
            assert tab.answer(question, "1")
            assert asked.result() == "1"
    with Page("en", str) as page:
        page.say("First.")
        with Participant(page) as tab:
            page.say("Then.")
            told = [tab.hear() for _ in range(2)]
            assert [each["text"] for each in told] == ["First.", "Then."]
            assert "number" not in told[0] | told[1], "the page takes an event with a number for an answer"
    with Page("en", str) as page:
        with urlopen(page.address) as answer:
            html, policy = answer.read().decode(), answer.headers["Content-Security-Policy"]
        assert policy.startswith("default-src 'none'; script-src 'self'; ")
        assert not re.search(r"https?:|url\(", html)
        assert re.findall(r"(?:src|href)=\"(.*?)\"", html) == ["study.css", "study.js"]
        assert b"Versuchsleitung" in urlopen(f"{page.address}study.js").read()
        for path in ("", "live", "study.js", "x/live", "../"):
            with pytest.raises(HTTPError, match="404"):
                urlopen(page.address.rpartition("/")[0].rpartition("/")[0] + "/" + path)


@pytest.mark.usefixtures("loop_in_thread")
class TestHand:
    """The page as the device: a surface is felt for as long as a test needs, by messages as the page sends them."""

    @pytest.fixture
    def feel(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> Iterator[Callable[[], tuple[Page, list[np.ndarray], Future[None]]]]:
        monkeypatch.setattr(
            "tangible_study.desks.page.SURFACE_S", LONGEST_S
        )  # the tests are a slow page on a busy machine
        study, hand = write_study(tmp_path), new_hand()
        stimuli = Stimuli(parse_study(study.read_text(), study), hand_changes(hand))
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
        with Participant(page) as tab:
            told = tab.begin()
            assert told["surface"] == 1 and told["sounds"] == ["force"] and told["lead"] is None
            assert [tab.ask("surface", which=number) for number in (0, 2)] == [None, None]
            page.stop.set()
            assert isinstance(done.exception(), DeviceError)
            assert tab.hear()["surface"] == 0
            assert tab.ask("surface", which=1) is None

    def test_hand_that_leaves_is_silent_or_closed_feels_nothing(self, feel: Any):
        page, rows, _ = feel()
        with Participant(page) as tab:
            tab.begin()
            assert not newest_n(rows)
            press_until_felt(tab, rows)
            tab.release()
            until(lambda: not page.hand.holding, "released by the message, not by the silence after it")
            until(lambda: not newest_n(rows), "the force falls to zero")
            press_until_felt(tab, rows)
            until(lambda: not newest_n(rows), "the force falls to zero in silence")
            press_until_felt(tab, rows)
        until(lambda: not page.hand.holding and not newest_n(rows), "the force falls to zero without a page")

    def test_stop_ends_the_force_at_once(self, feel: Any):
        page, rows, done = feel()
        with Participant(page) as tab:
            tab.begin()
            press_until_felt(tab, rows)
            tab.ask("stop")
            assert not page.hand.holding
            assert isinstance(done.exception(), DeviceError)
            assert not page.running

    def test_page_that_does_not_answer_interrupts_the_trial(self, feel: Any, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr("tangible_study.desks.page.SURFACE_S", 0.05)
        _, rows, done = feel()
        assert "does not answer" in str(done.exception())
        assert not newest_n(rows)


def press_until_felt(tab: Participant, rows: list[np.ndarray]) -> None:
    """Press as the page does, until a state has a force, and the ticks that are kept, which come later, have it too."""
    until(lambda: tab.press() > 0.05 and newest_n(rows) > 0.05, "a force")


def newest_n(rows: list[np.ndarray]) -> float:
    """The greatest component of the force of the last tick, newtons; 0 before the first one."""
    return float(np.abs(rows[-1][-1, FORCE]).max()) if rows else 0.0


def test_surface_is_packed_small_without_what_would_name_it():
    heights = np.float32(np.arange(12).reshape(3, 4) / 1000)
    labels = np.int32([[0, 0, 1, 1]] * 3)
    made_of = tuple(library()[each] for each in ("wood", "sand"))
    sent = surface_for_page(HapticSurface.from_heights(heights, 0.08, labels, made_of), 7)
    meta = sent["meta"]
    assert np.array_equal(np.frombuffer(b64decode(sent["heights"]), "<f4").reshape(3, 4), heights)
    assert np.frombuffer(b64decode(sent["labels"]), "<u2").tolist() == labels.ravel().tolist()
    assert (sent["kinds"], [each["name"] for each in meta.pop("materials")]) == ([0, 1], ["", ""])
    assert meta == {
        "digest": "7", "name": "", "shows": "surface", "rows": 3, "columns": 4, "extent_m": pytest.approx([0.08, 0.06]),
        "height_m": pytest.approx([0.0, 0.011]), "levels": [{"step": 1, "rows": 3, "columns": 4}], "labels": 2,
        "label_bytes": 2, "parts": None, "photo": False, "fine_photo": None, "layers": {},
    }  # fmt: skip
    bare = surface_for_page(HapticSurface.from_heights(heights, 0.08), 8)
    assert (bare["labels"], bare["kinds"], bare["meta"]["labels"], bare["meta"]["materials"]) == ("", [], 0, [])
    labels = (np.indices((900, 1200))[1] >= 700).astype(np.int32)
    made_of = tuple(library()[each] for each in ("wood", "sand"))
    surface = HapticSurface.from_heights(np.float32(labels * 0.001), 0.12, labels, made_of)
    sent = surface_for_page(surface, 1)
    rows, columns = sent["meta"]["rows"], sent["meta"]["columns"]
    assert 0.8 * MAX_CELLS < rows * columns <= MAX_CELLS and columns / rows == pytest.approx(4 / 3, rel=0.01)
    at = np.frombuffer(b64decode(sent["labels"]), "<u2").reshape(rows, columns)
    middle = ((np.arange(columns) + 0.5) * 1200 / columns).astype(int)
    assert np.array_equal(at[0], middle >= 700)
    assert np.frombuffer(b64decode(sent["heights"]), "<f4").size == rows * columns
    assert sent["meta"]["extent_m"] == pytest.approx([0.12, 0.09])
