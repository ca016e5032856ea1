"""A participant's page: short sessions by keyboard alone, by mouse and by finger; nothing tells conditions."""

import json
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
import pytest

from browser_tabs import OpenPage
from page_files import WEB, built_page
from studies import PIPELINE, write_study
from tangible_core.session import Recording
from tangible_core.translation import translate
from tangible_study.desks.page import Page
from tangible_study.desks.page_hand import PageHand
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.start import begin
from tangible_study.study_file import parse_study
from tangible_study.trials import Answer, read_answers

if TYPE_CHECKING:
    from playwright.sync_api import Page as Tab

AXE = WEB / "node_modules/axe-core/axe.min.js"
RULES = {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}
STUDY = """\
study: small
pipeline: feel.yaml
feel_s: 1.5
pause_s: 0
language: de
order: as-written
consent: Sie können jederzeit aufhören.
sounds: [contact, force]
conditions: {secret: {}, hidden: {set: {render.stiffness_n_per_m: 200}}}
comparisons: [{name: rate, question: rating, repetitions: 1}]
"""
SPY = """
window.heard = [];
window.contexts = 0;
window.AudioContext = class extends AudioContext { constructor(...all) { super(...all); contexts++; } };
Object.defineProperty(window, "speechSynthesis", { value: { speak: ({ text }) => heard.push(text), cancel() {} } });
window.SpeechSynthesisUtterance = function (text) { this.text = text; };
"""


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
PARTS = "materials: {by: rules}\nparts: {0: cup, 1: plate}\n"


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
def participant(
    folder: Path, text: str, language: str, open_page: OpenPage, pipeline: str = PIPELINE
) -> Iterator[tuple["Tab", Page]]:
    """Yield the page of a participant of this study; the session has ended at the end."""
    built_page()
    path = write_study(folder, text, pipeline)
    hand = PageHand()
    file = parse_study(text, path)

    with (
        Page(language, lambda text: translate(text, language), hand, file.study.sounds) as page,
        ThreadPoolExecutor(1) as background,
    ):

        def run() -> int:
            session = begin(file, Stimuli(file, hand.device), "P1", folder / "out", page)
            assert session is not None
            return session.run()

        done: Future[int] = background.submit(run)
        tab = open_page("about:blank", has_touch=True)
        tab.add_init_script(SPY)
        tab.goto(page.address)
        try:
            yield tab, page
        except BaseException:
            page.take(len(page.events_after(0)), "q")  # so that the session ends with the test
            page.stop.set()
            raise
        assert done.result() == len(answers_in(folder))


@pytest.mark.usefixtures("loop_in_thread")
def test_session_by_keyboard_alone_and_by_mouse(tmp_path: Path, open_page: OpenPage):
    """The first trial by keys, the second by the mouse; axe looks at questions and at the pad."""
    with participant(tmp_path, STUDY, "de", open_page) as (tab, page):
        agree_and_begin(tab)
        feel_by_keys(tab)
        answer_by_tab(tab)
        feel_by_mouse(tab)
        tab.get_by_role("button", name="7", exact=True).wait_for()
        tab.keyboard.press("7")
        tab.get_by_text("Das war der letzte Durchgang. Vielen Dank.").wait_for()
        said = " ".join(map(str, [*tab.evaluate("heard"), tab.content(), json.dumps(page.events_after(0))]))
    assert not {"secret", "hidden", "proxy", "stiffness"} & set(said.replace('"', " ").split())
    assert "Durchgang 1 von 2." in said
    answers = answers_in(tmp_path)
    assert [each.response for each in answers] == ["2", "7"]
    assert [touched_n(tmp_path, each) > 0.1 for each in answers] == [True, True]


@pytest.mark.usefixtures("loop_in_thread")
def test_every_question_is_answered_by_keyboard_alone(tmp_path: Path, open_page: OpenPage):
    """From the consent to the last sentence, nothing but keys: intervals are pressed into, answers are tabbed to."""
    left = list(ANSWERS)
    pipeline = PIPELINE.replace("{height: heights.npy}", "{height: heights.npy, segments: halves.png}") + PARTS
    cv2.imwrite(str(tmp_path / "halves.png"), np.repeat(np.uint8([[0, 1]]), 12, axis=1).repeat(24, axis=0))
    with participant(tmp_path, EVERY_QUESTION, "en", open_page, pipeline) as (tab, _):
        while (what := tab.wait_for_function(WAITS).json_value()) != "end":
            if what == "pad":
                tab.keyboard.press("Space")
                tab.wait_for_function(f"() => ({WAITS})() !== 'pad'")
                continue
            question, answer = left.pop(0)
            assert what == question
            tab.wait_for_function("() => document.activeElement.id === 'answers'")
            while focused(tab) != answer:
                tab.keyboard.press("Tab")
            tab.keyboard.press("Enter")
    assert not left
    answers = answers_in(tmp_path)
    assert [each.response for each in answers] == ["2", "2", "3", "different", "0.003", "5", "5", "plate", "cup"]
    assert all(touched_n(tmp_path, each) > 0.1 for each in answers)


@pytest.mark.usefixtures("loop_in_thread")
def test_interval_felt_by_a_finger_has_a_force(tmp_path: Path, open_page: OpenPage):
    """A finger presses the surface of its interval; the next interval, which nobody touches, has none."""
    with participant(tmp_path, STUDY.replace("language: de", "language: en"), "en", open_page) as (tab, _):
        tab.get_by_role("button", name="y: yes, I agree").wait_for()
        tab.keyboard.press("y")
        tab.get_by_role("button", name="Enter").wait_for()
        tab.keyboard.press("Enter")
        tab.locator("#pad").wait_for()
        box: Any = tab.locator("#pad").bounding_box()
        touch = tab.context.new_cdp_session(tab)
        for kind, share in (("touchStart", 0.4), ("touchMove", 0.5), ("touchMove", 0.6)):
            place = {"x": box["x"] + share * box["width"], "y": box["y"] + box["height"] / 2}
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [place]})
        tab.get_by_text("Touching.").wait_for()
        touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        for answer in ("4", "6"):
            tab.get_by_role("button", name=answer, exact=True).tap()
            tab.get_by_text("Trial 2 of 2." if answer == "4" else "That was the last trial.").wait_for()
    felt, left_alone = answers_in(tmp_path)
    assert (felt.response, left_alone.response) == ("4", "6")
    assert touched_n(tmp_path, felt) > 0.1
    assert touched_n(tmp_path, left_alone) == 0


def focused(tab: "Tab") -> str:
    return tab.evaluate("document.activeElement.textContent")


def answers_in(folder: Path) -> list[Answer]:
    return list(read_answers(folder / "out/sub-P1/beh/sub-P1_task-small_beh.tsv"))


def agree_and_begin(tab: "Tab"):
    """The consent is answered by its key, the instruction by Enter."""
    tab.get_by_text("Sie können jederzeit aufhören.").wait_for()
    tab.get_by_role("button", name="y: ja, ich bin einverstanden").wait_for()
    assert tab.evaluate("document.documentElement.lang") == "de"
    assert tab.evaluate("contexts") == 0, "nothing sounds before somebody presses a key"
    assert axe_finds(tab) == []
    tab.keyboard.press("y")
    tab.get_by_role("button", name="Eingabetaste").wait_for()
    assert tab.evaluate("contexts") == 1
    tab.keyboard.press("Enter")


def feel_by_keys(tab: "Tab"):
    """The pad has the focus by itself; Space presses, arrows move."""
    tab.wait_for_function("() => document.activeElement.id === 'pad'")
    tab.keyboard.press("Space")
    tab.get_by_text("Berührt.").wait_for()
    tab.keyboard.down("ArrowRight")
    assert axe_finds(tab) == []
    tab.keyboard.up("ArrowRight")


def answer_by_tab(tab: "Tab"):
    """Space, with which the hand pressed, does not answer; the second button does."""
    tab.get_by_role("button", name="7", exact=True).wait_for()
    tab.wait_for_function("() => document.activeElement.id === 'answers'")
    tab.keyboard.press("Space")
    assert tab.locator("#pad").is_hidden()
    tab.keyboard.press("Tab")
    tab.keyboard.press("Tab")
    tab.keyboard.press("Enter")


def feel_by_mouse(tab: "Tab"):
    tab.locator("#pad").wait_for()
    box: Any = tab.locator("#pad").bounding_box()
    y = box["y"] + box["height"] / 2
    tab.mouse.move(box["x"] + 0.4 * box["width"], y)
    tab.mouse.down()
    for share in np.linspace(0.4, 0.6, 10):
        tab.mouse.move(box["x"] + share * box["width"], y)
    tab.get_by_text("Berührt.").wait_for()
    tab.mouse.up()


def touched_n(folder: Path, answer: Answer) -> float:
    """The greatest force of a trial's recording, newtons."""
    assert answer.recording is not None
    return Recording.load(folder / "out" / answer.recording).peak_force_n


def axe_finds(tab: "Tab") -> list[str]:
    tab.evaluate(f"{AXE.read_text(encoding='utf-8')}; 0")
    found = tab.evaluate("(runOnly) => axe.run(document, { runOnly, resultTypes: ['violations'] })", RULES)
    return [f"{each['id']} {node['target']}" for each in found["violations"] for node in each["nodes"]]
