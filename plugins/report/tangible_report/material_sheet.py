"""The sheet of a material: its surface, its spectrum, and the force of a stroke."""

from dataclasses import replace
from pathlib import Path

from tangible_core.data import HapticSurface, Material
from tangible_render.haptic_textures import radial_spectrum, sample_tile, stroke
from tangible_render.haptic_textures.spectrum import Spectrum, line_spectrum

from .drawing.sheet import write_sheet
from .panels import Panel
from .panels.relief import draw_surface
from .panels.texture import draw_spectrum, draw_stroke

WIDTH_M = 0.012
"""The width of the drawn surface, the same for all materials, so that grains can be compared."""
GRAINS, PIXELS = 96, 480
"""The grains and pixels along a side of the tile from which the spectrum is computed."""
SPEED_M_PER_S, NORMAL_N, PERIOD_S, LENGTH_M = 0.05, 1.0, 0.001, 0.02
"""The speed, normal force, sampling period and length of the drawn stroke."""
FINE = 0.02
"""The step of the slow stroke from which the friction's spectrum is computed, grains a tick."""

MATERIAL_PANELS = (
    Panel(draw_surface, {"relief"}, aspect=1.45, right_in=0.85),
    Panel(draw_spectrum, {"material", "spectra"}, aspect=1.3, left_in=0.65, bottom_in=0.55),
    Panel(draw_stroke, {"material", "stroke", "conditions"}, aspect=4.5, left_in=0.65, bottom_in=0.55),
)


def draw_material(path: Path, material: Material) -> None:
    """Draw a material as a PNG, whole or not at all.

    The stroke is at 50 mm/s under 1 N, from rest, at 1 kHz. Raises: OutputError if the file cannot be written.
    """
    tile = sample_tile(material, WIDTH_M, 240)
    across_deg = (material.direction_deg + 90) % 180
    across = " across its lines" if material.anisotropy else ""
    run = {
        "material": material,
        "relief": HapticSurface.from_heights(tile - tile.min(), WIDTH_M).relief,
        "spectra": spectra(material),
        "stroke": stroke(material, SPEED_M_PER_S, NORMAL_N, LENGTH_M, PERIOD_S, across_deg),
        "conditions": f"{1000 * SPEED_M_PER_S:g} mm/s{across} under {NORMAL_N:g} N",
    }
    write_sheet(path, run, f"{material.name}: {material.texture}", MATERIAL_PANELS)


def spectra(material: Material) -> dict[str, Spectrum]:
    """Return the spectra of the heights, if there are any, and of the friction, if it has a wavelength."""
    spectrum_of: dict[str, Spectrum] = {}
    if material.roughness_m:
        width_m = GRAINS * material.grain_m
        spectrum_of["heights"] = radial_spectrum(sample_tile(material, width_m, PIXELS), width_m)
    if material.texture == "stick-slip":
        way_m = max(3 * LENGTH_M, GRAINS * material.grain_m)
        step_m = max(FINE * material.grain_m, way_m / 2**16)
        slow = stroke(replace(material, roughness_m=0.0), step_m / PERIOD_S, NORMAL_N, way_m, PERIOD_S)
        sliding = slow.force_n[len(slow.force_n) // 4 :]
        spectrum_of["friction"] = line_spectrum(sliding, len(sliding) * step_m)
    return spectrum_of
