"""A participant's page: otherwise somebody cannot answer by the keyboard, or is told the condition."""

import json
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
import pytest

from accessible_names import axe_finds
from browser_tabs import OpenPage
from page_files import built_page
from studies import PIPELINE, write_study
from tangible_core.session import Recording
from tangible_study.desks.page import Page, hand_changes, new_hand
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.running import begin
from tangible_study.study_file import parse_study
from tangible_study.trials import Answer, read_answers

if TYPE_CHECKING:
    from playwright.sync_api import Page as Tab

EVERY_QUESTION = """\
study: small
pipeline: feel.yaml
feel_s: 0.7
pause_s: 0
order: as-written
consent: You may stop at any time.
conditions: {plain: {}, mellow: {set: {render.stiffness_n_per_m: 200}}}
comparisons:
- {name: first, question: rougher, repetitions: 1, training: 1}
- {name: odd, question: same, repetitions: 1}
- {name: two, question: different, repetitions: 1}
- {name: equal, question: equal, conditions: [plain], vary: workspace.relief_m, levels: [0.002, 0.003, 0.004],
   standard: 0.003, unit: m, repetitions: 1}
- {name: rate, question: rating, repetitions: 1}
- {name: parts, question: name, conditions: [plain], names: [cup, plate], repetitions: 1}
"""
"""A comparison of each kind of question; order and answers are those of the file, so that a right answer is known."""
PARTS = "materials: {by: rules}\nparts: {1: cup, 2: plate}\n"


ENTER = ("Press Enter to begin.", "Enter")
ANSWERS = (
    ("Do you agree?", "y: yes, I agree"),
    ENTER,
    *[("Which interval was rougher?", "2")] * 2,
    ENTER,
    ("Which interval was not the same as the others?", "3"),
    ENTER,
    ("Were the two intervals the same, or different?", "2: they were different"),
    ENTER,
    ("Was interval 2 equal to interval 1?", "1: no, it needs more"),
    ("Was interval 2 equal to interval 1?", "3: yes, it was equal"),
    ENTER,
    *[("Which number fits best?", "5")] * 2,
    ENTER,
    ("Which part was this?", "2: plate"),
    ("Which part was this?", "1: cup"),
)
"""What is asked, in order, and the button that answers it."""
WAITS = """() => {
  const [answer] = document.querySelectorAll("#answers button");
  const last = document.querySelector("#log").lastElementChild?.textContent ?? "";
  if (answer) return last;
  if (last.startsWith("That was the last trial.")) return "end";
  const { activeElement } = document;
  return activeElement.id === "pad" && document.querySelector("#said").textContent !== "Touching." && "pad";
}"""
"""What the page waits for: the question, or "pad" for a hand that does not press yet; "end" after the last trial."""


@contextmanager
def participant(folder: Path, text: str, open_page: OpenPage, pipeline: str) -> Iterator["Tab"]:
    """Yield the page of a participant of this study; the session has ended at the end."""
    built_page()
    path = write_study(folder, text, pipeline)
    hand = new_hand()
    file = parse_study(text, path)

    with Page("en", lambda text: text, hand, file.study.sounds) as page, ThreadPoolExecutor(1) as background:

        def run() -> int:
            session = begin(file, Stimuli(file, hand_changes(hand)), "P1", folder / "out", page)
            assert session is not None
            return session.run()

        done: Future[int] = background.submit(run)
        try:
            yield open_page(page.address)
            assert "mellow" not in json.dumps(page.greeting()), "nothing tells the condition"
        except BaseException:
            page.take(len(page.greeting()["history"]), "q")  # so that the session ends with the test
            page.stop.set()
            raise
        assert done.result() == len(answers_in(folder))


@pytest.mark.usefixtures("loop_in_thread")
def test_every_question_is_answered_by_keyboard_alone(tmp_path: Path, open_page: OpenPage):
    """From the consent to the last sentence, nothing but keys: intervals are pressed into, answers are tabbed to."""
    left = list(ANSWERS)
    pipeline = PIPELINE.replace("{height: heights.npy}", "{height: heights.npy, segments: halves.png}") + PARTS
    cv2.imwrite(str(tmp_path / "halves.png"), np.repeat(np.uint8([[0, 1]]), 12, axis=1).repeat(24, axis=0))
    with participant(tmp_path, EVERY_QUESTION, open_page, pipeline) as tab:
        while (what := tab.wait_for_function(WAITS).json_value()) != "end":
            if what == "pad":
                tab.keyboard.press("Space")
                tab.wait_for_function(f"() => ({WAITS})() !== 'pad'")
                continue
            question, answer = left.pop(0)
            assert what == question
            tab.wait_for_function("() => document.activeElement.id === 'answers'")
            assert left or axe_finds(tab) == []
            while focused(tab) != answer:
                tab.keyboard.press("Tab")
            tab.keyboard.press("Enter")
    assert not left
    tab.wait_for_timeout(600)  # a page that tried to connect to the program again would complain
    answers = answers_in(tmp_path)
    assert [each.response for each in answers] == ["2", "2", "3", "different", "0.003", "5", "5", "plate", "cup"]
    assert all(touched_n(tmp_path, each) > 0.1 for each in answers)


def focused(tab: "Tab") -> str:
    return tab.evaluate("document.activeElement.textContent")


def answers_in(folder: Path) -> list[Answer]:
    return list(read_answers(folder / "out/sub-P1/beh/sub-P1_task-small_beh.tsv"))


def touched_n(folder: Path, answer: Answer) -> float:
    """The greatest force of a trial's recording, newtons."""
    assert answer.recording is not None
    return Recording.load(folder / "out" / answer.recording).peak_force_n
