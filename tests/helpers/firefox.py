"""Firefox without a window, driven by WebDriver BiDi over its own websocket."""

import itertools
import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from websockets.sync.client import ClientConnection, connect

from needed import lacking
from waiting import LONGEST_S


class Tab:
    """The one tab of a browser, which is watched: its complaints, and whom it asks for something."""

    def __init__(self, socket: ClientConnection) -> None:
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self._socket, self._numbers = socket, itertools.count(1)
        self.ask("session.new", capabilities={})
        self.ask("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
        [tree] = self.ask("browsingContext.getTree")["contexts"]
        self.context = tree["context"]

    def ask(self, method: str, **params: Any) -> Any:
        """Send a command, and return its result; events that come meanwhile are kept."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while True:
            told = json.loads(self._socket.recv(timeout=LONGEST_S))
            if told.get("id") == number:
                assert told["type"] == "success", told
                return told["result"]
            self._hear(told)

    def open(self, url: str) -> None:
        self.ask("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def evaluate(self, expression: str) -> Any:
        """Return the value of an expression, or of what it promises: a text, a number or nothing."""
        target = {"context": self.context}
        done = self.ask("script.evaluate", expression=expression, target=target, awaitPromise=True)
        assert done["type"] == "success", done
        return done["result"].get("value")

    def _hear(self, told: dict[str, Any]) -> None:
        params = told.get("params", {})
        if told.get("method") == "log.entryAdded" and params["level"] == "error":
            self.complaints.append(params["text"])
        if told.get("method") == "network.beforeRequestSent":
            self.requests.append(params["request"]["url"])


@contextmanager
def firefox() -> Iterator[Tab]:
    """Start Firefox with a profile of its own, and end it."""
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if program is None:
        lacking("no Firefox is installed (on Debian: apt-get install firefox-esr)")
    with tempfile.TemporaryDirectory(prefix="tangible-firefox-") as profile:
        command = [program, "--headless", "--no-remote", "--profile", profile, "--remote-debugging-port", "0"]
        with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as process:
            assert process.stderr is not None
            try:
                found = (re.search(r"WebDriver BiDi listening on (ws://\S+)", line) for line in process.stderr)
                with connect(
                    f"{next(filter(None, found))[1]}/session", max_size=None, open_timeout=LONGEST_S
                ) as socket:
                    yield Tab(socket)
            finally:
                process.terminate()
