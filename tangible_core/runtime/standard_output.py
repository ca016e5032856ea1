"""Protection of standard output: while a command runs, output of plugins goes to standard error."""

import io
import os
import sys
from collections.abc import Generator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, TextIO, TypeGuard, final

from ..errors import OutputError

OUT, ERR = 1, 2
_own: list[TextIO] = []  # the program's own stream while `protect` is open


def stream() -> TextIO | None:
    """Return the stream for the program's own results; None if there is no standard output."""
    return _own[-1] if _own else sys.stdout


@contextmanager
def protect() -> Generator[None]:
    """Lead only `stream()` to standard output in this block, and all else to standard error."""
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
    """End the program's output: buffers that C libraries flush at exit go to standard error."""
    if _is_file_1(sys.stdout):
        try:
            sys.stdout.flush()
        except OSError as error:
            raise give_up(error) from error
        os.dup2(ERR, OUT)


def give_up(error: OSError) -> OutputError:
    """Discard the rest of a failing `sys.stdout`, and return the error to raise."""
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
    """A file by its number whose reader may go away; on Windows, also a console, which takes text alone."""

    def __init__(self, number: int) -> None:
        self._number = number
        raw: Any = open(number, "wb", buffering=0, closefd=False)  # noqa: SIM115 - it closes nothing
        self._console = None if isinstance(raw, io.FileIO) else raw

    def fileno(self) -> int:
        return self._number

    def writable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return os.isatty(self._number)

    def write(self, data: Any, /) -> int:
        try:
            return os.write(self._number, data) if self._console is None else self._console.write(data)
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
    """Move standard output to another number and put standard error in its place, until undone."""
    stdout.flush()
    raw = _Output(os.dup(OUT))
    by_lines, at_once = stdout.line_buffering, stdout.write_through
    binary: Any = raw if at_once else io.BufferedWriter(raw)
    errors = "backslashreplace" if stdout.errors == "strict" else stdout.errors
    own = io.TextIOWrapper(binary, stdout.encoding, errors, line_buffering=by_lines, write_through=at_once)
    undo.callback(_close, own)
    undo.callback(os.dup2, raw.fileno(), OUT)
    undo.callback(stdout.reconfigure, line_buffering=by_lines)  # this flushes the output of plugins
    stdout.reconfigure(line_buffering=True)
    os.dup2(ERR, OUT)
    return own


def _is_file_1(stdout: TextIO | None) -> TypeGuard[io.TextIOWrapper]:
    try:
        return isinstance(stdout, io.TextIOWrapper) and stdout.fileno() == OUT
    except (OSError, ValueError):
        return False


def _replace(stdout: TextIO | None, undo: ExitStack) -> TextIO:
    """Put `sys.stderr` in the place of a `sys.stdout` that is not file 1, until undone; return that stream."""
    undo.callback(setattr, sys, "stdout", stdout)
    sys.stdout = sys.stderr
    return undo.enter_context(open(os.devnull, "w")) if stdout is None else stdout  # noqa: PTH123


def _fill_closed() -> None:
    """Open the null device for closed standard streams: else the next opened file would get their number."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= ERR:
        pass
    os.close(number)


def _close(own: TextIO) -> None:
    with suppress(OutputError):  # reported already, when it was flushed
        own.close()
