"""A process that has imported something, and runs code in forks of itself: the import's time is spent once for all."""

import json
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ENDS_S = 10.0
SERVES = """
import json, os, sys, traceback
for line in sys.stdin:
    code, folder = json.loads(line)
    if not os.fork():
        for number, name in ((1, "out"), (2, "errors")):
            os.dup2(os.open(os.path.join(folder, name), os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        ended = 0
        try:
            exec(code, {"__name__": "__main__"})
        except BaseException:
            ended = 1
            traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(ended)
    print(os.waitstatus_to_exitcode(os.wait()[1]), flush=True)
"""


class Forks:
    """Runs code as `python -c` would; whoever made it closes it."""

    def __init__(self, command: Sequence[str], **world: Any) -> None:
        """Start the process. command: `python -c` and what is imported before; world: as of `Popen`."""
        *python, begun = command
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
        self._process = subprocess.Popen([*python, begun + SERVES], **pipes, **world)

    def run(self, code: str) -> "subprocess.CompletedProcess[str]":
        """Run code in a fork, and wait for its end."""
        assert self._process.stdin and self._process.stdout
        with tempfile.TemporaryDirectory() as folder:
            self._process.stdin.write(json.dumps([code, folder]) + "\n")
            ended = int(self._process.stdout.readline())
            out, errors = (Path(folder, name).read_text("utf-8") for name in ("out", "errors"))
        return subprocess.CompletedProcess(code, ended, out, errors)

    def close(self) -> None:
        """Let the process end; one that waits for a fork that hangs is killed."""
        try:
            self._process.communicate(timeout=ENDS_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()
