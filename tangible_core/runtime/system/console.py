"""The end of the program from outside: signals, a paused terminal, a console of Windows that is closed; stdin."""

import os
import signal
import sys
import threading
from collections.abc import Callable
from typing import IO, Any

# Longest time, s, for what is done before the process ends: Windows ends it five seconds after the message.
CLOSING_S = 4.5
CTRL_C, CTRL_BREAK, CLOSED, LOGGED_OFF, SHUT_DOWN = 0, 1, 2, 5, 6  # messages of a console of Windows

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
    """Call `end` when the console is closed, and keep the process until `over` is set; return the undoing."""

    def handle(message: int) -> bool:
        if message == CTRL_C:
            return ignore_ctrl_c
        if message == CTRL_BREAK and not ignore_ctrl_c:
            return False
        end()
        over.wait(CLOSING_S)
        return True

    return on_console_message(handle)


IN = 0


def take_input() -> IO[bytes]:
    """Return standard input, unbuffered, under another number; the null device takes its place.

    A library that is loaded looks at standard input, and Windows lets it wait there until a thread that reads has what
    it waits for. A thread may read the returned pipe while libraries load.
    """
    pipe = open(os.dup(IN), "rb", buffering=0)  # noqa: PTH123, SIM115 - a buffer's lock would outlive its thread
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, IN)
    os.close(nothing)
    _name_for_libraries()
    return pipe


if sys.platform == "win32":
    import ctypes
    import msvcrt

    def _name_for_libraries() -> None:
        """Tell Windows too: libraries with a C library of their own ask it, not ours."""
        ctypes.WinDLL("kernel32").SetStdHandle(-10, ctypes.c_void_p(msvcrt.get_osfhandle(IN)))

    def forget_typed(keys: IO[str]) -> None:
        """Forget what was typed at this terminal and not read yet."""
        while msvcrt.kbhit():
            msvcrt.getwch()

else:
    import termios

    def forget_typed(keys: IO[str]) -> None:
        """Forget what was typed at this terminal and not read yet."""
        termios.tcflush(keys, termios.TCIFLUSH)

    def _name_for_libraries() -> None:
        """Do nothing: file 0 is standard input for every library."""
