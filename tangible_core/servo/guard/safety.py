"""The limits of a force loop: their options, and the two arrays in which `guard` takes them."""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float64
from pydantic import Field

from ...data import DeviceSpec, TickFlag
from ...data.quantities import Quantities
from .. import limits
from . import layout as at

BRAKE_TIMES = 5
"""Greatest damping of the passivity controller, in units of the device's damping: above it, noise of the velocity can
be felt, and a sampled damper of 30 times the device's is itself unstable."""
# The period for which a device's greatest stiffness is stated, and which is assumed before one was measured.
NOMINAL_S = 0.001
DEBT_M = 0.001
"""Greatest debt of a loop, as the way over which the greatest force does that work: a force law that gives energy by
design is not damped for ever."""
SURFACE_M_PER_S, SURFACE_M = 0.0025, 0.01
"""Greatest work of a moving surface beyond what it takes back: that of the greatest force at this speed for long, and
over this way at once. More would be unbounded energy that the loop is not charged for."""
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Coupling(Quantities):
    """A spring and a damper between the device and the tool that touches the surface."""

    stiffness_n_per_m: Positive
    """Stiffness of the coupling, which is the greatest that can be felt."""
    damping_n_s_per_m: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    """Damping of the coupling; it must be less than the device's own damping."""


class Safety(Quantities):
    """Limits of the force on a hand, whatever the force law; the ticks in which each limit acted are reported."""

    max_force_n: Positive | None = None
    """Greatest force; the device's if null or larger than that."""
    max_step_n: Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)] = 0.5
    """Greatest change of force in a tick of 1 ms; in a shorter tick proportionally less, in a longer one no more."""
    ramp_s: Annotated[float, Field(ge=0, le=60, allow_inf_nan=False)] = 0.5
    """Time over which the force fades in: after the start, after a new scene, and whenever it was cut to zero."""
    stale_s: Annotated[float, Field(ge=0.002, le=1, allow_inf_nan=False)] = limits.STALE_SAMPLE_S
    """Age of the last position at which the force is cut to zero."""
    watchdog_s: Annotated[float, Field(ge=limits.MIN_WATCHDOG_S, le=limits.MAX_WATCHDOG_S, allow_inf_nan=False)] = (
        limits.WATCHDOG_S
    )
    """Time-out of the watchdog: time without a tick after which a loop that stands still is ended, and its device
    released; at least four periods. The loop's own process ends it after 70 % of that time, if it can."""
    stiffness_margin: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.8
    """Fraction of the stiffness limit that a force law may use. The rest compensates for the law's own damping, whose
    delay adds energy too."""
    delay_ticks: Annotated[int, Field(ge=0, le=at.MAX_DELAY)] = 0
    """Delay, in whole ticks, from reading a position to its force on the hand, beyond the tick itself."""
    friction_n: Positive | None = None
    """Coulomb friction of the handle, if it was measured: it limits the stiffness that coarse encoders allow."""
    passivity: Literal["off", "coupled", "strict"] = "coupled"
    """Passivity control. `strict`: the loop gives back no more energy than it took in. `coupled`: no more than that
    plus what the device's own damping dissipates, so that a stable spring is not altered. `off`: none."""
    coupling: Coupling | Literal["auto"] | None = None
    """Virtual coupling between force law and device: null for none, where the law's stiffness is known; `auto` for one
    that the device renders stably."""

    def arrays(
        self, spec: DeviceSpec, stiffness_n_per_m: float
    ) -> tuple[Float64[np.ndarray, "settings"], Float64[np.ndarray, "memory"]]:
        """Return the settings and the initial memory of `guard`; one memory lasts as long as the device is open.

        For another scene, take other settings, keep the memory and call `restart`.
        stiffness_n_per_m: stiffness of the force law by `find_stiffness`; 0 if the law has no spring.
        """
        settings, memory = np.zeros(at.SETTINGS), np.zeros(at.MEMORY)
        damping = effective_damping_n_s_per_m(spec)
        settings[at.MAX_FORCE_N] = min(self.max_force_n or np.inf, spec.max_force_n)
        settings[at.MAX_STEP_N] = self.max_step_n
        settings[at.RAMP_PER_S] = 1 / max(self.ramp_s, 1e-9)
        settings[at.STALE_S] = self.stale_s
        settings[at.STIFFNESS_TIMES_PERIOD] = self.stiffness_margin * stiffness_limit_n_per_m(
            damping, 1, self.delay_ticks
        )
        encoder = np.inf if self.friction_n is None else encoder_limit_n_per_m(self.friction_n, spec.resolution_m)
        settings[at.MAX_STIFFNESS] = min(spec.max_stiffness_n_per_m, self.stiffness_margin * encoder)
        settings[at.DELAY] = self.delay_ticks
        settings[at.BRAKE] = 0 if self.passivity == "off" else BRAKE_TIMES * damping
        settings[at.CREDIT] = self.stiffness_margin * damping if self.passivity == "coupled" else 0
        settings[at.MAX_DEBT_J] = settings[at.MAX_FORCE_N] * DEBT_M
        settings[at.SURFACE_W] = settings[at.MAX_FORCE_N] * SURFACE_M_PER_S
        settings[at.MAX_SURFACE_J] = memory[at.MAY_GIVE_J] = settings[at.MAX_FORCE_N] * SURFACE_M
        settings[at.STIFFNESS] = stiffness_n_per_m
        if self.coupling is not None:
            self._couple(settings, damping, stiffness_n_per_m)
        memory[[at.PLACE, at.TOOL]] = np.nan
        memory[[at.MEAN_S, at.MEAN_S2]] = NOMINAL_S, NOMINAL_S**2
        memory[at.GAIN] = gain(settings, NOMINAL_S)
        return settings, memory

    def _couple(self, settings: np.ndarray, damping_n_s_per_m: float, law_n_per_m: float) -> None:
        """Set the coupling: as configured, or half the stiffness and a quarter of the damping of the device."""
        most = min(settings[at.MAX_STIFFNESS], settings[at.STIFFNESS_TIMES_PERIOD] / NOMINAL_S)
        if isinstance(self.coupling, Coupling):
            stiffness, damping = self.coupling.stiffness_n_per_m, self.coupling.damping_n_s_per_m
        else:
            stiffness, damping = most / 2, damping_n_s_per_m / 4 / (1 + 2 * self.delay_ticks)
        settings[[at.COUPLING, at.COUPLING_DAMPING]] = stiffness, damping
        settings[at.COUPLING_LAW] = law_n_per_m or most
        settings[at.STIFFNESS] = 1 / (1 / stiffness + (1 / law_n_per_m if law_n_per_m else 0))


def gain(settings: Float64[np.ndarray, "settings"], period_s: float) -> float:
    """Return the gain by which a guard scales the law's force at this period; 1 if the law is soft enough."""
    stable = min(settings[at.STIFFNESS_TIMES_PERIOD] / period_s, settings[at.MAX_STIFFNESS])
    return float(stable / settings[at.STIFFNESS]) if settings[at.STIFFNESS] > stable else 1.0


def counts(memory: Float64[np.ndarray, "memory"]) -> dict[TickFlag, int]:
    """Return the number of ticks in which each flag of a guard was set, without flags that never were."""
    ticks = {TickFlag(1 << bit): int(memory[at.COUNTS + bit]) for bit in range(at.FLAGS)}
    return {flag: count for flag, count in ticks.items() if count}


def stiffness_limit_n_per_m(damping_n_s_per_m: float, period_s: float, delay_ticks: int = 0) -> float:
    """Return the stiffness of the stiffest sampled spring that is passive on a damped handle, K = 2 b / (T (1 + 2 d)).

    From Re{(1 - e^-jwT) K e^-jwdT} (T / 2) / (1 - cos wT) < b at all frequencies, the worst of which is 0.
    Source: Colgate & Schenkel, Passivity of a class of sampled-data systems, J. Robotic Systems 14, 1997, eq. 19.
    """
    return 2 * damping_n_s_per_m / (period_s * (1 + 2 * delay_ticks))


def encoder_limit_n_per_m(friction_n: float, resolution_m: float) -> float:
    """Return the stiffness above which Coulomb friction no longer hides the steps of the encoder, K = 2 f / Delta.

    Source: Abbott & Okamura, Effects of position quantization and sampling rate on virtual-wall passivity, IEEE
    Trans. Robotics 21(5), 2005.
    """
    return 2 * friction_n / resolution_m


def effective_damping_n_s_per_m(spec: DeviceSpec) -> float:
    """Return the device's damping, but at most the damping implied by its greatest stiffness at 1 kHz.

    Data sheets give the damping that a device can display, which is far more than the damping of its joints.
    """
    limit = spec.max_stiffness_n_per_m * NOMINAL_S / 2
    return min(spec.damping_n_s_per_m or limit, limit)
