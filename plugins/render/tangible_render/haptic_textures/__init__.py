"""Fine textures for force laws: heights in metres and forces in newtons, independent of any picture's resolution."""

from .sample import Stroke, peak_wavelength_m, radial_spectrum, sample_tile, stroke
from .table import compile_textures

__all__ = ["Stroke", "compile_textures", "peak_wavelength_m", "radial_spectrum", "sample_tile", "stroke"]
