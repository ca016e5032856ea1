"""Checks of the device and of this machine: damping, friction, reach; lateness of ticks, duration of the law's."""

from collections.abc import Iterator

from ...runtime.system.priority import ADVICE, NAME
from ..flight import PASSIVE, Flight
from ..timing import PERCENTILES
from ..verdict import Grade, Verdict, check_bound, under
from .cures import flatten, join_cures, narrow, soften

REACH = "the device's workspace"


def damping(flight: Flight) -> Iterator[Verdict]:
    """Check that the device's damping, on which the limit of stiffness rests, is plausible."""
    table, limit = flight.spec.damping_n_s_per_m, flight.damping_n_s_per_m
    # Makers' tables give the damping that a device can display: more than its greatest stiffness at 1 kHz implies.
    sure = flight.spec.simulated or 0 < table <= limit
    note = "" if table == limit else f"{table:g} N s/m stated; its stiffness at 1 kHz implies no more than this"
    cure = "" if sure else "a guess: start at half the stiffness, and raise it for as long as nothing buzzes"
    says = "" if sure else "how well the device damps is a guess"
    source = "simulated" if flight.spec.simulated else "the device's specification"
    yield Verdict(
        *("device", "damping", "ok" if sure else "warn", limit, "N s/m"), source=source, note=note, cure=cure, says=says
    )


def friction(flight: Flight) -> Iterator[Verdict]:
    """Check that the handle's friction is known, which keeps the steps of its encoders from buzzing."""
    friction_n = flight.settings.safety.friction_n
    sure = flight.spec.simulated or friction_n is not None
    cure = "" if sure else "unknown: measure the force at which the handle starts to move, `safety.friction_n: ...`"
    source = "simulated" if flight.spec.simulated else "`safety.friction_n`" if sure else ""
    says = "" if sure else "the friction of the device's handle is unknown"
    yield Verdict(
        *("device", "friction", "ok" if sure else "warn", friction_n or 0.0, "N"), source=source, cure=cure, says=says
    )


def workspace(flight: Flight) -> Iterator[Verdict]:
    """Check width, length and height of the surface against the device's reach along x, y and z."""
    reach_x, reach_y, reach_z = flight.spec.workspace_m
    width_m, length_m = flight.surface.extent_m
    for of, size_m, reach_m in (("width", width_m, reach_x), ("length", length_m, reach_y)):
        narrower = under(width_m * reach_m / size_m)
        yield check_bound(
            *("workspace", of, size_m, "<=", reach_m, "m", REACH),
            says=f"the surface has more {of} than the device reaches",
            cure=[narrow(flight, narrower), "; or the borders cannot be reached"],
        )
    height_m = float(flight.surface.height_m.max())
    yield check_bound(
        *("workspace", "height", height_m, "<=", reach_z, "m", REACH),
        says="the surface is higher than the device reaches",
        cure=[flatten(flight, reach_z / max(height_m, reach_z))],
    )


OVERRUNS = 0.001
HALF = 0.5  # share of a period for the force law; the device needs the rest
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
    lost_ticks = late.overruns, "<=", OVERRUNS, "share", "ticks over a period late"
    yield check_bound("jitter", "overruns", *lost_ticks, says=LATE, cure=cure)
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
    if flight.cost.is_compiled:
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
