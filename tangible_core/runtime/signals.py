"""Signals that end the program: SIGTERM, SIGHUP and SIGQUIT act as Ctrl-C, so that everything is closed in order."""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from types import FrameType

ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name))
"""The signals sent by `kill`, by a system that shuts down, by a terminal that is closed, and by Ctrl-\\."""
_received: list[signal.Signals] = []


@contextmanager
def end_as_ctrl_c() -> Generator[None]:
    """Raise KeyboardInterrupt at the first of these signals in this block; further ones do nothing.

    A signal that was ignored before, as by nohup, or has another handler, is left alone. Only the main thread of a
    process receives signals: in another thread nothing is changed.
    """
    _received.clear()
    here = threading.current_thread() is threading.main_thread()
    mine = [each for each in ENDING if here and signal.getsignal(each) == signal.SIG_DFL]
    for each in mine:
        signal.signal(each, _receive)
    try:
        yield
    finally:
        for each in mine:
            signal.signal(each, signal.SIG_DFL)


def received_signal() -> signal.Signals | None:
    """Return the signal that ended the program, if one did."""
    return _received[0] if _received else None


def _receive(number: int, _frame: FrameType | None) -> None:
    _received.append(signal.Signals(number))
    if len(_received) == 1:
        raise KeyboardInterrupt
