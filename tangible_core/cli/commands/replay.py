"""The command `replay`: the hand path of a recording with another force law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...errors import MAX_IN_LINE, shown
from .. import sentences, show
from ..options import Config, Json, NoCache, Record, Sets
from .run import open_pipeline

if TYPE_CHECKING:
    from ...session import BeaconFelt, PartFelt, Recording


def replay(
    recording: Annotated[
        Path, typer.Argument(metavar="RECORDING", help="Recording (.nc, .npz or .csv).", show_default=False)
    ],
    config: Config,
    sets: Sets = None,
    record: Record = None,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Re-run a recorded hand path with another force law.

    The recorded states go through the pipeline's force law, and the forces are compared.
    """
    from ... import session
    from ...pipeline.feeling import Feeling

    if record is not None:
        session.check_record_path(record)
    before = session.Recording.load(recording)
    pipeline = open_pipeline(config, sets or [], not no_cache)
    feeling = Feeling(pipeline)
    feeling.replay(replace(before, rows=before.rows[:0]))  # compilation on first use is not timed
    start = perf_counter()
    after = feeling.replay(before)
    seconds = perf_counter() - start
    if record is not None:
        replace(after, about=replace(after.about, device=f"replay of {recording.name}")).save(record)
    figures = {**session.compare_replay(before, after), "ns_per_tick": 1e9 * seconds / max(1, len(after.rows))}
    law = pipeline.config.render
    parts = feeling.parts_felt(after)
    pulled = session.beacons_felt(before, pipeline.surface)
    _print(before, figures, parts, pulled, record, as_json, law.name if law else "the force law")


MEANINGS = {
    "ticks": "",
    "compared": "all but those whose recorded force was limited, faded in, damped, faulty, or with a beacon",
    "error_n": "root mean square, over ticks in contact",
    "error_percent": "of the recorded force",
    "direction_deg": "mean angle",
    "jnd": "median, in just noticeable differences: 7 % or 18 degrees",
    "noticed_percent": "of ticks in contact",
    "worst_error_n": "",
    "recorded_peak_force_n": "",
    "peak_force_n": "of the force law itself, without a limit",
    "recorded_contact_share": "",
    "contact_share": "",
    "ns_per_tick": "called from Python if the force law is not compiled",
}


def _print(
    before: Recording,
    figures: dict[str, float],
    parts: Sequence[PartFelt],
    pulled: Sequence[BeaconFelt],
    record: Path | None,
    as_json: bool,
    law: str,
) -> None:
    from ... import session

    if as_json:
        recorded: dict[str, Any] = {"device": before.about.device, "renderer": before.about.renderer}
        recorded |= {"started": before.about.started, "stopped": before.stopped}
        recorded["parts"] = session.read_names(before.about.parts)
        recorded["beacons"] = [item._asdict() for item in pulled]
        recorded["materials"] = session.read_names(before.about.materials)
        touched = [part._asdict() for part in parts]
        show.print_json({"recorded": recorded, "figures": figures, "parts": touched, "file": record and str(record)})
        return
    if before.stopped:
        show.note(f"the recording ended early: {shown(before.stopped, MAX_IN_LINE)}")
    show.sentence(sentences.replay_summary(law, figures))
    show.table(("figure", "value", ""), [(name, f"{value:.6g}", MEANINGS[name]) for name, value in figures.items()])
    show.parts_felt(parts)
    for item in pulled:
        show.plain(f"\n{item}. Its ticks are not compared: only the force law is replayed.")
