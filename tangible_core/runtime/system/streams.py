"""Standard input: of a helper process, moved to where no library looks at it; of a terminal, what waits to be read."""

import os
import sys
from typing import IO

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
