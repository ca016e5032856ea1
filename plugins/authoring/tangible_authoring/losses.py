"""Losses of a surface by the corrections of its pipeline file, in words."""

from collections.abc import Mapping
from typing import Any

from tangible_core.data import unit_of
from tangible_core.pipeline.config import PipelineConfig
from tangible_core.preflight import Change, quantity

LOSSES: Mapping[str, tuple[str, str]] = {
    "workspace.smooth_m": ("blurs {times} as much", "blurs less"),
    "workspace.relief_m": ("is {times} as high", "is {times} as high"),
    "workspace.width_m": ("is {times} as wide", "is {times} as wide"),
    "relief.slope": ("may be steeper", "has no slope above {new}, so that steep edges become ramps"),
    "render.stiffness_n_per_m": ("is {times} as stiff", "is {times} as stiff"),
    "render.damping_n_s_per_m": ("is damped {times} as much", "is damped {times} as much"),
    "safety.stiffness_margin": ("may be {times} as stiff", "may be only {times} as stiff"),
}
"""The effect of a greater number on the surface, and of a smaller one, by key; `{times}` is the ratio."""
WORDS: Mapping[str, str] = {
    "materials.fit": "has materials that are felt more gently than they are, where the device cannot do better",
    "safety.coupling": "is felt through a spring, which makes hard things softer",
}
"""The effect of a changed word on the surface, by key."""


def losses(config: PipelineConfig, changes: Mapping[str, Change]) -> list[str]:
    """Return what each change takes away, as the end of a sentence that begins with the surface.

    config: the configuration before the changes.
    """
    return [_loss(config, key, change.setting) for key, change in changes.items()]


def _loss(config: PipelineConfig, key: str, new: Any) -> str:
    written = f"`{key}: {_in_words(key, new)}`"
    if key not in LOSSES or not isinstance(new, int | float):
        return f"{WORDS.get(key, 'is changed')} ({written})"
    (more, less), before = LOSSES[key], _value(config, key)
    if before is None:
        return f"{less.format(times='less', new=f'{new:g}')} ({written})"
    loss = more if new > before else less
    text = loss.format(times=_ratio(new / before), new=f"{new:g}") if before else "blurs what was sharp"
    return f"{text} ({written} in place of {_in_words(key, before)})"


def _value(config: PipelineConfig, key: str) -> float | None:
    """Return the number of a key before, defaults included; None where it has none."""
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
    unit = unit_of(key)
    if not isinstance(value, int | float):
        return str(value)
    return quantity(value, unit) if unit else f"{value:g}"
