"""Replay of a recording: the same states, tick by tick, through any touch; the difference of two recordings."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np
from jaxtyping import Float64

from ...compiled.touch import CompiledTouch
from ...data import UNTOUCHED, HapticState, TickFlag
from ...errors import check_positive
from ...metrics.truth_errors import force_errors
from ...plugins.interfaces import Touch
from .recording import Recording
from .tick_file import ARRAYS

NOWHERE = (math.nan, math.nan, math.nan)


def replay(touch: Touch, recording: Recording) -> Recording:
    """Return the recording of this touch for each recorded state, with recorded velocities and times.

    Forces are the law's own, without limits, as no device moves. Proxy and flags are the law's too.
    """
    proxy_m, force_n = np.full((2, len(recording.rows), 3), np.nan)
    if isinstance(touch, CompiledTouch):
        from ...compiled import kernels

        law = touch.address(), touch.fixed, touch.memory
        states = np.hstack([recording.position_m, recording.velocity_m_per_s])
        cast(Any, kernels).over_states(*law, states, proxy_m, force_n)
    else:
        for i, (time_s, _, x, y, z, vx, vy, vz, *_, buttons, _) in enumerate(recording.rows.tolist()):
            force_n[i] = touch.force(HapticState((x, y, z), (vx, vy, vz), time_s, int(buttons)))
    rows = recording.rows.copy()
    rows[:, ARRAYS["proxy_m"]], rows[:, ARRAYS["force_n"]] = proxy_m, force_n
    rows[:, ARRAYS["flags"]] = TickFlag.TOUCHING * force_n.any(axis=1)
    rows[:, ARRAYS["frame"]] = np.nan
    return replace(recording, rows=rows)


def proxy_reader(touch: Touch) -> Callable[[], tuple[float, ...]]:
    """Return a function that returns the present place of a touch's proxy; NaN if there is none."""
    if not isinstance(touch, CompiledTouch):
        return lambda: NOWHERE
    at = touch.memory[:3]

    def proxy() -> tuple[float, ...]:
        place = tuple(at.tolist())
        return NOWHERE if math.isnan(place[2]) else place

    return proxy


def unaltered_forces(recording: Recording) -> np.ndarray:
    """Return the recorded forces, NaN where a force was not the law's own on the surface at its start.

    Such forces were limited, faded in, damped or zero for a fault; or the surface had moved.
    """
    is_altered = (recording.flags & ~int(UNTOUCHED) != 0) | (recording.frame > 0)
    return np.where(is_altered[:, None], np.nan, recording.force_n)


def compare_replay(before: Recording, after: Recording) -> dict[str, float]:
    """Compare replayed forces with recorded ones of the same states, in figures by name."""
    truth_n = unaltered_forces(before)
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


# Greatest distance of two places that count as one: no hand finds a place again more exactly.
NEAR_M = 1e-3
# Greatest number of ticks that are compared; a longer recording is thinned evenly.
MAX_COMPARED = 100_000
SHOWN = ("ticks", "seconds", "contact_share", "median_contact_force_n", "peak_force_n", "work_j")


def compare_recordings(first: Recording, second: Recording, near_m: float = NEAR_M) -> dict[str, float]:
    """Compare two recordings along similar paths, of any speed and length, in numbers by name, each with its unit.

    Each tick of the first recording is compared with the nearest tick of the second, in place and in direction of
    motion, as friction turns with the direction. Ticks without a partner within near_m are left out.

    Returns: the figures of `Recording.figures` of the first as `first_...`, of the second as `second_...`; `compared`,
    the number of ticks with a partner, and `compared_share`, their share; `apart_m`, the median distance of partners;
    and the `force_errors` of the second's forces against the first's at partners, of which `error_n` is the root mean
    square over the ticks where either force is not zero. NaN if there is no partner.
    Raises: ConfigError if near_m is not positive.
    """
    check_positive("near_m", near_m)
    ours, theirs = (
        recording.rows[np.isfinite(_places(recording, near_m)).all(axis=1)] for recording in (first, second)
    )
    ours = ours[:: max(1, -(-len(ours) // MAX_COMPARED))]
    here, there = Recording(ours), Recording(theirs)
    partner, apart_m = _partners(here, there, near_m)
    near = apart_m <= near_m
    figures = {"first": first.figures(), "second": second.figures()}
    return {
        **{f"{which}_{name}": float(figures[which][name]) for name in SHOWN for which in figures},
        "compared": int(near.sum()),
        "compared_share": float(near.mean()) if near.size else 0.0,
        "apart_m": float(np.median(apart_m[near])) if near.any() else float("nan"),
        **force_errors(there.force_n[partner[near]], here.force_n[near]),
    }


def _partners(here: Recording, there: Recording, near_m: float) -> tuple[np.ndarray, Float64[np.ndarray, "n"]]:
    """Return the index of the second's tick that is the partner of each tick of the first, and their distance."""
    if not len(here.rows) or not len(there.rows):
        return np.zeros(len(here.rows), np.int64), np.full(len(here.rows), np.inf)
    from scipy.spatial import KDTree  # pyright: ignore[reportMissingTypeStubs]

    tree: Any = KDTree(_places(there, near_m))
    partner: np.ndarray = tree.query(_places(here, near_m))[1]
    return partner, np.linalg.norm(here.position_m - there.position_m[partner], axis=1)


def _places(recording: Recording, near_m: float) -> Float64[np.ndarray, "n 6"]:
    """Return places in units of near_m with unit vectors of motion; a reverse motion is as far away as two units."""
    speed = np.linalg.norm(recording.velocity_m_per_s, axis=1, keepdims=True)
    return np.hstack([recording.position_m / near_m, recording.velocity_m_per_s / np.where(speed > 0, speed, 1)])
