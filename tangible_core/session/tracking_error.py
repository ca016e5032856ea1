"""The tracking error of a hand on its path, and its likely cause, in a sentence or two."""

from typing import NamedTuple, final

import numpy as np
from jaxtyping import Bool, Float32, Float64

from ..data import TICK_COLUMNS, HapticSurface
from .recording import Recording

EVERY = 10
"""Interval of the ticks that are examined."""
MAX_LOOKS = 360_000  # greatest number of ticks that are examined: an hour at 1 kHz
# Tracking error above which a hand is off its path; at most this fraction, 1 / 8, of the surface's shorter side.
OFF_M, OFF_PART = 0.01, 8
LATE_S = 0.25  # greatest lag of a hand behind its path that does not count as an error
REPORTED_SHARE = 0.05  # share of the time below which a problem is not reported
FOOT_M, AROUND_M, RISE_M = 0.003, 0.03, 0.001
"""Radius of the ground on which the hand stands; radius in which an obstacle is searched; its least height."""
HOLDS_N = 0.5
# Number of directions in which the ground is searched, and how many must rise around a hand in a pit.
DIRECTIONS, IN_A_PIT = 16, 14

Places = Float64[np.ndarray, "n 3"]
Which = Bool[np.ndarray, " n"]
GENTLER = (
    "A smaller `relief.slope`, a greater `workspace.smooth_m` or a smaller `workspace.relief_m` makes a surface that "
    "lets it pass."
)


class TrackingError(NamedTuple):
    """The tracking error of a hand on its path, in numbers and words."""

    off_share: float
    """Share of the time in which the hand was off its path; 0 if no path is known."""
    farthest_m: float
    """Greatest distance from the path."""
    beside_share: float
    """Share of the time in which a side wall of the surface held the hand off, under the rim."""
    says: str
    """A report with the likely cause; empty if all went well."""


@final
class TickSampler:
    """Every tenth tick of a session, for an hour."""

    def __init__(self) -> None:
        self._ticks = 0
        self._samples = [np.empty((0, len(TICK_COLUMNS)))]

    def keep(self, rows: np.ndarray) -> None:
        """Sample these ticks, which follow the ticks of the call before."""
        if self._ticks < MAX_LOOKS * EVERY:
            self._samples.append(rows[-self._ticks % EVERY :: EVERY].copy())
        self._ticks += len(rows)

    def recording(self) -> Recording:
        """Return a recording of the ticks 0, 10, 20 and so on."""
        return Recording(np.concatenate(self._samples))


def tracking_error(recording: Recording, wanted_m: Places | None, surface: HapticSurface) -> TrackingError:
    """Return the tracking error of a hand. wanted_m: the place on its path at each tick; None if it is not known."""
    beside, share, farthest_m, says = _held_off(recording, surface), 0.0, 0.0, ""
    beside_share = float(beside.mean()) if beside.size else 0.0
    if beside_share > REPORTED_SHARE:
        says = (
            f"The hand came in by the side of the surface, under its rim, and was held off there for "
            f"{100 * beside_share:.0f} % of the time. Begin above the surface, and stay over its {_size(surface)}."
        )
    if wanted_m is not None and beside.size:
        away_m, most_m = _distance(recording, wanted_m), min(OFF_M, min(surface.extent_m) / OFF_PART)
        share, farthest_m = float((away_m > most_m).mean()), float(away_m.max())
        if share > REPORTED_SHARE:
            says = (
                f"The hand did not follow its path: for {100 * share:.0f} % of the time it was more than "
                f"{1000 * most_m:.2g} mm off, {1000 * farthest_m:.0f} mm at most. Likely cause: "
            )
            says += _cause(recording, wanted_m, surface, away_m, most_m)
    return TrackingError(share, farthest_m, beside_share, says)


def _distance(recording: Recording, wanted_m: Places) -> Float64[np.ndarray, " n"]:
    """Return the horizontal distance of the hand from its path within the last LATE_S."""
    period_s = float(np.median(np.diff(recording.time_s))) if len(recording.rows) > 1 else LATE_S
    late = min(round(LATE_S / period_s), len(wanted_m) - 1) if period_s > 0 else 0
    path_m = np.pad(wanted_m[:, :2], ((late, 0), (0, 0)), mode="edge")
    count, at_m = len(wanted_m), recording.position_m[:, :2]
    ways_m = (at_m - path_m[first : first + count] for first in range(late + 1))
    return np.nan_to_num(np.min([np.hypot(*way_m.T) for way_m in ways_m], axis=0))


def _held_off(recording: Recording, surface: HapticSurface) -> Which:
    """Mark the ticks at which a side wall holds the hand off: a contact that began outside, a force mostly level."""
    touching: Which = np.asarray(recording.force_n.any(axis=1))
    over = _over(recording.position_m, surface)
    began = touching & ~np.append(False, touching[:-1])
    outside = np.flatnonzero(began & ~np.append(True, over[:-1]))
    contact = np.cumsum(began)
    level = np.abs(recording.force_n[:, 2]) < np.hypot(recording.force_n[:, 0], recording.force_n[:, 1])
    return np.asarray(touching & level & np.isin(contact, contact[outside]))


def _over(at_m: Places, surface: HapticSurface) -> Which:
    return np.asarray((np.abs(at_m[:, :2]) <= np.array(surface.extent_m) / 2).all(axis=1))


def _cause(
    recording: Recording, wanted_m: Places, surface: HapticSurface, away_m: Float64[np.ndarray, " n"], most_m: float
) -> str:
    """Return the likely cause of the tracking error, and the cure."""
    off, worst = away_m > most_m, int(away_m.argmax())
    if (_held_off(recording, surface) | ~_over(wanted_m, surface))[off].mean() > 0.5:
        return (
            f"its path leaves the surface, which is {_size(surface)}, and it came in again by the side, under the rim. "
            "Leave out the device's `size_m`, and its path stays over the surface."
        )
    held_n = float(np.median(np.hypot(*recording.force_n[off, :2].T)))
    if held_n < HOLDS_N:
        return "the hand was free, but too slow for its path. A smaller `speed_m_per_s` of the device lets it follow."
    at_m: Float64[np.ndarray, " 3"] = recording.proxy_m[worst]
    if not np.isfinite(at_m).all():
        at_m = recording.position_m[worst]
    here, goal_m = f"at x {1000 * at_m[0]:.0f} mm, y {1000 * at_m[1]:.0f} mm", wanted_m[worst] - at_m
    angles = np.arctan2(goal_m[1], goal_m[0]) + 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    foot_m = min(float(_ground(surface, at_m, angle, FOOT_M).min(initial=np.inf)) for angle in angles.tolist())
    rises_m = np.array([_ground(surface, at_m, angle, AROUND_M).max(initial=0) - foot_m for angle in angles.tolist()])
    if np.count_nonzero(rises_m > max(RISE_M, rises_m[0] / 2)) >= IN_A_PIT:
        return f"it was stuck in a pit {1000 * np.median(rises_m):.0f} mm deep {here}. {GENTLER}"
    if rises_m[0] > RISE_M:
        return f"it was stuck behind a wall {1000 * rises_m[0]:.0f} mm high {here}. {GENTLER}"
    return f"a level force of {held_n:.1f} N held it, such as friction. Less `static_friction` lets it slide."


def _ground(surface: HapticSurface, at_m: np.ndarray, angle: float, reach_m: float) -> Float32[np.ndarray, " n"]:
    """Return the heights along a straight line from a place, as far as the surface extends."""
    way_m = np.linspace(0, reach_m, 64)[:, None] * np.array([np.cos(angle), np.sin(angle), 0.0])
    places_m = at_m + way_m
    places_m = places_m[_over(places_m, surface)]
    (rows, columns), (width_m, length_m) = surface.height_m.shape, surface.extent_m
    row = np.clip(((0.5 - places_m[:, 1] / length_m) * rows).astype(int), 0, rows - 1)
    column = np.clip(((0.5 + places_m[:, 0] / width_m) * columns).astype(int), 0, columns - 1)
    return surface.height_m[row, column]


def _size(surface: HapticSurface) -> str:
    return " x ".join(f"{1000 * side:.0f}" for side in surface.extent_m) + " mm"
