"""A server of the page that many tests use one after the other, each with its own file."""

import shutil
from pathlib import Path

from websockets.sync.client import connect

from page_server import TestTab
from ui_server import UiServer


class LastingServer(UiServer):
    """It opens the built-in example first; `open` opens whatever a test wants."""

    def __init__(self, folder: Path, env: dict[str, str]) -> None:
        self._data = Path(env["TANGIBLE_DATA_DIR"])
        """Recordings, what was opened by a page, unsaved documents."""
        self.runtime = Path(env["TANGIBLE_RUNTIME_DIR"])
        super().__init__("builtin/brick", cwd=folder, env=env)

    def open(self, file: str | Path) -> str:
        """Open a file of this machine or a scene that is built in, wait until it is felt; the page's address."""
        for each in self._data.iterdir():
            shutil.rmtree(each)
        with self._tab() as tab:
            self._done(tab, "begin", files=[str(file)], make_it=False)
            tab.ask("choose_device", kind="hand")
            tab.until(event="touch")
        return self.url

    def _tab(self) -> TestTab:
        host = self.url.split("/")[2]
        url = self.url.replace("http", "ws").replace("/?", "/live?")
        tab = TestTab(connect(url, origin=f"http://{host}", compression=None, max_size=None, proxy=None))  # type: ignore[arg-type]
        tab.until(event="hello")
        return tab

    def _done(self, tab: TestTab, name: str, **told: object) -> None:
        number = tab.ask(name, **told)
        while (said := tab.next()) is not None:
            if said.get("number") == number:
                assert said["event"] == "answer", said
                return
        raise AssertionError(f"no answer to {name}")
