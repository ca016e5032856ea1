"""What workers of a farm are given in tests: they import it by its name."""

import os
import signal
import time


def square(number: int) -> int:
    """Dies of 7."""
    if number == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def slow(number: int) -> int:
    """The process that worked."""
    time.sleep(0.05)
    return os.getpid()
