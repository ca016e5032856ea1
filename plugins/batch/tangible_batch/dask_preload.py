"""The preload module of Dask's workers: they ignore Ctrl-C, which the batch process handles by ending them."""

import signal


def dask_setup(worker: object) -> None:
    """Ignore SIGINT. Dask calls this when a worker starts, in the main thread of its process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
