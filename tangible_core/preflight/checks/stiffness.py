"""How stiff and how damped a wall this loop and this device hold."""

from collections.abc import Iterator

import numpy as np

from ..flight import PASSIVE, Ceiling, Flight
from ..verdict import FEW, Verdict, held, under
from .cures import soften, soften_material

CLEAN_N_PER_M = 900.0
CLEAN = "Choi & Tan 2004: textures are clean up to 0.3 to 0.9 N/mm"
STEP_SHARE = 0.07
STEP = "Pang, Tan & Durlach 1991: a step of 7 % is felt"


def law_stiffness(flight: Flight) -> Iterator[Verdict]:
    """The law's stiffness on level ground against each limit."""
    if flight.stiffness_n_per_m == 0:
        yield Verdict("stiffness", "the law", "ok", 0.0, "N/m", note="not a spring; see `contact`")
        return
    for ceiling in flight.ceilings:
        cure = soften(flight, ceiling.most_n_per_m)
        yield _under_ceiling("the law", flight.felt_n_per_m(flight.stiffness_n_per_m), ceiling, cure)


def material_stiffness(flight: Flight) -> Iterator[Verdict]:
    """Each material's stiffness against the lowest limit; or against what lets a texture be clean, if that is lower."""
    ceiling = flight.ceilings[0]
    for material in flight.met:
        stiffness = flight.felt_n_per_m(material.stiffness_n_per_m)
        if material.roughness_m > 0 and CLEAN_N_PER_M <= ceiling.most_n_per_m >= stiffness:
            cure = soften_material([material], CLEAN_N_PER_M)
            yield held("stiffness", material.name, stiffness, "<=", CLEAN_N_PER_M, "N/m", CLEAN, cure=cure)
        else:
            cure = soften_material([material], ceiling.most_n_per_m)
            yield _under_ceiling(material.name, stiffness, ceiling, cure)


def _under_ceiling(of: str, stiffness: float, ceiling: Ceiling, cure: str) -> Verdict:
    """Over what the guard leaves to a law, it is softened: it feels softer than it says. Over the limit it may buzz."""
    limit, share, source = ceiling
    return held(
        *("stiffness", of, stiffness, "<=", ceiling.most_n_per_m, "N/m", source),
        worse="unsafe" if not stiffness <= limit else "warn",
        note="" if share == 1 else f"{100 * share:g} % of {limit:.4g} N/m",
        cure=cure,
    )


def law_damping(flight: Flight) -> Iterator[Verdict]:
    """The law's damping against what its stiffness leaves of the device's own: b > K T (1 + 2 d) / 2 + B."""
    felt = np.quantile(flight.probes.damping_n_s_per_m, 1 - FEW)  # where a proxy leaps, it is no damping
    found = max(0.0, round(float(felt), 3))
    tick_s = flight.period_s * (1 + 2 * flight.safety.delay_ticks) / 2
    left = max(0.0, flight.damping_n_s_per_m - tick_s * flight.stiffness_n_per_m)
    own = "damping_n_s_per_m" in type(flight.law).model_fields and not flight.met
    less = f"`render.damping_n_s_per_m: {under(left)}`" if own else "less `damping_n_s_per_m` of the materials"
    yield held(
        *("damping", "the law", found, "<=", left, "N s/m", PASSIVE),
        note=f"b = {flight.damping_n_s_per_m:.3g} N s/m",
        cure=less,
    )


def quantisation(flight: Flight) -> Iterator[Verdict]:
    """By how much the force steps where the device's position does."""
    felt_n, step_m = STEP_SHARE * flight.hand.press_n, flight.spec.resolution_m
    if (stiffness := flight.felt_n_per_m(flight.stiffness_n_per_m)) > 0:
        yield held(
            *("quantisation", "a step of position", stiffness * step_m, "<=", felt_n, "N", STEP),
            cure=soften(flight, felt_n / step_m),
        )
