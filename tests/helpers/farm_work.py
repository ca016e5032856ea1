"""What workers of a farm are given in tests: they import it by its name."""

import ctypes
import os
import signal
import time


def square(number: int) -> int:
    """Dies of 7."""
    if number == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def stuck(number: int) -> int:
    """Never comes back of 2, and lets no other thread run."""
    if number == 2:
        ctypes.PyDLL(None).sleep(600)  # holds Python's lock, and uses no processor
    return number


def slow(number: int) -> int:
    """The process that worked."""
    time.sleep(0.05)
    return os.getpid()
