"""The options of a session with a device, and what it needs of a pipeline."""

from collections.abc import Callable, Sequence
from os import PathLike
from threading import Event
from typing import Any, Protocol, TypedDict, runtime_checkable

import numpy as np

from ..data import ServoReport
from ..servo import Servo
from .engine.engine import Engine


@runtime_checkable
class Felt(Protocol):
    """The members of a pipeline that a session needs."""

    engine: Engine

    def make(self, want: str | None = None) -> Any:
        """Make a product."""
        ...


class FeelOptions(TypedDict, total=False):
    """Options of `Feeling.run` next to its seconds."""

    in_real_time: bool
    """True by default, for a loop in a process of its own; False runs a simulated device by its own clock."""
    record: str | PathLike[str] | None
    """A file (.nc, .npz, .csv) for every tick, written during the session."""
    keep: Callable[[np.ndarray], None] | None
    """A function called with all ticks, as rows of `TICK_COLUMNS`; the returned recording is then empty, and the length
    of a session is limited by the disk alone."""
    on_report: Callable[[ServoReport], None] | None
    """A function called ten times a second, and at the end."""
    on_start: Callable[[Servo], None] | None
    """A function called once a loop in real time runs."""
    stop: Event | None
    """An event that ends the session when another thread sets it."""
    then: Sequence[Felt]
    """The pipelines that follow this one, each for `each_s`, before this one comes again; in real time only."""
    each_s: float
    """Seconds for each pipeline of `then`; 60 by default."""
    on_wait: Callable[[str], None] | None
    """A function called with a sentence while a missing or disconnected device is awaited (`session.run_kiosk`); in
    real time only."""
    beacon: str | int | None
    """The name or the number of a part to which the hand is pulled gently, with 1 N at most, until a button of the
    device releases it; for every scene of `then`, too."""
