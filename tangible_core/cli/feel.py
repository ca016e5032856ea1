"""`feel`: a pipeline's surface on its device, in real time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import Config, Json, NoCache, Record, Sets
from .run import device_of, open_pipeline

if TYPE_CHECKING:
    from ..data import ServoReport
    from ..servo import Servo


def feel(
    config: Config,
    sets: Sets = None,
    seconds: Annotated[float, typer.Option(help="How long, s.")] = 8.0,
    record: Record = None,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Feel the surface on the configured device, in real time."""
    import time
    from dataclasses import asdict

    from .. import session
    from ..servo import OVER
    from . import show

    pipeline = open_pipeline(config, sets or [], not no_cache)
    device = device_of(pipeline)
    loop: dict[str, Any] = {}
    looks = session.Looks()
    reports: list[ServoReport] = []

    def started(servo: Servo) -> None:
        loop.update(how=servo.how, start_s=servo.start_s, first_tick_unix_s=time.time())

    def heard(report: ServoReport) -> None:
        reports[:] = [report]

    pipeline.feel(None, seconds, record=record, keep=looks.keep, on_report=heard, on_start=started)
    (report,) = reports
    felt, hand = session.figures(report), pipeline.followed(looks.recording())
    if as_json:
        figures = {"device": device.name, "spec": asdict(device.method.spec()), **felt}
        outcomes = show.as_rows(pipeline.outcomes)
        said = {"hand": hand._asdict(), "file": record and str(record)}
        show.print_json({"outcomes": outcomes, "loop": loop, "figures": figures, **said})
    else:
        show.outcomes(pipeline.outcomes)
        show.say(f"\n{loop['how']}; the first tick came {loop['start_s']:.2f} s after the loop was asked for\n")
        show.table(("figure", "value"), [(name, _text(value)) for name, value in felt.items()])
        if hand.says:
            show.plain(f"\n{hand.says}")
    if report.stopped == session.INTERRUPTED:
        raise KeyboardInterrupt
    if report.stopped != OVER:
        show.flush()
        raise session.failure(report.ticks, report.stopped)


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
