"""Corrections of a pipeline file for preflight: its cures, applied one at a time, each tried before the next."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from tangible_core.data import option_unit
from tangible_core.files.yaml import read_text
from tangible_core.pipeline import Feeling, Pipeline
from tangible_core.pipeline.config import PipelineConfig, edit_text, parse_config, relocate_text, with_overrides
from tangible_core.preflight import Change, Flight, Hand, Lateness, Loop, Preflight, judge, quantity

ROUNDS = 24  # most files need one to three, each tried on the surface that it makes
AT_ONCE = 0.001  # to measure the machine again: only the lateness of the first flight counts


@dataclass(frozen=True)
class Fixed:
    """The changes of a file, and the verdicts of preflight after them."""

    changes: Mapping[str, str]  # new values by key, in the order of the changes
    losses: Sequence[str]  # what each takes away, as the end of a sentence about the surface
    flight: Flight
    verdicts: Preflight
    text: str  # the file with these changes, with paths relative to its new place


class Cured(NamedTuple):
    """A text to which preflight has no further cures."""

    changes: Mapping[str, Change]
    flight: Flight
    verdicts: Preflight
    text: str
    pipeline: Pipeline


def fix(path: Path, sets: Iterable[str], hand: Hand, loop: Loop, out: Path, with_cache: bool = True) -> Fixed:
    """Apply the cures of preflight, the unsafe first, until none remains; nothing is written. Raises: TangibleError."""
    pipeline = Pipeline.from_yaml(path, sets := list(sets))
    if not with_cache:
        pipeline.engine.cache = None
    result = cure(with_overrides(read_text(path), path, sets), path, pipeline, hand, loop)
    changes = {key: change.value for key, change in result.changes.items()}
    text = relocate_text(result.text, path, result.pipeline.config, out)
    return Fixed(changes, losses(pipeline.config, result.changes), result.flight, result.verdicts, text)


def cure(
    text: str,
    path: Path,
    pipeline: Pipeline,
    hand: Hand,
    loop: Loop,
    sets: Sequence[str] = (),
    lateness: Lateness | None = None,
) -> Cured:
    """Apply the cures of preflight to a text, and return it with its pipeline. lateness: of a running loop."""
    flight = Feeling(pipeline).flight(hand=hand, loop=loop)
    flight = replace(flight, lateness=(lateness := lateness or flight.lateness))
    changes: dict[str, Change] = {}
    for _ in range(ROUNDS):
        if (change := _next(judge(flight), changes)) is None:
            break
        text = edit_text(text, path, {change.key: change.setting})
        changes[change.key] = change
        pipeline = Pipeline.from_config(parse_config(text, path, pipeline.engine.registry, sets), like=pipeline)
        flight = Feeling(pipeline).flight(hand=hand, loop=replace(loop, seconds=AT_ONCE))
        flight = replace(flight, lateness=lateness)
    return Cured(changes, flight, judge(flight), text, pipeline)


def _next(verdicts: Preflight, changes: Mapping[str, Change]) -> Change | None:
    worst_first = sorted(verdicts, key=lambda verdict: verdict.verdict != "unsafe")
    return next((change for verdict in worst_first for change in verdict.changes[:1] if _is_new(change, changes)), None)


def _is_new(change: Change, changes: Mapping[str, Change]) -> bool:
    before = changes.get(change.key)
    if before is None:
        return True
    return before.towards == change.towards != "is" and before.stricter(change).value != before.value


# The effect of a greater number on the surface, and of a smaller one, by key; `{times}` is the ratio.
LOSSES: Mapping[str, tuple[str, str]] = {
    "workspace.smooth_m": ("blurs {times} as much", "blurs less"),
    "workspace.relief_m": ("is {times} as high", "is {times} as high"),
    "workspace.width_m": ("is {times} as wide", "is {times} as wide"),
    "relief.slope": ("may be steeper", "has no slope above {new}, so that steep edges become ramps"),
    "render.stiffness_n_per_m": ("is {times} as stiff", "is {times} as stiff"),
    "render.damping_n_s_per_m": ("is damped {times} as much", "is damped {times} as much"),
    "safety.stiffness_margin": ("may be {times} as stiff", "may be only {times} as stiff"),
}
WORDS: Mapping[str, str] = {
    "materials.fit": "has materials that are felt more gently than they are, where the device cannot do better",
    "safety.coupling": "is felt through a spring, which makes hard things softer",
}
"""The effect of a changed word on the surface, by key."""


def losses(config: PipelineConfig, changes: Mapping[str, Change]) -> list[str]:
    """Return what each change takes away, as the end of a sentence that begins with the surface."""
    return [_loss(config, key, change.setting) for key, change in changes.items()]


def _loss(config: PipelineConfig, key: str, new: Any) -> str:
    setting = f"`{key}: {_in_words(key, new)}`"
    if key not in LOSSES or not isinstance(new, int | float):
        return f"{WORDS.get(key, 'is changed')} ({setting})"
    (more, less), before = LOSSES[key], _value(config, key)
    if before is None:
        return f"{less.format(times='less', new=f'{new:g}')} ({setting})"
    loss = more if new > before else less
    text = loss.format(times=_ratio(new / before), new=f"{new:g}") if before else "blurs what was sharp"
    return f"{text} ({setting} in place of {_in_words(key, before)})"


def _value(config: PipelineConfig, key: str) -> float | None:
    block, _, name = key.partition(".")
    owner: Any = config.size if block == "workspace" else getattr(config, block)
    owner = owner.method if block == "render" else owner
    value = getattr(owner, name, None)
    return value if isinstance(value, int | float) else None


def _ratio(times: float) -> str:
    """Return a ratio in words.

    >>> _ratio(3.5), _ratio(0.4), _ratio(0.996)
    ('3.5 times', '40 %', '100 %')
    """
    return f"{times:.2g} times" if times >= 1.05 else f"{100 * times:.0f} %"


def _in_words(key: str, value: Any) -> str:
    unit = option_unit(key)
    if not isinstance(value, int | float):
        return str(value)
    return quantity(value, unit) if unit else f"{value:g}"
