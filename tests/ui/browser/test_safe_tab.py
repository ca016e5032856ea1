"""A tab in a real browser that stands still or is closed: no force; and its address, which does not show the key."""

import os
import signal
from pathlib import Path

import numpy as np

from page_files import built_page
from page_panels import wait_for_force
from tangible_core.data import TICK_COLUMNS
from tangible_core.servo.ring import Ring
from waiting import until

FORCE = slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)


def test_tab_that_is_frozen_or_closed_gives_no_force(serve, open_page, browser, tmp_path: Path) -> None:
    built_page()
    np.save(tmp_path / "level.npy", np.zeros((24, 32), np.float32))
    (tmp_path / "level.yaml").write_text(
        "scene: {height: level.npy}\nrender: {use: penalty, stiffness_n_per_m: 500}\nsafety: {ramp_s: 0}\n"
    )
    shared = tmp_path / "shared"
    shared.mkdir()
    server = serve("level.yaml", cwd=tmp_path, TANGIBLE_SHARED_DIR=str(shared))
    page = open_page(f"{server.url}&measure", draws=True)
    page.wait_for_function("() => window.figures?.firstMs > 0")
    assert "token" not in page.url
    assert "measure" in page.url
    page.reload()
    page.wait_for_function("() => window.figures?.firstMs > 0")
    wait_for_force(page)
    ring = Ring.attach(next(shared.glob("*.ring")))

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
    for each in renderers:
        os.kill(each, signal.SIGSTOP)
    try:
        until(lambda: not has_force(), "a tab that stands still holds the hand")
    finally:
        for each in renderers:
            os.kill(each, signal.SIGCONT)
    page.mouse.up()
    press()
    page.close()
    until(lambda: not has_force(), "a tab that was closed holds the hand")
