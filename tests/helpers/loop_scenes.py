"""A level scene of a force loop, the force that its device holds, and the shared memory that is left."""

import os
from pathlib import Path

import numpy as np

from tangible_core import HapticSurface, load_method
from tangible_core.plugins.interfaces import Touch
from tangible_core.servo.ring import shared_folder
from waiting import until

SOFT_N_PER_M = 2.0
"""Stiffness that `Circling` and `Failing` hold even at a period of a second, so that no late tick scales it down."""


def proxy(height_m: float = 0.002, **options: float) -> Touch:
    level = HapticSurface.from_heights(np.full((16, 16), height_m, np.float32))
    return load_method("render", "proxy")(**options).touch(level)


def held_force(path: Path) -> float:
    """Return the force that the device holds; NaN if it was never open."""
    return float(until(path.read_text)) if path.exists() else float("nan")  # it is empty while it is written anew


def left_behind() -> set[Path]:
    return set(shared_folder().glob(f"tangible-{os.getpid()}-*"))
