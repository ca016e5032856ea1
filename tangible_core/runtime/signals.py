"""Being asked to end by a signal: SIGTERM and SIGHUP end a program as Ctrl-C does, with everything that follows it."""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from types import FrameType

ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""What `kill`, a system that shuts down and a terminal that is closed send."""
_received: list[signal.Signals] = []


@contextmanager
def end_as_ctrl_c() -> Generator[None]:
    """In this block the first of these signals raises KeyboardInterrupt, and the others find the program ending.

    One that was ignored before, as by nohup, or that somebody else answers, is left alone. Only the main thread of a
    process can hear signals: in another one nothing is changed.
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
    """The signal that ended the program, if one did."""
    return _received[0] if _received else None


def _receive(number: int, _frame: FrameType | None) -> None:
    _received.append(signal.Signals(number))
    if len(_received) == 1:
        raise KeyboardInterrupt
