"""Checks of stiffness and damping against what this loop and this device render stably."""

import math
from collections.abc import Iterator

import numpy as np

from ..flight import PASSIVE, Ceiling, Flight
from ..verdict import FEW, Change, Cure, Verdict, check_bound, under
from .cures import COUPLE, FIT, SOFTEST_N_PER_M, soften, soften_materials

STIFFER = "stiffer than the device renders stably"
TOO_STIFF = f"the force law is {STIFFER}"
CLEAN_N_PER_M = 900.0
CLEAN = "Choi & Tan 2004: textures are clean up to 0.3 to 0.9 N/mm"
STEP_SHARE = 0.07
STEP = "Pang, Tan & Durlach 1991: a step of 7 % is felt"


def law_stiffness(flight: Flight) -> Iterator[Verdict]:
    """Check the force law's stiffness on level ground against each limit."""
    if flight.stiffness_n_per_m == 0:
        yield Verdict("stiffness", "the law", "ok", 0.0, "N/m", note="not a spring; see `contact`")
        return
    n_per_m = flight.felt_n_per_m(flight.stiffness_n_per_m)
    if n_per_m < SOFTEST_N_PER_M:
        source = "a hand that explores with 1 N sinks 20 mm"
        yield check_bound(
            *("stiffness", "the law", n_per_m, ">=", SOFTEST_N_PER_M, "N/m", source),
            says="the force law is so soft that a hand goes through the surface",
            cure="a stiffer force law, such as by `render.stiffness_n_per_m`",
        )
    for ceiling in flight.ceilings:
        cure = soften(flight, ceiling.most_n_per_m)
        yield _under_ceiling("the law", flight.felt_n_per_m(flight.stiffness_n_per_m), ceiling, cure)


def material_stiffness(flight: Flight) -> Iterator[Verdict]:
    """Check each material's stiffness against the lowest limit, or that of a clean texture if it is lower."""
    ceiling = flight.ceilings[0]
    for material in flight.present_materials:
        stiffness = flight.felt_n_per_m(material.stiffness_n_per_m)
        if material.roughness_m > 0 and CLEAN_N_PER_M <= ceiling.most_n_per_m >= stiffness:
            cure = f"in a file for `materials.library`, `{material.name}: {{stiffness_n_per_m: {CLEAN_N_PER_M:g}}}`"
            says = f"the texture of {material.name} is not clean on ground so stiff"
            yield check_bound(
                "stiffness", material.name, stiffness, "<=", CLEAN_N_PER_M, "N/m", CLEAN, cure=cure, says=says
            )
        else:
            cure = soften_materials(flight, [material], ceiling.most_n_per_m)
            yield _under_ceiling(material.name, stiffness, ceiling, cure)


def _under_ceiling(of: str, stiffness: float, ceiling: Ceiling, cure: Cure) -> Verdict:
    limit, share, source = ceiling
    name = "the force law" if of == "the law" else of
    return check_bound(
        *("stiffness", of, stiffness, "<=", ceiling.most_n_per_m, "N/m", source),
        worse="unsafe" if not stiffness <= limit else "warn",
        note="" if share == 1 else f"{100 * share:g} % of {limit:.4g} N/m",
        says=f"{name} is {'so stiff that it is softened' if stiffness <= limit else STIFFER}",
        cure=cure,
    )


def law_damping(flight: Flight) -> Iterator[Verdict]:
    """Check the force law's damping against what its stiffness leaves of the device's: b > K T (1 + 2 d) / 2 + B."""
    law_b = np.array([flight.felt_damping_n_s_per_m(law) for law in flight.probes.damping_n_s_per_m.clip(0).tolist()])
    level = np.clip(flight.probes.stiffness_n_per_m, 0, flight.stiffness_n_per_m)  # `slope` checks that of slopes
    level_n_per_m = np.array([flight.felt_n_per_m(law) for law in level.tolist()])
    tick_s = flight.period_s * (1 + 2 * flight.settings.safety.delay_ticks) / 2
    rest = np.maximum(0.0, flight.damping_n_s_per_m - tick_s * level_n_per_m)
    # A few places are left out: where a proxy leaps, it is not damping.
    worst = int(np.argsort(law_b - rest, kind="stable")[math.ceil((1 - FEW) * (law_b.size - 1))])
    damping, most = max(0.0, round(float(law_b[worst]), 3)), float(rest[worst])
    yield check_bound(
        *("damping", "the law", damping, "<=", most, "N s/m", PASSIVE),
        note=f"b = {flight.damping_n_s_per_m:.3g} N s/m",
        says="the force law is damped more than the device can render",
        cure=_less_damping(flight, damping, most),
    )


def _less_damping(flight: Flight, damping: float, most: float) -> Cure:
    own, materials = getattr(flight.law, "damping_n_s_per_m", None), flight.present_materials
    if own and not (materials and type(flight.law).renders_materials):
        return [Change("render.damping_n_s_per_m", under(own * most / damping) if most else "0", "at most")]
    if materials and not flight.settings.fitted:
        return [FIT]
    if flight.settings.safety.coupling is None:
        return [COUPLE]
    return "less `damping_n_s_per_m` of the materials, in a file for `materials.library`"


def quantisation(flight: Flight) -> Iterator[Verdict]:
    """Check the step of the force where the device's position steps."""
    felt_n, step_m = STEP_SHARE * flight.hand.press_n, flight.spec.resolution_m
    if (stiffness := flight.felt_n_per_m(flight.stiffness_n_per_m)) > 0:
        yield check_bound(
            *("quantisation", "a step of position", stiffness * step_m, "<=", felt_n, "N", STEP),
            says="the steps of the device's encoders are felt",
            cure=soften(flight, felt_n / step_m),
        )
