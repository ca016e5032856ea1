"""A participant's page: a whole short session by keyboard alone, then by finger and mouse; nothing tells conditions."""

import json
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from browser_tabs import OpenPage
from page_files import WEB, built_page
from studies import write_study
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


@pytest.mark.usefixtures("loop_in_thread")
def test_session_by_keyboard_alone_and_by_mouse(tmp_path: Path, open_page: OpenPage):
    """The first trial by keys, the second by the mouse; axe looks at questions and at the pad."""
    built_page()
    path = write_study(tmp_path, STUDY)
    hand = PageHand()
    file = parse_study(STUDY, path)

    with (
        Page("de", lambda text: translate(text, "de"), hand, file.study.sounds) as page,
        ThreadPoolExecutor(1) as background,
    ):

        def run() -> int:
            session = begin(file, Stimuli(file, hand.device), "P1", tmp_path / "out", page)
            assert session is not None
            return session.run()

        done: Future[int] = background.submit(run)
        tab = open_page("about:blank")
        tab.add_init_script(SPY)
        tab.goto(page.address)
        try:
            agree_and_begin(tab)
            feel_by_keys(tab)
            answer_by_tab(tab)
            feel_by_mouse(tab)
            tab.get_by_role("button", name="7", exact=True).wait_for()
            tab.keyboard.press("7")
            tab.get_by_text("Das war der letzte Durchgang. Vielen Dank.").wait_for()
        except BaseException:
            page.take(len(page.events_after(0)), "q")  # so that the session ends with the test
            page.stop.set()
            raise
        assert done.result() == 2
        said = " ".join(map(str, [*tab.evaluate("heard"), tab.content(), json.dumps(page.events_after(0))]))
    assert not {"secret", "hidden", "proxy", "stiffness"} & set(said.replace('"', " ").split())
    assert "Durchgang 1 von 2." in said
    answers = read_answers(tmp_path / "out/sub-P1/beh/sub-P1_task-small_beh.tsv")
    assert [each.response for each in answers] == ["2", "7"]
    assert [touched_n(tmp_path, each) > 0.1 for each in answers] == [True, True]


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
