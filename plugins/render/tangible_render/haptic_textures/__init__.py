"""Fine textures that a force renderer feels: heights and forces in metres and newtons, of no picture's resolution.

Every model comes down to the same numbers, one row of them a material: plane waves, which are its heights (`waves`), a
linear drag, and a friction that sticks and slips (`table`). `heights.texture_height` and `forces.texture_force` read a
row at a point, compiled.
"""

from .sample import sample_tile
from .spectrum import peak_wavelength_m, radial_spectrum
from .stroke import Stroke, stroke
from .table import compile_textures

__all__ = ["Stroke", "compile_textures", "peak_wavelength_m", "radial_spectrum", "sample_tile", "stroke"]
