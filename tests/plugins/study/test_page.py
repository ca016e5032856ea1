"""The page as a desk: what it serves, and answers over HTTP as a browser sends them."""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

from studies import write_study
from tangible_core.translation import translate
from tangible_study.desks.desk import Left
from tangible_study.desks.page import Page
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.start import begin
from tangible_study.study_file import parse_study
from tangible_study.trials import read_answers


def fetch(page: Page, path: str, body: object = None):
    data = None if body is None else json.dumps(body).encode()
    with urlopen(Request(page.address + path, data)) as answer:
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
