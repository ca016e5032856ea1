"""Messages between server and worker: pickles over a pipe, as those of the force loop."""

from typing import Any, NamedTuple

import numpy as np


class JobRequest(NamedTuple):
    """A job to do."""

    number: int
    job: str
    arguments: dict[str, Any]


class JobResult(NamedTuple):
    """The result of a job."""

    number: int
    value: Any


class JobFailure(NamedTuple):
    """The failure of a job."""

    number: int
    error: Exception


class Event(NamedTuple):
    """An event for pages."""

    event: str
    payload: dict[str, Any]


class Late(NamedTuple):
    """Lateness of the ticks of the running loop."""

    late_s: np.ndarray
    period_s: float
    real_time: bool  # true if the loop has real-time priority
