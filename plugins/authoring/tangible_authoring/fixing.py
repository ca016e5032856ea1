"""Corrections of a pipeline file for preflight: its cures, applied one at a time, each tried before the next."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from tangible_core.files.yaml import read_text
from tangible_core.pipeline import Feeling, Pipeline
from tangible_core.pipeline.config import edit_text, parse_config, relocate_text, with_overrides
from tangible_core.preflight import Change, Flight, Hand, Lateness, Loop, Preflight, judge

from .losses import losses

ROUNDS = 24
"""The most changes: most files need one to three, and each is tried on the surface that it makes."""
AT_ONCE = 0.001
"""The time for measuring the machine again, s: only the lateness of the first flight counts."""


@dataclass(frozen=True)
class Fixed:
    """The changes of a file, and the verdicts of preflight after them."""

    changes: Mapping[str, str]
    """New values by key, in the order of the changes."""
    losses: Sequence[str]
    """What each change takes away, as the end of a sentence about the surface."""
    flight: Flight
    verdicts: Preflight
    text: str
    """The file with these changes and its comments, with paths relative to its new place."""


class Cured(NamedTuple):
    """A text to which preflight has no further cures."""

    changes: Mapping[str, Change]
    """Changes by key, in their order."""
    flight: Flight
    verdicts: Preflight
    text: str
    pipeline: Pipeline
    """The pipeline of the text."""


def fix(path: Path, sets: Iterable[str], hand: Hand, loop: Loop, out: Path, cached: bool = True) -> Fixed:
    """Apply the cures of preflight, the unsafe first, until none is left; `verdicts.safe` is True if it passes.

    sets: `key.key=value` each, as `--set` takes them. out: the place for the file; nothing is written.
    Raises: ConfigError as `load_config`; TangibleError as `Feeling.flight`.
    """
    pipeline = Pipeline.from_yaml(path, sets := list(sets))
    if not cached:
        pipeline.engine.cache = None
    cured = cure(with_overrides(read_text(path), path, sets), path, pipeline, hand, loop)
    changes = {key: change.value for key, change in cured.changes.items()}
    text = relocate_text(cured.text, path, cured.pipeline.config, out)
    return Fixed(changes, losses(pipeline.config, cured.changes), cured.flight, cured.verdicts, text)


def cure(
    text: str,
    path: Path,
    pipeline: Pipeline,
    hand: Hand,
    loop: Loop,
    sets: Sequence[str] = (),
    lateness: Lateness | None = None,
) -> Cured:
    """Apply the cures of preflight to a text, and return it with its pipeline.

    sets: overrides of the pipeline that the text does not have. lateness: that of a running loop, in place of this
    process's. Raises: as `fix`.
    """
    flight = Feeling(pipeline).flight(hand=hand, loop=loop)
    flight = replace(flight, lateness=(lateness := lateness or flight.lateness))
    done: dict[str, Change] = {}
    for _ in range(ROUNDS):
        if (change := _next(judge(flight), done)) is None:
            break
        text = edit_text(text, path, {change.key: change.setting})
        done[change.key] = change
        pipeline = Pipeline.from_config(parse_config(text, path, pipeline.engine.registry, sets), like=pipeline)
        flight = Feeling(pipeline).flight(hand=hand, loop=replace(loop, seconds=AT_ONCE))
        flight = replace(flight, lateness=lateness)
    return Cured(done, flight, judge(flight), text, pipeline)


def _next(verdicts: Preflight, done: Mapping[str, Change]) -> Change | None:
    """Return the first change of the worst verdict that was not made yet."""
    worst_first = sorted(verdicts, key=lambda each: each.verdict != "unsafe")
    return next((change for each in worst_first for change in each.changes[:1] if _is_new(change, done)), None)


def _is_new(change: Change, done: Mapping[str, Change]) -> bool:
    before = done.get(change.key)
    if before is None:
        return True
    return before.towards == change.towards != "is" and before.stricter(change).value != before.value
