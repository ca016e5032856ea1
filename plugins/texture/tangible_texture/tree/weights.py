"""How much each cue counts: fitted to the regions that people drew, by `python -m benchmarks.regions_fit`."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64


class Cue(NamedTuple):
    """The weights of the square root of one cue, in windows narrow to wide; of a network's borders, in two powers."""

    in_map: tuple[float, ...]
    on_borders: tuple[float, ...]


class Weights(NamedTuple):
    """All weights of one fit."""

    cues: Mapping[str, Cue]
    # The weights of the terms of a border that `joining` measures, in its order.
    border_terms: tuple[float, ...]
    # The cost of a border whose terms are all 0; at a cost of 0 half of the people keep two regions apart.
    constant: float

    @property
    def at_cells(self) -> Float32[np.ndarray, "cues"]:
        """The weights of all cues in the map of strengths."""
        return np.array([weight for cue in self.cues.values() for weight in cue.in_map], np.float32)

    @property
    def at_borders(self) -> Float32[np.ndarray, "cues"]:
        """The weights of all cues in the strength of a border."""
        return np.array([weight for cue in self.cues.values() for weight in cue.on_borders], np.float32)

    @property
    def terms(self) -> Float64[np.ndarray, "terms"]:
        """The weights of the terms of a border."""
        return np.array(self.border_terms)


WITHOUT = Weights(
    {
        "brightness, fine": Cue((5.70,), (5.78,)),
        "brightness": Cue((2.50, 1.58, 0.65), (0.00, 1.25, 1.24)),
        "red": Cue((2.66, 0.40, 0.00), (0.38, 1.90, 0.16)),
        "yellow": Cue((2.39, 0.14, 1.32), (0.00, 0.00, 1.95)),
        "roughness": Cue((0.41, 1.35, 1.97), (0.47, 0.36, 0.64)),
        "direction": Cue((1.87, 2.88, 1.58), (3.79, 0.00, 4.13)),
    },
    (1.0, 0.540, 1.529, 0.199, 0.280, -0.186),
    -5.592,
)
WITH_BORDERS = Weights(
    {
        "brightness, fine": Cue((0.73,), (0.00,)),
        "brightness": Cue((0.90, 0.00, 1.56), (0.00, 0.00, 2.71)),
        "red": Cue((1.17, 0.00, 0.49), (0.00, 0.00, 2.24)),
        "yellow": Cue((1.51, 0.00, 0.85), (0.00, 0.12, 0.61)),
        "roughness": Cue((0.64, 1.38, 0.97), (1.28, 0.00, 0.34)),
        "direction": Cue((0.40, 0.52, 1.81), (0.00, 0.00, 2.25)),
        "borders that a network sees": Cue((4.08, 0.00), (2.20, 1.75)),
    },
    (1.0, 0.691, 0.823, 0.232, 0.174, -0.125),
    -4.309,
)
