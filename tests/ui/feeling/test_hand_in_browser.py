"""The hand in a browser: otherwise mouse and keyboard do not feel, or a page that nobody sees pushes on."""

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from page_panels import open_panel
from tangible_core.data import TICK_COLUMNS
from tangible_core.servo.ring import Ring, shared_folder
from waiting import until

GONE_S = 20.0
"""Bound on the last force, s; the server lets go after a tenth of a second, but the machine may stand still."""
X = TICK_COLUMNS.index("x_m")
FORCE = slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)
Z = TICK_COLUMNS.index("z_m")
FELT_N = 0.001
FREEZE = "setTimeout(() => { const end = performance.now() + 3000; while (performance.now() < end); })"
HIDE = "Object.defineProperty(document, 'hidden', {value: true}); document.dispatchEvent(new Event('visibilitychange'))"


class Felt:
    """The server's force loop, by its ring."""

    def __init__(self) -> None:
        self.path = until(lambda: next(iter(self.rings()), None))
        self.ring = Ring.attach(self.path)

    @staticmethod
    def rings() -> list[Path]:
        return sorted(shared_folder().glob("*.ring"), key=lambda path: path.stat().st_mtime, reverse=True)

    def newest(self) -> np.ndarray:
        return self.ring.since(self.ring.count - 1)[0][-1]

    def force_n(self) -> float:
        return float(np.linalg.norm(self.newest()[FORCE])) if self.path.exists() else 0.0

    def quiet_after_s(self, begun_s: float) -> float:
        """Return the seconds from this moment to the last force; wait until there is none for a fifth of a second."""

        def last_s() -> float:
            rows, _ = self.ring.since(0)
            given = rows[np.abs(rows[:, FORCE]).max(axis=1) > FELT_N]
            return self.ring.start_ns / 1e9 + given[-1, 0] - begun_s

        until(lambda: time.monotonic() - begun_s - last_s() > 0.2)
        return last_s()


@pytest.fixture
def page(opened, open_page) -> Any:
    """A page on which a surface is felt; nothing moves its hand yet."""
    return felt_page(opened, open_page)


def felt_page(opened, open_page, **options: Any) -> Any:
    page = open_page(f"{opened('builtin/brick')}&measure", **options)
    wait_for_surface(page)
    page.wait_for_function("() => document.getElementById('log').textContent.includes('proxy:')")
    return page


def wait_for_surface(page: Any) -> None:
    page.wait_for_function("() => window.page?.scene")


def over(rows: np.ndarray) -> np.ndarray:
    """Return a mask of the ticks with a hand that is not released."""
    return rows[..., Z] < 0.1


def press(page: Any, felt: Felt) -> None:
    """The mouse, in the middle of the surface."""
    box = page.locator("#terrain").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    until(lambda: felt.force_n() > 0.05)


def test_mouse_gives_force_until_the_page_is_hidden_or_frozen(page: Any) -> None:
    felt = Felt()
    press(page, felt)
    page.mouse.up()
    assert felt.quiet_after_s(time.monotonic()) < GONE_S

    press(page, felt)
    hidden_s = time.monotonic()
    page.evaluate(HIDE)
    assert felt.quiet_after_s(hidden_s) < GONE_S
    page.mouse.up()
    page.reload()
    wait_for_surface(page)

    press(page, felt)
    page.evaluate(FREEZE)
    until(lambda: felt.force_n() < FELT_N)  # the mouse is still pressed: a page that lives would feel on
    page.mouse.up()


def test_closed_tab_leaves_no_force(page: Any) -> None:
    felt = Felt()
    press(page, felt)
    closed_s = time.monotonic()
    page.close()
    assert felt.quiet_after_s(closed_s) < GONE_S


def test_keyboard_gives_force_and_the_stop_key_works_in_a_field(page: Any) -> None:
    felt = Felt()
    page.locator("#terrain").focus()
    page.keyboard.press("Space")
    until(lambda: felt.force_n() > 0.05)
    begun, begun_m = felt.ring.count, felt.newest()[X]
    page.keyboard.down("ArrowRight")
    until(lambda: over(felt.newest()) and felt.newest()[X] > begun_m + 0.005)
    page.keyboard.up("ArrowRight")
    rows, _ = felt.ring.since(begun)
    held = over(rows)  # a page that is held up for a tenth of a second lets go
    speeds = (np.diff(rows[:, X]) / np.diff(rows[:, 0]))[held[1:] & held[:-1]]
    assert np.abs(speeds).max() < 0.5  # it does not leap from one step of a key to the next
    open_panel(page, "hand")
    page.locator("#press").focus()
    page.keyboard.press("Escape")
    until(lambda: not felt.path.exists())
    until(lambda: "Stopped" in page.locator("#status").text_content())
    page.locator("#again").click()
    until(lambda: Felt.rings() and Felt.rings()[0] != felt.path)
