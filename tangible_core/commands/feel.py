"""`feel`: a pipeline's surface on its device, in real time."""

import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Any

from .. import session
from ..servo import OVER, Servo
from . import show
from .run import about, device_of, open_pipeline, tell_of


def feel(config: Path, sets: Sequence[str], seconds: float, record: Path | None, as_json: bool, cached: bool) -> None:
    """Make the touch, start the force loop, feel, and say how it went."""
    pipeline = open_pipeline(config, sets, cached)
    device = device_of(pipeline)
    if record is not None:
        session.check_record_path(record)
    touch = pipeline.make("touch")
    loop: dict[str, Any] = {}

    def started(servo: Servo) -> None:
        loop.update(how=servo.how, start_s=servo.start_s, first_tick_unix_s=time.time())

    with nullcontext() if record is None else session.keeping(record, about(pipeline)) as kept:
        report = session.feel(
            touch,
            device.method,
            seconds,
            pipeline.config.safety,
            tell_of(pipeline),
            kept.append if kept else _forget,
            started,
        )
        if kept:
            kept.close("" if report.stopped == OVER else report.stopped)
    figures = {"device": device.name, "spec": asdict(device.method.spec()), **session.figures(report)}
    if as_json:
        outcomes = show.as_rows(pipeline.outcomes)
        show.print_json({"outcomes": outcomes, "loop": loop, "figures": figures, "file": record and str(record)})
    else:
        show.outcomes(pipeline.outcomes)
        show.say(f"\n{loop['how']}; the first tick came {loop['start_s']:.2f} s after the loop was asked for\n")
        show.table(("figure", "value"), [(name, _text(value)) for name, value in session.figures(report).items()])
    if report.stopped == session.INTERRUPTED:
        raise KeyboardInterrupt
    if report.stopped != OVER:
        show.flush()
        raise session.failure(report.ticks, report.stopped)


def _forget(rows: Any) -> None:
    """Nobody records."""


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
