"""How much each cue counts: fitted to the regions that people drew, by `python -m benchmarks.regions_fit`.

The photographs are 40 of the 200 for training in the Berkeley data set (Arbelaez, Maire, Fowlkes & Malik, IEEE TPAMI
33, 2011), each divided by about five people. Both fits are logistic regressions: of the share of people who drew a
border at a cell, and of the share who keep two regions apart, over all pairs that a joining looks at.
"""

from typing import NamedTuple

import numpy as np


class Weights(NamedTuple):
    """The weights of one cue in windows of three widths, narrow to wide; brightness has one width."""

    at_cells: tuple[float, ...]
    """In the map of strengths that is flooded."""
    at_borders: tuple[float, ...]
    """In the strength of a border."""


CUES = {
    "brightness, fine": Weights((5.70,), (5.78,)),
    "brightness": Weights((2.50, 1.58, 0.65), (0.00, 1.25, 1.24)),
    "red": Weights((2.66, 0.40, 0.00), (0.38, 1.90, 0.16)),
    "yellow": Weights((2.39, 0.14, 1.32), (0.00, 0.00, 1.95)),
    "roughness": Weights((0.41, 1.35, 1.97), (0.47, 0.36, 0.64)),
    "direction": Weights((1.87, 2.88, 1.58), (3.79, 0.00, 4.13)),
}
"""The weights of the square root of each change."""
TERMS = (1.0, 0.540, 1.529, 0.199, 0.280, -0.186)
"""The weights of the terms of a border that `joining` measures, in its order."""
CONSTANT = -5.592
"""The cost of a border whose terms are all 0; at a cost of 0 half of the people keep two regions apart."""


def cell_weights() -> np.ndarray:
    """Return the weights of all cues in the map of strengths: float32 (cues,)."""
    return np.array([each for cue in CUES.values() for each in cue.at_cells], np.float32)


def border_weights() -> np.ndarray:
    """Return the weights of all cues in the strength of a border: float32 (cues,)."""
    return np.array([each for cue in CUES.values() for each in cue.at_borders], np.float32)
