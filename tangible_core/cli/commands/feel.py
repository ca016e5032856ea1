"""`feel`: a pipeline's surface on its device, in real time; or those of several, in turn."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import FAILED, Json, NoCache, Record, Sets, Yes
from ..verbosity import is_quiet
from .run import device_of, open_pipeline

if TYPE_CHECKING:
    from ...data import ServoReport
    from ...pipeline.pipeline import Pipeline
    from ...plugins.interfaces import HapticDevice
    from ...servo import Servo

SECONDS = 8.0
ALONE_S = 1.5
"""A hand has so long to come before it is said that there is none."""


def feel(
    configs: Annotated[list[Path], typer.Argument(metavar="CONFIG", help="Pipeline files (YAML).", show_default=False)],
    sets: Sets = None,
    seconds: Annotated[
        float | None, typer.Option(help="How long, s; inf: without end.  [default: 8; of several files, one round]")
    ] = None,
    each: Annotated[float, typer.Option(help="How long each of several files, s.")] = 60.0,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for a device that is not there, or goes.")] = False,
    beacon: Annotated[
        str | None,
        typer.Option(metavar="PART", help="Pull the hand gently to this part, by name or number; a button lets go."),
    ] = None,
    record: Record = None,
    as_json: Json = False,
    no_cache: NoCache = False,
    yes: Yes = False,
) -> None:
    """Feel the surface on the configured device, in real time.

    Several files are felt in turn, each with the device of the first; none may have another one. Where hardly anything
    matched in a pair of pictures, it asks first.
    """
    import math
    import time
    from dataclasses import asdict

    from ... import session
    from ...errors import check_positive
    from ...pipeline.feeling import Feeling
    from ...servo import OVER, TERMINATED
    from .. import sentences, show

    check_positive("--each", each)
    pipeline, *then = (open_pipeline(config, sets or [], not no_cache) for config in configs)
    device = device_of(pipeline)
    until_s = (each * len(configs) if then else SECONDS) if seconds is None else seconds
    for one in (pipeline, *then):
        ask_first(one, yes)
        if one.scene.frames is not None and one.segments is not None:
            show.note(f"{one.scene.name}: parts and materials stay where they are in the first frame")
    loop: dict[str, Any] = {}
    looks = session.Looks()
    reports: list[ServoReport] = []

    def started(servo: Servo) -> None:
        loop.setdefault("how", servo.how)
        loop.setdefault("start_s", servo.start_s)
        loop.setdefault("first_tick_unix_s", time.time())

    def heard(report: ServoReport) -> None:
        if reports and reports[0].time_s < ALONE_S <= report.time_s:
            _say_if_alone(pipeline.config.device and pipeline.config.device.method)
        reports[:] = [report]

    pipeline.feel(
        seconds=None if until_s == math.inf else until_s,
        record=record,
        keep=looks.keep,
        on_report=heard,
        on_start=started,
        then=then,
        each_s=each,
        on_wait=show.note if wait else None,
        beacon=beacon,
    )
    (report,) = reports
    felt = session.figures(report)
    hand = None if then or wait else Feeling(pipeline).track(looks.recording())
    parts = () if then else Feeling(pipeline).parts_felt(looks.recording())
    pulled = session.beacons_felt(looks.recording(), pipeline.surface)
    if as_json:
        figures = {"device": device.name, "spec": asdict(device.method.spec()), **felt}
        outcomes = show.as_rows(pipeline.outcomes)
        said = {"guard": session.changed_most(report.flagged), "hand": hand and hand._asdict()}
        said |= {"part": report.part, "material": report.material, "parts": [each._asdict() for each in parts]}
        said |= {"beacon": report.beacon, "beacons": [each._asdict() for each in pulled]}
        file = {"file": record and str(record)}
        show.print_json({"outcomes": outcomes, "loop": loop, "figures": figures, **said, **file})
    elif not is_quiet():
        show.sentence(sentences.felt(device.name, felt))
        show.outcomes(pipeline.outcomes)
        if loop:
            show.say(f"\n{loop['how']}; the first tick came {loop['start_s']:.2f} s after the loop was asked for\n")
        show.table(("figure", "value"), [(name, _text(value)) for name, value in felt.items()])
        show.parts_felt(parts)
        for beacon_felt in pulled:
            show.plain(f"\n{beacon_felt}.")
        for said in (session.changed_most(report.flagged), hand and hand.says):
            if said:
                show.plain(f"\n{said}")
    if report.stopped in (session.INTERRUPTED, TERMINATED):
        raise KeyboardInterrupt
    if report.stopped != OVER:
        show.flush()
        raise session.failure(report.ticks, report.stopped)


def _say_if_alone(device: HapticDevice | None) -> None:
    from ...plugins.interfaces import Attended
    from .. import show

    if isinstance(device, Attended) and (why := device.unattended()):
        show.note(why)


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def ask_first(pipeline: Pipeline, yes: bool) -> None:
    """Make the touch, and go on if it is worth feeling, or if the user, asked at a terminal or by `--yes`, wants it.

    Raises: Exit with 1 if the user does not; PictureError where nobody can be asked; TangibleError as `Pipeline.make`.
    """
    from ...errors import PictureError

    pipeline.make("touch")
    doubts = "; ".join(each.text.partition(":")[0] for each in pipeline.outcomes.doubts)
    if yes or not doubts:
        return
    if sys.stdin is None or not sys.stdin.isatty():
        raise PictureError(f"{doubts}; put it right as the warning says, or feel it all the same with --yes")
    if not typer.confirm(f"{doubts[:1].upper()}{doubts[1:]}. Feel it all the same?", err=True):
        raise typer.Exit(FAILED)
