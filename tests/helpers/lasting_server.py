"""A server of the page that many tests use one after the other, each with its own file."""

import shutil
from pathlib import Path
from typing import Any

from websockets.sync.client import connect

from page_server import TestTab
from ui_server import START, UiServer
from waiting import LONGEST_S

FORGETS = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from lasting_server import be_patient, forget, let_go, sleep_until_ticks
from tangible_ui.requests.table import REQUESTS
be_patient()
sleep_until_ticks()
REQUESTS["forget"] = forget
REQUESTS["let_go"] = let_go
{START}
"""


class LastingServer(UiServer):
    """A server that opens a built-in example first; `open` opens another file."""

    def __init__(self, folder: Path, env: dict[str, str]) -> None:
        self._data = Path(env["TANGIBLE_DATA_DIR"])
        """Recordings, what was opened by a page, unsaved documents."""
        self.runtime = Path(env["TANGIBLE_RUNTIME_DIR"])
        super().__init__("builtin/brick", cwd=folder, env=env, start=FORGETS)

    def open(self, file: str | Path) -> str:
        """Open a file of this machine or a scene that is built in, wait until it is felt; the page's address."""
        for path in self._data.iterdir():
            shutil.rmtree(path)
        host, url = self.url.split("/")[2], self.url.replace("http", "ws").replace("/?", "/live?")
        with TestTab(connect(url, origin=f"http://{host}", compression=None, max_size=None, proxy=None)) as tab:  # type: ignore[arg-type]
            tab.until(event="hello")
            for name, told in (
                ("stop_making", {}),
                ("forget", {}),
                ("begin", {"files": [str(file)], "make_it": False}),
            ):
                tab.until(event="answer", number=tab.ask(name, **told))
            tab.ask("choose_device", kind="hand")
            tab.until(event="touch")
            tab.until(event="answer", number=tab.ask("let_go"))
        return self.url


async def forget(session: Any, tab: Any) -> None:
    """Forget verdicts, files, comparisons and steps back of the documents before; the worker and the surface stay."""
    tabs = session.tabs
    for event in tabs._latest.keys() - {"maker", "described"}:
        del tabs._latest[event]
    tabs._history.clear()
    tabs._log.clear()
    session.document.texts = type(session.document.texts)()


async def let_go(session: Any, tab: Any) -> None:
    """Take the hand from all tabs: those of earlier tests may close late, and the next tab gets it as it comes."""
    session.tabs.hold(None)


def be_patient() -> None:
    """Let no loop be ended because a busy machine does not let it tick for a fifth of a second: as `patient`."""
    from tangible_core.servo import limits

    limits.WATCHDOG_PERIODS = 1000 * LONGEST_S


def sleep_until_ticks() -> None:
    """Let the loops of this process spin before no tick: all the while that tests run, it takes 15 % of a processor."""
    from tangible_core.servo import Servo
    from tangible_core.servo.ring import LEAD_NS, SPINS

    enter = Servo.__enter__

    def enter_without_spinning(self: Servo) -> Servo:
        enter(self)
        self.ring.header[[SPINS, LEAD_NS]] = 0
        return self

    Servo.__enter__ = enter_without_spinning
