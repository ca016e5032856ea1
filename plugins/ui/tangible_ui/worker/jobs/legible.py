"""A job that judges whether fingers can read the document."""

from pathlib import Path
from time import perf_counter
from typing import Any

from tangible_core.plugins.interfaces import Medium
from tangible_core.runtime.stopping import stoppable

from ..state import Bench, Job
from .checking import digest_of
from .making import telling


def legible(
    bench: Bench, number: int, text: str, path: Path, sets: list[str], medium: Medium, width_m: float | None
) -> dict[str, Any]:
    """Verdicts by the rules of one medium. width_m: of the whole picture there; that of the workspace without one.

    Raises: TangibleError as `Pipeline.legible`.
    """
    begun_s, digest = perf_counter(), digest_of(text)
    pipeline = bench.pipeline_of(text, path, sets)
    with bench.work(pipeline, number) as work:
        bench.tell("making", want="legible", digest=digest)
        pipeline.make("parts", telling(bench, work), work.stop)
        with stoppable(work.stop):
            judged = pipeline.legible(medium, width_m)
    width_m = pipeline.config.size.width_m if width_m is None else width_m
    found = {"digest": digest, "medium": medium, "width_m": width_m, **judged.as_data()}
    bench.tell("legible", **found)
    bench.tell("made", want="legible", digest=digest, outcome="made", why="", seconds=perf_counter() - begun_s)
    return found


JOBS = {"legible": Job(legible)}
