"""Simulated Falcons, and a synthetic firmware image for them."""

import struct

import numpy as np

from ...hand import VirtualHand
from ...paths import Stroke
from ..calibration import Calibration
from ..usb.image import KEY, RESERVED_WORDS
from .body import Body
from .bus import Unit
from .chip import Chip
from .clock import SimulatedClock
from .processor import Processor
from .scripted_hand import ScriptedHand

TIP_KG, VISCOUS_N_S_PER_M, COULOMB_N = 0.2, 1.0, 0.4
"""Mass and friction of the mechanics at the tip, all guessed."""
IMAGE_BLOCKS = ((1821, 0x3F8002), (120, 0x3F8E3D), (168, 0x93A2), (2, 0x3F8000))
"""Length in words and destination of each block; together half as long as in a real image."""


def simulated_falcon(
    clock: SimulatedClock, stroke: Stroke, lift_m: float, hand: VirtualHand, serial: str = "SIM0001"
) -> Unit:
    """Return a Falcon without firmware, held by a hand that homes it, then starts above the path and follows it."""
    holder = ScriptedHand(stroke, lift_m, Calibration().frame(), hand.press_n / hand.stiffness_n_per_m)
    feel = (TIP_KG + hand.mass_kg, VISCOUS_N_S_PER_M, COULOMB_N, hand.stiffness_n_per_m, hand.damping_n_s_per_m)
    return Unit(Chip(Processor(Body(holder, np.array(feel))), clock), serial)


def synthetic_image(seed: int = 0) -> bytes:
    """Return the boot stream of an image with random content, in the structure of a real one."""
    numbers = np.random.default_rng(seed)
    words = [KEY, *[0] * RESERVED_WORDS, 0x003F, 0x8002]
    for length, destination in IMAGE_BLOCKS:
        words += [length, destination >> 16, destination & 0xFFFF, *numbers.integers(0, 1 << 16, length).tolist()]
    return struct.pack(f"<{len(words) + 1}H", *words, 0)
