"""`tangible ...` as a call: what it prints and its exit code, in this process or in one that is started once for many.

Whole processes are for what only they show: signals, streams that are closed, a plugin that ends the program.
"""

import io
import json
import logging
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest.mock import patch

from tangible_core.cli.app import app, main
from tangible_core.translation import set_language

Done = subprocess.CompletedProcess[str]


def tangible(*words: object, cwd: Path) -> Done:
    """Call the command line in a folder; what it does not catch is raised here."""
    arguments = ["tangible", *map(str, words)]
    out, errors = io.StringIO(), io.StringIO()
    with chdir(cwd), redirect_stdout(out), redirect_stderr(errors), patch.object(sys, "argv", arguments), as_at_first():
        try:
            main()
        except SystemExit as ended:
            return subprocess.CompletedProcess(arguments, int(ended.code or 0), out.getvalue(), errors.getvalue())
    raise AssertionError("it ends with an exit code")


@contextmanager
def as_at_first() -> Iterator[None]:
    """Logs and commands of a program that has just started, and afterwards those of before."""
    root, commands = logging.getLogger(), list(app.registered_commands)
    loggers = [root, *(each for each in root.manager.loggerDict.values() if isinstance(each, logging.Logger))]
    levels = [each.level for each in loggers]
    with patch.object(root, "handlers", []):
        try:
            yield
        finally:
            app.registered_commands[:] = commands
            set_language("en")
            for logger, level in zip(loggers, levels, strict=True):
                logger.setLevel(level)


class Program:
    """A small process of its own that is called as often as wanted; `peak_kib` is the most that it ever held."""

    _BETWEEN = "import subprocess, sys; sys.exit(subprocess.call(sys.argv[1:]))"

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-S", "-c", self._BETWEEN, sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.peak_kib = 0

    def __call__(self, *words: object, cwd: Path) -> Done:
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps([str(cwd), *map(str, words)]) + "\n")
        self._process.stdin.flush()
        answer: dict[str, Any] = json.loads(self._process.stdout.readline())
        self.peak_kib = answer.pop("peak_kib")
        return subprocess.CompletedProcess(**answer)

    def close(self) -> None:
        """Let it end."""
        self._process.communicate("")


def _answer_calls() -> None:
    import resource

    own = sys.stdout
    for line in sys.stdin:
        cwd, *words = json.loads(line)
        answer = vars(tangible(*words, cwd=Path(cwd)))
        own.write(json.dumps({**answer, "peak_kib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}) + "\n")
        own.flush()


if __name__ == "__main__":
    _answer_calls()
