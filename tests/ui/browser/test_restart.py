"""A page of an earlier start, and what was edited and not saved when the program was killed."""

import re
from pathlib import Path

from lasting_server import LastingServer
from page_files import built_page
from waiting import until

TEXT = "scene: builtin/brick\nrender: {use: penalty, stiffness_n_per_m: 431}\n"


def test_address_of_an_earlier_start_is_reported(lasting: LastingServer, open_page, complaints: list[str]):
    page = open_page(re.sub("token=.*", "token=of-yesterday", lasting.url))
    status = page.locator("#status")
    status.filter(has_text="belongs to an earlier start").wait_for()
    assert "tangible ui" in status.inner_text()
    assert page.evaluate("document.getElementById('said').textContent + document.getElementById('alerted').textContent")
    assert page.locator("#stop").is_visible()
    complaints.clear()  # the browser's own, of a websocket that was closed


def test_draft_of_a_killed_program_is_offered_once(serve, open_page, tmp_path: Path):
    built_page()
    mine = tmp_path / "mine.yaml"
    mine.write_text("scene: builtin/brick\n")
    kept = {"TANGIBLE_DATA_DIR": str(tmp_path / "data")}
    first = serve(mine, **kept)
    page = open_page(f"{first.url}&measure")
    page.wait_for_function("() => window.page?.document?.text")
    page.evaluate("text => window.page.net.ask('edit', { text })", TEXT)
    page.wait_for_function("text => window.page.document?.text === text", arg=TEXT)
    drafts = tmp_path / "data/unsaved"
    until(lambda: any("431" in each.read_text() for each in drafts.glob("*.json")), "the draft is kept")
    first.kill()
    page.close()
    assert mine.read_text() == "scene: builtin/brick\n"

    second = serve(mine, **kept)
    page = open_page(f"{second.url}&measure")
    offered = page.get_by_text("mine.yaml was edited and not saved when the program ended")
    offered.first.wait_for(state="attached")
    page.get_by_role("button", name="Open it again").click()
    page.wait_for_function("text => window.page.document?.text === text", arg=TEXT)
    page.get_by_role("button", name="Open it again").wait_for(state="hidden")
