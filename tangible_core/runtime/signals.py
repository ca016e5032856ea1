"""Signals that end the program, and the end of its console: they act as Ctrl-C, so that all is closed in order."""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from types import FrameType

from .system.console import ENDING, end_before_console

_received: list[signal.Signals] = []


@contextmanager
def end_as_ctrl_c() -> Generator[None]:
    """Raise KeyboardInterrupt at the first of these signals in this block; further ones do nothing."""
    _received.clear()
    here = threading.current_thread() is threading.main_thread()
    over = threading.Event()
    undo = end_before_console(_interrupt, over, ignore_ctrl_c=False)
    mine = [number for number in ENDING if here and signal.getsignal(number) == signal.SIG_DFL]
    for number in mine:
        signal.signal(number, _receive)
    try:
        yield
    finally:
        for number in mine:
            signal.signal(number, signal.SIG_DFL)
        over.set()
        undo()


def received_signal() -> signal.Signals | None:
    """Return the signal that ended the program, if one did."""
    return _received[0] if _received else None


def _interrupt() -> None:
    _received.append(ENDING[-1])
    signal.raise_signal(signal.SIGINT)


def _receive(number: int, _frame: FrameType | None) -> None:
    _received.append(signal.Signals(number))
    if len(_received) == 1:
        raise KeyboardInterrupt
