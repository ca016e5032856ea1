"""Simulated Falcons, put together."""

import numpy as np

from ...hand import VirtualHand
from ...paths import Stroke
from ..calibration import Calibration
from .body import Body
from .bus import Unit
from .chip import Chip
from .clock import Clock
from .processor import Processor
from .scripted_hand import ScriptedHand

TIP_KG, VISCOUS_N_S_PER_M, COULOMB_N = 0.2, 1.0, 0.4
"""Guesses: of the mechanics as they are felt at the tip."""


def simulated_falcon(clock: Clock, stroke: Stroke, lift_m: float, hand: VirtualHand, serial: str = "SIM0001") -> Unit:
    """A Falcon without firmware, held by a hand that homes it, and from the lift follows the stroke."""
    holder = ScriptedHand(stroke, lift_m, Calibration().frame(), hand.press_n / hand.stiffness_n_per_m)
    feel = (TIP_KG + hand.mass_kg, VISCOUS_N_S_PER_M, COULOMB_N, hand.stiffness_n_per_m, hand.damping_n_s_per_m)
    return Unit(Chip(Processor(Body(holder, np.array(feel))), clock), serial)
