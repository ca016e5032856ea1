"""The end of the program from outside: signals, a paused terminal, and a console of Windows that is closed."""

import signal
import sys
import threading
from collections.abc import Callable
from typing import Any

CLOSING_S = 4.5
"""Longest time, s, for what is done before the process ends: Windows ends it five seconds after the message."""
CTRL_C, CTRL_BREAK, CLOSED, LOGGED_OFF, SHUT_DOWN = 0, 1, 2, 5, 6
"""Messages of a console of Windows."""

if sys.platform == "win32":
    import ctypes

    ENDING: tuple[signal.Signals, ...] = (signal.SIGTERM, signal.SIGBREAK)
    """The signals that end the program, besides Ctrl-C."""
    PAUSING: tuple[signal.Signals, ...] = ()
    """The signals that pause the program."""
    _kept: list[Any] = []
    """The handlers; the system calls them until the process ends."""

    def on_console_message(handle: Callable[[int], bool]) -> Callable[[], None]:
        """Call a function at each message of the console, in a thread of its own, until the returned one is called.

        handle: gets the message; returns True if nothing else shall be done. After `CLOSED`, `LOGGED_OFF` and
        `SHUT_DOWN` Windows ends the process when it returns.
        """
        kernel: Any = ctypes.WinDLL("kernel32")
        handler = ctypes.WINFUNCTYPE(ctypes.c_int, ctypes.c_uint32)(handle)
        _kept.append(handler)
        kernel.SetConsoleCtrlHandler(handler, True)
        return lambda: kernel.SetConsoleCtrlHandler(handler, False)

else:
    ENDING: tuple[signal.Signals, ...] = (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
    """The signals that end the program, besides Ctrl-C."""
    PAUSING: tuple[signal.Signals, ...] = (signal.SIGTSTP,)
    """The signals that pause the program."""

    def on_console_message(_handle: Callable[[int], bool]) -> Callable[[], None]:
        """Do nothing: here the end of a terminal is a signal."""
        return lambda: None


def end_before_console(end: Callable[[], object], over: threading.Event, ignore_ctrl_c: bool) -> Callable[[], None]:
    """Call `end` when the console is closed or the user logs off, and keep the process until `over` is set.

    ignore_ctrl_c: Ctrl-C does nothing, and Ctrl-Break acts as the end of the console.
    Returns: a function that undoes it.
    """

    def handle(message: int) -> bool:
        if message == CTRL_C:
            return ignore_ctrl_c
        if message == CTRL_BREAK and not ignore_ctrl_c:
            return False
        end()
        over.wait(CLOSING_S)
        return True

    return on_console_message(handle)
