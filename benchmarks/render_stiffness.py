"""How stiff each spring can be before a simulated handle starts to shake, beside the bound of the literature."""

from collections.abc import Iterator

from tangible_bench.metrics.stability import HANDLE
from tangible_bench.tasks.render import DELAYS, limits
from tangible_core.plugins.interfaces import ForceRenderer
from tangible_core.servo.guard.safety import stiffness_limit_n_per_m
from tangible_core.testing.synthetic.scenes import plane
from tangible_render.force_shading import ForceShading
from tangible_render.penalty import Penalty
from tangible_render.penalty_gradient import PenaltyGradient
from tangible_render.proxy import Proxy

from .figures import Figure

SPRINGS: tuple[ForceRenderer, ...] = (Proxy(), Penalty(), PenaltyGradient(), ForceShading())


def figures() -> Iterator[Figure]:
    """Yield a row for each delay: the limits of all springs lie within the bound's 5 %."""
    found = [limits(each, plane().surface) for each in SPRINGS]
    for delay in DELAYS:
        bound = stiffness_limit_n_per_m(HANDLE.damping_n_s_per_m, HANDLE.period_s, delay)
        limits_n_per_m = [each[f"limit{delay}"] for each in found]
        worst = max(abs(limit / bound - 1) for limit in limits_n_per_m)
        yield Figure(
            f"simulated stiffness limit, {HANDLE.mass_kg:g} kg, {HANDLE.damping_n_s_per_m:g} N s/m, {delay} ticks late",
            f"{bound:.0f} N/m within 5 %",
            f"{min(limits_n_per_m):.0f} to {max(limits_n_per_m):.0f} N/m, at most {100 * worst:.1f} % off "
            f"({len(found)} springs)",
            worst <= 0.05,
        )
