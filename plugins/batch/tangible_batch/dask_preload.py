"""A worker does not hear Ctrl-C: whoever handed out the scenes does, and ends it."""

import signal


def dask_setup(worker: object) -> None:
    """Called by Dask as a worker starts, in the main thread of its process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
