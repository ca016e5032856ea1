"""What the server and the worker tell each other: pickles over a pipe, as the force loop has them."""

from typing import Any, NamedTuple

import numpy as np


class JobRequest(NamedTuple):
    """Do one of the worker's jobs."""

    number: int
    job: str
    told: dict[str, Any]
    """Arguments by name."""


class JobResult(NamedTuple):
    """The job is done."""

    number: int
    value: Any


class JobFailure(NamedTuple):
    """The job could not be done."""

    number: int
    error: Exception


class Event(NamedTuple):
    """Something happened meanwhile that pages should hear of."""

    event: str
    told: dict[str, Any]


class Late(NamedTuple):
    """How late the ticks of the loop began that gives the forces now."""

    late_s: np.ndarray
    period_s: float
    real_time: bool
    """Whether it runs before all others."""
