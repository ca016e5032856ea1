"""The sheet of a material: its surface, its spectrum, and the force of a stroke."""
# pyright: reportUnknownMemberType=false
# (matplotlib leaves its keywords without types)

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter, NullLocator

from tangible_core.data import HapticSurface, Material
from tangible_render.haptic_textures import Stroke, radial_spectrum, sample_tile, stroke
from tangible_render.haptic_textures.sample import Spectrum, line_spectrum

from .drawing.sheet import write_sheet
from .panels import Panel
from .panels.relief import draw_surface
from .style import INK, OKABE_ITO

HEIGHT, FORCE, STATED = OKABE_ITO[0], OKABE_ITO[5], OKABE_ITO[2]
FLOOR_DB, HEADROOM_DB = -50.0, 8.0
MARKS_MM = (0.1, 0.2, 0.5, 1, 2, 5, 10)


def draw_spectrum(axes: Axes, material: Material, spectra: dict[str, Spectrum]) -> str:
    """Draw power over wavelength, of the heights in all directions and of the friction, and the stated wavelength."""
    for (name, (wavelength_m, power)), colour in zip(spectra.items(), (HEIGHT, FORCE), strict=False):
        level_db = 10 * np.log10(np.maximum(power / max(power.max(), 1e-300), 1e-9))
        axes.plot(1000 * wavelength_m, level_db, color=colour, linewidth=1.2, label=name)
    axes.set(xscale="log", xlim=(10, 0.1), ylim=(FLOOR_DB, HEADROOM_DB))
    axes.set_xlabel("wavelength [mm]", loc="left")
    axes.set_ylabel("power per octave [dB]")
    axes.set_xticks(MARKS_MM, [f"{mark:g}" for mark in MARKS_MM])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    if not spectra:
        axes.text(0.5, 0.5, "no waves", transform=axes.transAxes, ha="center", color=INK)
        return "Spectrum: none"
    stated_mm = 1000 * material.grain_m
    axes.axvline(stated_mm, color=STATED, linewidth=1, linestyle=(0, (4, 3)), label=f"stated, {stated_mm:g} mm")
    axes.legend(ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, handlelength=1.6)
    return "Spectrum"


def draw_stroke(axes: Axes, material: Material, stroke: Stroke, conditions: str) -> str:
    """Draw the lateral force against the stroke along its path, and the height under it."""
    axes.set_axis_off()
    upper, lower = axes.inset_axes((0, 0.42, 1, 0.58)), axes.inset_axes((0, 0, 1, 0.34))
    lower.sharex(upper)
    way_mm, drag_n = 1000 * stroke.way_m, -stroke.force_n
    upper.axhline(0, color=INK, linewidth=0.5)
    upper.plot(way_mm, drag_n, color=FORCE, linewidth=0.9)
    upper.set(ylabel="force [N]", ylim=(min(0.0, float(drag_n.min())) * 1.1, max(0.1, float(drag_n.max())) * 1.1))
    upper.tick_params(labelbottom=False)
    lower.axhline(0, color=INK, linewidth=0.5)
    lower.plot(way_mm, 1e6 * stroke.height_m, color=HEIGHT, linewidth=0.9)
    most_um = max(10.0, 1.15e6 * float(np.abs(stroke.height_m).max()))
    lower.set(ylabel="height [\N{MICRO SIGN}m]", ylim=(-most_um, most_um))
    lower.set_xlabel("way [mm]", loc="left")
    upper.margins(x=0)
    return f"Force against a stroke, {conditions}: {drag_n.mean():.2f} N on average"


# The width of the drawn surface, the same for all materials, so that grains can be compared.
WIDTH_M = 0.012
GRAINS, PIXELS = 96, 480  # the grains and pixels along a side of the tile from which the spectrum is computed
SPEED_M_PER_S, NORMAL_N, PERIOD_S, LENGTH_M = 0.05, 1.0, 0.001, 0.02
"""The speed, normal force, sampling period and length of the drawn stroke."""
FINE = 0.02  # the step of the slow stroke from which the friction's spectrum is computed, grains a tick

MATERIAL_PANELS = (
    Panel(draw_surface, {"relief"}, aspect=1.45, right_in=0.85),
    Panel(draw_spectrum, {"material", "spectra"}, aspect=1.3, left_in=0.65, bottom_in=0.55),
    Panel(draw_stroke, {"material", "stroke", "conditions"}, aspect=4.5, left_in=0.65, bottom_in=0.55),
)


def draw_material(path: Path, material: Material) -> None:
    """Draw a material, and a stroke at 50 mm/s under 1 N, from rest, at 1 kHz, as a PNG. Raises: OutputError."""
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
    picture_spectrum: dict[str, Spectrum] = {}
    if material.roughness_m:
        width_m = GRAINS * material.grain_m
        picture_spectrum["heights"] = radial_spectrum(sample_tile(material, width_m, PIXELS), width_m)
    if material.texture == "stick-slip":
        way_m = max(3 * LENGTH_M, GRAINS * material.grain_m)
        step_m = max(FINE * material.grain_m, way_m / 2**16)
        slow = stroke(replace(material, roughness_m=0.0), step_m / PERIOD_S, NORMAL_N, way_m, PERIOD_S)
        sliding = slow.force_n[len(slow.force_n) // 4 :]
        picture_spectrum["friction"] = line_spectrum(sliding, len(sliding) * step_m)
    return picture_spectrum
