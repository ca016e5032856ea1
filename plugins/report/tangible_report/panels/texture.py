"""The panels of a material's fine texture: its spectrum, and the force of a stroke over it."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter, NullLocator

from tangible_core.data import Material
from tangible_render.haptic_textures import Stroke
from tangible_render.haptic_textures.spectrum import Spectrum

from ..style import INK, OKABE_ITO

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
