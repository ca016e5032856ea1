"""`tangible ui` as a process of its own, as a browser meets it."""

import os
import queue
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Self

from waiting import LONGEST_S

START = "from tangible_core.cli import main; main()"
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/\S*")


class UiServer:
    """A server that listens once it is made; its output is kept in `lines`. A `with` block ends it."""

    def __init__(self, *words: object, cwd: Path, env: Mapping[str, str] | None = None, start: str = START) -> None:
        command = [sys.executable, "-c", start, "ui", *map(str, words), "--no-browser", "--port", "0"]
        self.process = subprocess.Popen(
            command,
            cwd=cwd,
            env={**os.environ, **(env or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            start_new_session=True,  # so that what a fault leaves behind can be found and ended
        )
        self.lines: list[str] = []
        self._addresses: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        try:
            self.url = self._addresses.get(timeout=LONGEST_S)
        except queue.Empty:
            self.url = ""
        if not self.url:
            self.kill()
            raise AssertionError("`tangible ui` does not listen:\n" + "\n".join(self.lines))

    def _read(self) -> None:
        assert self.process.stdout
        with self.process.stdout as out:
            for line in out:
                self.lines.append(line.rstrip())
                if found := ADDRESS.search(line):
                    self._addresses.put(found[0])
        self._addresses.put("")

    def stop(self) -> int:
        """End it as a service manager does; its exit code."""
        self.process.terminate()
        try:
            return self.process.wait(LONGEST_S)
        finally:
            self.kill()

    def kill(self) -> None:
        """End it and all that it started, at once."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self._reader.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
