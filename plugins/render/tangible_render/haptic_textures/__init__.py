"""Fine textures for force laws: heights in metres and forces in newtons, independent of any picture's resolution.

Every model is one row of numbers for each material: plane waves, which are its heights (`waves`), a linear drag, and
stick-slip friction (`table`). The compiled functions `heights.texture_height` and `forces.texture_force` evaluate a row
at a point.
"""

from .sample import Stroke, sample_tile, stroke
from .spectrum import peak_wavelength_m, radial_spectrum
from .table import compile_textures

__all__ = ["Stroke", "compile_textures", "peak_wavelength_m", "radial_spectrum", "sample_tile", "stroke"]
