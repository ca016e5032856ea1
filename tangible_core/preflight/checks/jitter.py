"""Checks of this machine's timing: lateness of ticks, and the duration of the force law's."""

from collections.abc import Iterator

from ...runtime.system.priority import ADVICE, NAME
from ..flight import PASSIVE, Flight
from ..timing import PERCENTILES
from ..verdict import Grade, Verdict, check_bound
from .cures import join_cures, soften

OVERRUNS = 0.001
"""Share of ticks that may be lost."""
HALF = 0.5
"""Share of a period for the force law; the device needs the rest."""
LATE = "this machine keeps time badly just now"
CALMER = "stop other work on this machine"


def lateness(flight: Flight) -> Iterator[Verdict]:
    """Check the lateness of ticks, the share of lost ones, and the stiffness that is stable with this lateness."""
    late, period_s = flight.lateness, flight.period_s
    cure = CALMER if late.real_time else f"{ADVICE}, and {CALMER}"
    figures = ", ".join(f"{name} {1e6 * late.at(percent):.0f}" for name, percent in PERCENTILES.items())
    yield check_bound(
        *("jitter", "lateness, p99.9", late.at(99.9), "<=", period_s, "s", "a period"),
        note=f"{figures} us; {NAME} {'permitted' if late.real_time else 'not permitted'}",
        says=LATE,
        cure=cure,
    )
    lost = late.overruns, "<=", OVERRUNS, "share", "ticks over a period late"
    yield check_bound("jitter", "overruns", *lost, says=LATE, cure=cure)
    if (stiffness := flight.felt_n_per_m(flight.stiffness_n_per_m)) == 0:
        return
    bound = flight.passive_n_per_m(max(0.0, late.at(99.9)))
    yield check_bound(
        *("jitter", "stiffness it leaves", stiffness, "<=", bound, "N/m", f"{PASSIVE}, T + p99.9"),
        worse=_worse(flight),
        says="the machine is too late for so stiff a force law",
        cure=cure if flight.spec.simulated else join_cures(f"{cure}; or ", soften(flight, bound)),
    )


def tick_cost(flight: Flight) -> Iterator[Verdict]:
    """Check the duration of a tick of the force law, p99, against half a period; unsafe if most take a whole one."""
    period_s, p50, p99 = flight.period_s, flight.cost.at(50), flight.cost.at(99)
    how, lighter = "in Python", "a force law of compiled kernels instead of Python"
    if flight.cost.compiled:
        how, lighter = (
            f"called from Python, {1e6 * flight.cost.kernel_s:.2f} us compiled",
            "a lighter force law (`render.use`)",
        )
    yield check_bound(
        *("tick", "the law, p99", p99, "<=", HALF * period_s, "s", "half a period"),
        worse=_worse(flight) if p50 > period_s else "warn",
        note=f"p50 {1e6 * p50:.1f} us {how}",
        says="the force law takes too long to compute",
        cure=f"{lighter}, or {CALMER}",
    )


def _worse(flight: Flight) -> Grade:
    """Return the grade of being late, which is unsafe only with a motor."""
    return "warn" if flight.spec.simulated else "unsafe"
