"""Materials of one effect each, level ground covered by them, and a stroke: for tests of force laws with materials."""

from dataclasses import replace

import numpy as np

from tangible_core.data import HapticSurface, Material
from tangible_core.materials.assignment import library

PUSHING = ("penalty", "penalty-gradient", "force-shading", "grey-level")
LATERAL = ("lateral-gradient", "lateral-shape", "tangible-mask")
K = 600.0
PLAIN = Material("bare", K, 0.0, 0.0, 0.0)
STICKY = replace(PLAIN, name="sticky", static_friction=0.8, dynamic_friction=0.5)
GRAINY = replace(PLAIN, name="grainy", roughness_m=1e-4)
RUBBER = replace(library()["rubber"], stiffness_n_per_m=K, roughness_m=0.0, damping_n_s_per_m=0.0)


def cover(surface: HapticSurface, material: Material) -> HapticSurface:
    return HapticSurface(surface.relief, np.zeros(surface.height_m.shape, np.int32), (material,))


def level(material: Material) -> HapticSurface:
    return cover(HapticSurface.from_heights(np.full((64, 64), 0.01)), material)


def stroke(length_m: float = 0.01, z: float = 0.009, ticks: int = 5000) -> np.ndarray:
    x = np.linspace(0, length_m, ticks)
    return np.column_stack([x, 0 * x, np.full_like(x, z)])
