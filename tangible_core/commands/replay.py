"""`replay`: a recording through a pipeline's renderer."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from .. import session
from ..errors import MOST_IN_LINE, shown
from ..metrics.forces import force_errors
from ..session import Recording
from . import show
from .run import about, open_pipeline


def replay(
    recording: Path, config: Path, sets: Sequence[str], record: Path | None, as_json: bool, cached: bool
) -> None:
    """Make the touch, feel the recorded states again, and say how far the forces are apart."""
    if record is not None:
        session.check_record_path(record)
    before = Recording.load(recording)
    pipeline = open_pipeline(config, sets, cached)
    touch = pipeline.make("touch")
    session.replay(touch, replace(before, rows=before.rows[:0]))  # what is compiled on first use is not timed
    start = perf_counter()
    after = session.replay(touch, before)
    seconds = perf_counter() - start
    if record is not None:
        said = replace(about(pipeline), device=f"replay of {recording.name}").stamped()
        replace(after, about=said).save(record)
    figures = {**_figures(before, after), "ns_per_tick": 1e9 * seconds / max(1, len(after.rows))}
    _print(before, figures, record, as_json)


def _figures(before: Recording, after: Recording) -> dict[str, float]:
    truth_n = session.undisturbed(before)
    then, now = before.figures(), after.figures()
    worst_n = np.linalg.norm(after.force_n - truth_n, axis=1)
    return {
        "ticks": then["ticks"],
        "compared": int(np.isfinite(worst_n).sum()),
        **force_errors(after.force_n, truth_n),
        "worst_error_n": float(np.nanmax(worst_n, initial=0.0)),
        "recorded_peak_force_n": then["peak_force_n"],
        "peak_force_n": now["peak_force_n"],
        "recorded_contact_share": then["contact_share"],
        "contact_share": now["contact_share"],
    }


MEANINGS = {
    "ticks": "",
    "compared": "all but those whose recorded force was limited, faded in, damped or none for a fault",
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


def _print(before: Recording, figures: dict[str, float], record: Path | None, as_json: bool) -> None:
    if as_json:
        said: dict[str, Any] = {"device": before.about.device, "renderer": before.about.renderer}
        said |= {"started": before.about.started, "stopped": before.stopped}
        show.print_json({"recorded": said, "figures": figures, "file": record and str(record)})
        return
    if before.stopped:
        show.note(f"the recording ended early: {shown(before.stopped, MOST_IN_LINE)}")
    show.table(("figure", "value", ""), [(name, f"{value:.6g}", MEANINGS[name]) for name, value in figures.items()])
