"""The command `feel`: the surface of a pipeline on its device in real time, or of several pipelines in turn."""

from __future__ import annotations

import logging
import math
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...errors import PictureError, check_positive
from .. import sentences, show
from ..options import FAILED, Json, NoCache, Record, Sets, Verbose, Yes, is_quiet
from .run import configured_device, open_pipeline

if TYPE_CHECKING:
    from ...data import ServoReport
    from ...pipeline.pipeline import Pipeline
    from ...plugins.interfaces import HapticDevice
    from ...servo import Servo

SECONDS = 8.0
ALONE_S = 1.5  # without a hand before a warning


def feel(
    configs: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Pipeline files (YAML).", show_default=False)
    ],
    sets: Sets = None,
    seconds: Annotated[
        float | None, typer.Option(help="Duration, s; inf: without end.  [default: 8; for several files, one round]")
    ] = None,
    each: Annotated[float, typer.Option(help="Duration of each of several files, s.")] = 60.0,
    wait: Annotated[bool, typer.Option("--wait", help="Wait for a device that is missing or is unplugged.")] = False,
    beacon: Annotated[
        str | None,
        typer.Option(metavar="PART", help="Pull the hand gently to this part, by name or number; a button ends it."),
    ] = None,
    record: Record = None,
    verbose: Verbose = False,
    as_json: Json = False,
    no_cache: NoCache = False,
    yes: Yes = False,
) -> None:
    """Feel the surface on the configured device, in real time.

    Several files are felt in turn on the device of the first; none may have another device. If the depth map is
    unreliable, the command asks first.
    """
    from ... import session
    from ...pipeline.feeling import Feeling
    from ...servo import OVER

    check_positive("--each", each)
    pipeline, *then = (open_pipeline(config, sets or [], not no_cache) for config in configs)
    device = configured_device(pipeline)
    until_s = (each * len(configs) if then else SECONDS) if seconds is None else seconds
    for one in (pipeline, *then):
        confirm_doubts(one, yes)
        if one.scene.frames is not None and one.segments is not None:
            show.note(f"{one.scene.name}: parts and materials stay where they are in the first frame")
    if (then or wait) and not is_quiet():
        logging.getLogger("tangible_core.session.kiosk").setLevel(logging.INFO)  # each scene, with the time
    loop: dict[str, Any] = {}
    looks = session.TickSampler()
    reports: list[ServoReport] = []

    def note_start(servo: Servo) -> None:
        loop.setdefault("how", servo.how)
        loop.setdefault("start_s", servo.start_s)
        loop.setdefault("first_tick_unix_s", time.time())

    def take_report(report: ServoReport) -> None:
        if reports and reports[0].time_s < ALONE_S <= report.time_s:
            _warn_if_alone(pipeline.config.device and pipeline.config.device.method)
        reports[:] = [report]

    pipeline.feel(
        seconds=None if until_s == math.inf else until_s,
        record=record,
        keep=looks.keep,
        on_report=take_report,
        on_start=note_start,
        then=then,
        each_s=each,
        on_wait=show.note if wait else None,
        beacon=beacon,
    )
    (report,) = reports
    figures = session.figures(report)
    hand = None if then or wait else Feeling(pipeline).track(looks.recording())
    parts = () if then else Feeling(pipeline).parts_felt(looks.recording())
    pulled = session.beacons_felt(looks.recording(), pipeline.surface)
    if as_json:
        document: dict[str, Any] = {"outcomes": show.as_rows(pipeline.outcomes), "loop": loop}
        document["figures"] = {"device": device.name, "spec": asdict(device.method.spec()), **figures}
        document |= {"guard": session.guard_summary(report.flagged), "hand": hand and hand._asdict()}
        document |= {"part": report.part, "material": report.material, "parts": [part._asdict() for part in parts]}
        document |= {"beacon": report.beacon, "beacons": [each._asdict() for each in pulled]}
        show.print_json({**document, "file": record and str(record)})
    elif not is_quiet():
        show.sentence(sentences.touch_summary(device.name, figures), apart=verbose)
        if verbose:
            show.outcomes(pipeline.outcomes)
            if loop:
                show.say(f"\n{loop['how']}; the first tick came {loop['start_s']:.2f} s after the loop was requested\n")
            show.table(("figure", "value"), [(name, _text(value)) for name, value in figures.items()])
        show.parts_felt(parts)
        for beacon_felt in pulled:
            show.plain(f"\n{beacon_felt}.")
        for text in (session.guard_summary(report.flagged), hand and hand.says):
            if text:
                show.plain(f"\n{text}")
    if report.stopped == session.INTERRUPTED:
        raise KeyboardInterrupt
    if report.stopped != OVER:
        show.flush()
        raise session.failure(report.ticks, report.stopped)


def _warn_if_alone(device: HapticDevice | None) -> None:
    from ...plugins.interfaces import Attended

    if isinstance(device, Attended) and (why := device.unattended()):
        show.note(why)


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def confirm_doubts(pipeline: Pipeline, yes: bool) -> None:
    """Make the touch; if its notes doubt that it is worth feeling, ask, unless `--yes` was given. Raises: Exit."""
    pipeline.make("touch")
    doubts = "; ".join(doubt.text.partition(":")[0] for doubt in pipeline.outcomes.doubts)
    if yes or not doubts:
        return
    if sys.stdin is None or not sys.stdin.isatty():
        raise PictureError(f"{doubts}; correct it as the warning says, or feel it anyway with --yes")
    if not typer.confirm(f"{doubts[:1].upper()}{doubts[1:]}. Feel it anyway?", err=True):
        raise typer.Exit(FAILED)
