"""`replay`: a recording through a pipeline's renderer."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Config, Json, NoCache, Record, Sets
from .run import open_pipeline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...session import BeaconFelt, PartFelt, Recording


def replay(
    recording: Annotated[Path, typer.Argument(help="What was felt (.nc, .npz or .csv).", show_default=False)],
    config: Config,
    sets: Sets = None,
    record: Record = None,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Feel a recording again with another law.

    The recorded states go through the pipeline's renderer, and the forces are compared.
    """
    from dataclasses import replace
    from time import perf_counter

    from ... import session
    from ...pipeline.feeling import Feeling

    if record is not None:
        session.check_record_path(record)
    before = session.Recording.load(recording)
    pipeline = open_pipeline(config, sets or [], not no_cache)
    feeling = Feeling(pipeline)
    feeling.replay(replace(before, rows=before.rows[:0]))  # what is compiled on first use is not timed
    start = perf_counter()
    after = feeling.replay(before)
    seconds = perf_counter() - start
    if record is not None:
        replace(after, about=replace(after.about, device=f"replay of {recording.name}")).save(record)
    figures = {**session.compare_replay(before, after), "ns_per_tick": 1e9 * seconds / max(1, len(after.rows))}
    law = pipeline.config.render
    parts = feeling.parts_felt(after)
    pulled = session.beacons_felt(before, pipeline.surface)
    _print(before, figures, parts, pulled, record, as_json, law.name if law else "the law")


MEANINGS = {
    "ticks": "",
    "compared": "all but those whose recorded force was limited, faded in, damped, with a beacon or none for a fault",
    "error_n": "root mean square, over ticks in contact",
    "error_percent": "of the recorded force",
    "direction_deg": "mean angle",
    "jnd": "median, in differences that are just noticed: 7 % or 18 degrees",
    "noticed_percent": "of ticks in contact",
    "worst_error_n": "",
    "recorded_peak_force_n": "",
    "peak_force_n": "of the law itself, which nothing limits here",
    "recorded_contact_share": "",
    "contact_share": "",
    "ns_per_tick": "called from Python, where the law is not compiled",
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
    from ...errors import MOST_IN_LINE, shown
    from .. import sentences, show

    if as_json:
        said: dict[str, Any] = {"device": before.about.device, "renderer": before.about.renderer}
        said |= {"started": before.about.started, "stopped": before.stopped}
        said["parts"] = session.names_of(before.about.parts)
        said["beacons"] = [each._asdict() for each in pulled]
        said["materials"] = session.names_of(before.about.materials)
        felt = [each._asdict() for each in parts]
        show.print_json({"recorded": said, "figures": figures, "parts": felt, "file": record and str(record)})
        return
    if before.stopped:
        show.note(f"the recording ended early: {shown(before.stopped, MOST_IN_LINE)}")
    show.sentence(sentences.replayed(law, figures))
    show.table(("figure", "value", ""), [(name, f"{value:.6g}", MEANINGS[name]) for name, value in figures.items()])
    show.parts_felt(parts)
    for each in pulled:
        show.plain(f"\n{each}. Its ticks are not compared: the law alone is replayed.")
