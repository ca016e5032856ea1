"""Checks of slopes and of the force: stiff places, walls, sudden forces, and places where the device is too weak."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..flight import Flight
from ..probes import SIDEWAYS
from ..verdict import FEW, Change, Cure, Verdict, check_bound, under
from .cures import COUPLE, FIT, SOFTEST_N_PER_M, flatten, gentler, join_cures, round_off, slopes, soften
from .stiffness import TOO_STIFF

MEASURED = 1.01  # ratio of a measured stiffness to the true one that is allowed as an error
# Share of a stroke up to which the walls that hold a hand up count as outlines.
WALLS = 0.125
# Smallest slope limit of a cure: under less, a step of 1 mm is a ramp that fingers do not feel as a step.
GENTLEST = 0.4
PROXY = "proxy"  # name of the force law whose stiffness is that of level ground everywhere
LEVEL = 1.1  # ratio to the stiffness on level ground up to which slopes are not at fault
# Share of the surface that may be too stiff: the passivity controller brakes there.
RARE = 0.001


def slope_stiffness(flight: Flight) -> Iterator[Verdict]:
    """Check the share of the surface where the law, along its force, is stiffer than the device renders stably."""
    # The stiffness of a penalty along the gradient grows by 1 + |g|^2 with the slope g, that of a texture by its
    # curvature times the force; that of a proxy does not grow with slopes. The guard does not see it.
    limit, _, source = flight.ceilings[0]
    stiffness = np.array([flight.felt_n_per_m(law) for law in flight.probes.stiffness_n_per_m.tolist()])
    share, most = float(np.mean(~(stiffness <= MEASURED * limit))), float(stiffness.max())
    yield check_bound(
        *("slope", "too stiff", share, "<=", RARE, "share", source),
        worse="unsafe" if share > FEW else "warn",
        says=TOO_STIFF if most <= LEVEL * flight.stiffness_n_per_m else f"on slopes and textures {TOO_STIFF}",
        note=f"over {limit:.4g} N/m; up to {most:.4g} N/m, the median {np.median(stiffness):.4g} N/m",
        cure=_less_stiff(flight, limit, most),
    )


def _less_stiff(flight: Flight, limit: float, most: float) -> Cure:
    level = flight.stiffness_n_per_m
    if most <= LEVEL * level:
        return soften(flight, limit)
    ways: list[Cure] = []
    if flight.present_materials and not flight.settings.fitted:
        ways.append([FIT])
    if flight.settings.safety.coupling is None:
        ways.append([COUPLE])
    if level > 0 and not flight.present_materials:
        softer = level * limit / most
        ways += [soften(flight, softer)] if softer >= SOFTEST_N_PER_M else _rounder(flight, limit / level)
    if flight.settings.law_name != PROXY:
        ways.append(f"a force law that slopes do not stiffen, `render.use: {PROXY}`")
    if not ways:
        ways.append([flatten(flight, limit / most)])
    return join_cures(ways[0], *(part for way in ways[1:] for part in ("; or ", way)))


def _rounder(flight: Flight, times: float) -> list[Cure]:
    """Return the smoothing after which slopes make a penalty at most `times` as stiff as level ground, if any."""
    steepest = math.sqrt(max(times - 1, 0.0))
    change = round_off(flight, lambda relief: float(np.mean(slopes(relief) > steepest)) <= RARE)
    return [[change]] if change else []


def cliffs(flight: Flight) -> Iterator[Verdict]:
    """Check the share of a stroke in which a wall holds the hand up, and in which the force grows too fast."""
    # Up a slope s with friction m, a press P needs a push P (s + m) / (1 - m s) sideways, and none suffices where m s
    # is 1 or more. A force grows by K v T a tick at most for a proxy, whatever the slope, by K v T s for a penalty.
    strokes, steepest = flight.strokes, slopes(flight.surface.relief).max()
    held_up, sudden = float(np.mean(strokes.held_up)), float(np.mean(strokes.rise_n > flight.max_step_n))
    yield check_bound(
        *("slope", "a wall", held_up, "<=", WALLS, "share"),
        f"a hand pushes sideways with up to {SIDEWAYS:g} times its press, {flight.hand.press_n:g} N",
        note=f"of strokes; the steepest slope is {steepest:.3g}",
        says="much of a stroke is held up by walls",
        cure="" if held_up <= WALLS else gentler(flight, climbable(flight), RARE),
    )
    yield check_bound(
        *("slope", "too sudden", sudden, "<=", FEW, "share"),
        f"`safety.max_step_n`, {flight.max_step_n:.3g} N",
        note=f"of strokes; up to {strokes.rise_n.max():.3g} N in a tick",
        says="a stroke meets places where the force grows too fast",
        cure="" if sudden <= FEW else _steadier(flight),
    )


def climbable(flight: Flight) -> float:
    """Return the steepest slope that a hand climbs with this press, by the greatest static friction of the surface."""
    friction = max((present_material.static_friction for present_material in flight.present_materials), default=0.0)
    # On rougher materials a hand is held up by friction rather than by slopes.
    return max((SIDEWAYS - friction) / (1 + friction * SIDEWAYS), GENTLEST)


def _steadier(flight: Flight) -> Cure:
    stiffness = flight.stiffness_n_per_m
    per_tick_n = stiffness * flight.hand.speed_m_per_s * flight.period_s
    if flight.settings.law_name != PROXY and per_tick_n > 0:
        steepest = flight.max_step_n / per_tick_n
        if np.any(slopes(flight.surface.relief) > steepest):
            return gentler(flight, steepest, RARE)
    if flight.present_materials:
        return [FIT] if not flight.settings.fitted else "materials that differ less in stiffness (`tangible materials`)"
    return soften(flight, stiffness * flight.max_step_n / float(np.quantile(flight.strokes.rise_n, 1 - FEW)))


def clipping(flight: Flight) -> Iterator[Verdict]:
    """Check the share of the surface where the force on a hand that presses down exceeds the device's."""
    most_n, press_n = flight.max_force_n, flight.hand.press_n
    # Without friction it is P sqrt(1 + s^2) on a slope s, for a press P and a hand held sideways. Walls that push the
    # hand away more strongly than it pushes do not count: it does not stay there.
    stays = np.linalg.norm(flight.probes.force_n[:, :2], axis=1) <= SIDEWAYS * press_n
    strength_n = np.where(stays, flight.probes.strength_n, 0.0)
    share = float(np.mean(~(strength_n <= most_n)))
    cure: Cure = ""
    if share > FEW:
        required_n = float(np.quantile(strength_n, 1 - FEW, method="higher"))
        cure = [f"press with no more than {under(press_n * most_n / required_n)} N"]
        if most_n > press_n and flight.stiffness_n_per_m > 0:
            cure = [*gentler(flight, math.sqrt((most_n / press_n) ** 2 - 1), FEW), ", or ", *cure]
    yield check_bound(
        *("clipping", "the surface", share, "<=", FEW, "share", f"the greatest force, {most_n:g} N"),
        note=f"at a press of {press_n:g} N, up to {strength_n.max():.3g} N",
        says="the device is too weak for the steepest places",
        cure=cure,
    )


def contact(flight: Flight) -> Iterator[Verdict]:
    """Check the greatest force on first contact: a spring has none; another force law's force comes in one tick."""
    options = [name for name in type(flight.law).model_fields if name.startswith("force_") and name.endswith("_n")]
    greatest_n = float(flight.probes.onset_n.max())
    most_n = flight.max_step_n
    share = most_n / max(greatest_n, most_n)
    softer = [Change(f"render.{name}", under(getattr(flight.law, name) * share), "at most") for name in options]
    yield check_bound(
        *("contact", "the law", greatest_n, "<=", most_n, "N", "`safety.max_step_n`"),
        note="1 um under the surface",
        says="the force comes all at once where the hand touches the surface",
        cure=_softer(flight, softer, share),
    )


def _softer(flight: Flight, softer: Sequence[Change], share: float) -> Cure:
    """Return the cure for a force that steps on contact; a spring's force does so only where a texture lifts it."""
    if softer:
        return [*softer, ", or a force law that is a spring, `render.use: proxy`"]
    if flight.present_materials and not flight.settings.fitted:
        return [FIT]
    if flight.stiffness_n_per_m > 0:
        return soften(flight, share * flight.stiffness_n_per_m)
    return "a force law that is a spring, `render.use: proxy`"
