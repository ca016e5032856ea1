"""Standard output belongs to the program: while one of its commands runs, what plugins print goes to standard error.

Not only `print`: a library in C writes to file 1, and so does a process that a plugin starts.
"""

import io
import os
import sys
from collections.abc import Generator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, TextIO, TypeGuard, final

from ..errors import OutputError

OUT, ERR = 1, 2
_own: list[TextIO] = []
"""Where the program writes while `protect` is open."""


def stream() -> TextIO | None:
    """Where the program's own results go; None where there is no standard output at all."""
    return _own[-1] if _own else sys.stdout


@contextmanager
def protect() -> Generator[None]:
    """While this is open, only `stream()` leads to standard output; all else goes to standard error.

    Where `sys.stdout` is not the process's own, as in a notebook, it alone is changed. A reader that goes away is no
    error: what comes later is written to nowhere. Raises: OutputError if what is written does not fit.
    """
    if _own:
        yield
        return
    _fill_closed()
    with ExitStack() as undo:
        _own.append(_move_aside(sys.stdout, undo) if _is_file_1(sys.stdout) else _replace(sys.stdout, undo))
        undo.callback(_own.clear)
        yield
        _own[-1].flush()


def leave() -> None:
    """The program has said all: what libraries in C hold back, they write when the process ends, to standard error."""
    if _is_file_1(sys.stdout):
        try:
            sys.stdout.flush()
        except OSError as error:
            raise give_up(error) from error
        os.dup2(ERR, OUT)


def give_up(error: OSError) -> OutputError:
    """After an error of `sys.stdout` itself: what it still holds goes nowhere, and this is to be said."""
    _lead_nowhere(OUT)
    return OutputError(_refusal(error))


def _refusal(error: OSError) -> str:
    return f"standard output cannot be written: {error.strerror}"


def _lead_nowhere(number: int) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    os.close(nowhere)


@final
class _Output(io.RawIOBase):
    """A file by its number, for a reader that may go away."""

    def __init__(self, number: int) -> None:
        self._number = number

    def fileno(self) -> int:
        return self._number

    def writable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return os.isatty(self._number)

    def write(self, data: Any, /) -> int:
        try:
            return os.write(self._number, data)
        except BrokenPipeError:
            _lead_nowhere(self._number)
            return memoryview(data).nbytes
        except OSError as error:
            raise OutputError(_refusal(error)) from error

    def close(self) -> None:
        if not self.closed:
            super().close()
            os.close(self._number)


def _move_aside(stdout: io.TextIOWrapper, undo: ExitStack) -> TextIO:
    """Standard output by another number, and standard error in its place, until it is undone."""
    stdout.flush()
    raw = _Output(os.dup(OUT))
    by_lines, at_once = stdout.line_buffering, stdout.write_through
    binary: Any = raw if at_once else io.BufferedWriter(raw)
    own = io.TextIOWrapper(binary, stdout.encoding, stdout.errors, line_buffering=by_lines, write_through=at_once)
    undo.callback(_close, own)
    undo.callback(os.dup2, raw.fileno(), OUT)
    undo.callback(stdout.reconfigure, line_buffering=by_lines)  # and what plugins wrote is flushed
    stdout.reconfigure(line_buffering=True)
    os.dup2(ERR, OUT)
    return own


def _is_file_1(stdout: TextIO | None) -> TypeGuard[io.TextIOWrapper]:
    try:
        return isinstance(stdout, io.TextIOWrapper) and stdout.fileno() == OUT
    except (OSError, ValueError):
        return False


def _replace(stdout: TextIO | None, undo: ExitStack) -> TextIO:
    """Whatever stands for standard output, and `sys.stderr` in its place."""
    undo.callback(setattr, sys, "stdout", stdout)
    sys.stdout = sys.stderr
    return undo.enter_context(open(os.devnull, "w")) if stdout is None else stdout  # noqa: PTH123


def _fill_closed() -> None:
    """Lead standard streams that are closed to nowhere: a file that is opened next would have their number."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= ERR:
        pass
    os.close(number)


def _close(own: TextIO) -> None:
    with suppress(OutputError):  # said already, when it was flushed
        own.close()
