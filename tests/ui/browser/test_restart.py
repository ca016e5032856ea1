"""A page of an earlier start, and edits that were not saved: otherwise they are lost, or the page waits for ever."""

import os
import re
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from lasting_server import LastingServer
from page_files import built_page
from page_panels import wait_for_force
from tangible_core.data import TICK_COLUMNS
from tangible_core.servo.ring import Ring, shared_folder
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
    until(lambda: any("431" in path.read_text() for path in drafts.glob("*.json")), "the draft is kept")
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


@pytest.mark.whole
def test_program_that_hangs_is_reported_until_it_answers(serve, open_page):
    built_page()
    server = serve("builtin/brick")
    page = open_page(server.url)
    status = page.locator("#status")
    status.filter(has_text="Feeling").wait_for()
    server.process.send_signal(signal.SIGSTOP)
    try:
        start_s = time.monotonic()
        status.filter(has_text="No answer: the program hangs.").wait_for()
        assert time.monotonic() - start_s < 2 * 3
        status.filter(has_text="Start `tangible ui` again").wait_for(timeout=20_000)
    finally:
        server.process.send_signal(signal.SIGCONT)
    status.filter(has_text="Feeling").wait_for()


FORCE = slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)


def test_tab_that_is_frozen_or_closed_gives_no_force(opened, open_page, browser, tmp_path: Path) -> None:
    np.save(tmp_path / "level.npy", np.zeros((24, 32), np.float32))
    (tmp_path / "level.yaml").write_text(
        "scene: {height: level.npy}\nrender: {use: penalty, stiffness_n_per_m: 500}\nsafety: {ramp_s: 0}\n"
    )
    page = open_page(f"{opened(tmp_path / 'level.yaml')}&measure")
    page.wait_for_function("() => window.page?.scene")
    assert "token" not in page.url
    assert "measure" in page.url
    page.reload()
    page.wait_for_function("() => window.page?.scene")
    wait_for_force(page)
    ring = Ring.attach(max(shared_folder().glob("*.ring"), key=lambda path: path.stat().st_mtime))

    def has_force() -> bool:
        row = ring.latest()
        return row is not None and bool(row[FORCE].any())

    def press() -> None:
        box = page.locator("#terrain").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 3, y)
        until(has_force, "the mouse is not felt")

    press()
    session = browser.new_browser_cdp_session()
    found = session.send("SystemInfo.getProcessInfo")["processInfo"]
    renderers = [each["id"] for each in found if each["type"] == "renderer"]
    for renderer in renderers:
        os.kill(renderer, signal.SIGSTOP)
    try:
        until(lambda: not has_force(), "a tab that stands still holds the hand")
    finally:
        for renderer in renderers:
            os.kill(renderer, signal.SIGCONT)
    page.mouse.up()
    press()
    page.close()
    until(lambda: not has_force(), "a tab that was closed holds the hand")
