"""What to change in a pipeline file for it to pass preflight: the cures, one at a time, each tried before the next."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from ..files.yaml.source import read_text
from ..preflight import Flight, Hand, Loop, Preflight, judge
from ..preflight.timing import Lateness
from ..preflight.verdict import Change
from .config.editing import edit_text, relocate_text, with_overrides
from .config.parsing import parse_config
from .feeling import Feeling
from .pipeline import Pipeline

ROUNDS = 24
"""Most need one to three changes; each is tried on the surface that it makes."""
AT_ONCE = 0.001
"""Seconds for which a machine is timed again: what counts is how late it was in the first flight."""


@dataclass(frozen=True)
class Fixed:
    """What was changed, and what preflight says then."""

    changes: Mapping[str, str]
    """By key, in the order in which they were made."""
    flight: Flight
    verdicts: Preflight
    text: str
    """The file with these changes and with its own comments, as one that stands where it is to be written."""


class Cured(NamedTuple):
    """A text that was changed until nothing is left to change."""

    changes: Mapping[str, Change]
    """By key, in the order in which they were made."""
    flight: Flight
    verdicts: Preflight
    text: str
    pipeline: Pipeline
    """What the text says."""


def fix(path: Path, sets: Iterable[str], hand: Hand, loop: Loop, out: Path, cached: bool = True) -> Fixed:
    """Change what the cures say, the unsafe first, until nothing is left to change; `verdicts.safe` says if it passes.

    sets: `key.key=value` each, as `--set` takes them. out: where the file is to stand; nothing is written.
    Raises: ConfigError as `load_config`; TangibleError as `Feeling.flight`.
    """
    pipeline = Pipeline.from_yaml(path, sets := list(sets))
    if not cached:
        pipeline.engine.cache = None
    found = cured(with_overrides(read_text(path), path, sets), path, pipeline, hand, loop)
    changes = {key: change.value for key, change in found.changes.items()}
    return Fixed(changes, found.flight, found.verdicts, relocate_text(found.text, path, found.pipeline.config, out))


def cured(
    text: str,
    path: Path,
    pipeline: Pipeline,
    hand: Hand,
    loop: Loop,
    sets: Sequence[str] = (),
    lateness: Lateness | None = None,
) -> Cured:
    """`fix` for a text, and the pipeline of it.

    sets: what the pipeline has beside the text. lateness: of a loop that runs, in place of this process's own.
    Raises: as `fix`.
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
    """The first change of the worst verdict that brings anything new."""
    worst_first = sorted(verdicts, key=lambda each: each.verdict != "unsafe")
    return next((change for each in worst_first for change in each.changes[:1] if _is_new(change, done)), None)


def _is_new(change: Change, done: Mapping[str, Change]) -> bool:
    before = done.get(change.key)
    if before is None:
        return True
    return before.towards == change.towards != "is" and before.stricter(change).value != before.value
