"""Haptic textures: nanoseconds a point, and whether the spectrum peaks where the material says."""

import math
from functools import partial

import numpy as np

from tangible_core.data import Material
from tangible_core.materials.assignment import library
from tangible_render.haptic_textures import compile_textures, peak_wavelength_m, radial_spectrum, sample_tile, stroke
from tangible_render.haptic_textures.forces import STATE, along
from tangible_render.haptic_textures.spectrum import line_spectrum

from .figures import Figure, table
from .turns import in_turns

POINTS = 100_000
PERIOD_S, SPEED_M_PER_S, NORMAL_N = 0.001, 0.05, 1.0
GRAINS, PIXELS = 32, 512
"""Wavelengths a tile or a stroke spans, and samples along it."""
ROUNDS = 9


def measured() -> tuple[list[Figure], list[str]]:
    """Return the promises about texture models, and a row a material."""
    nanoseconds = _nanoseconds()
    peaks_m = {name: peak_m(material) for name, material in library().items()}
    off = {name: abs(peak / library()[name].grain_m - 1) for name, peak in peaks_m.items() if not math.isnan(peak)}
    slowest, furthest = max(nanoseconds, key=nanoseconds.__getitem__), max(off, key=off.__getitem__)
    figures = [
        Figure(
            f"texture model at a point, height, slope and force, each of {len(nanoseconds)} materials",
            "<= 100 ns, compiled without the interpreter's lock",
            f"{np.median(list(nanoseconds.values())):.0f} ns median, {nanoseconds[slowest]:.0f} ns at most ({slowest})",
            nanoseconds[slowest] <= 100,
        ),
        Figure(
            f"the spectrum's peak, {len(off)} materials that have one",
            "within 5 % of the stated wavelength",
            f"{100 * off[furthest]:.1f} % off at most ({furthest})",
            off[furthest] <= 0.05,
        ),
    ]
    rows = [
        (name, each.texture, f"{nanoseconds[name]:.0f}", f"{1e3 * each.grain_m:.2f}", _millimetres(peaks_m[name]))
        for name, each in library().items()
    ]
    return figures, table(("material", "model", "ns a point", "stated wavelength, mm", "peak, mm"), rows)


def _nanoseconds() -> dict[str, float]:
    """Return a point of each material: the median over calls that walk over many points."""
    names = list(library())
    textures = compile_textures(list(library().values()))
    way_m = np.outer(np.arange(POINTS) * PERIOD_S * SPEED_M_PER_S, (0.8, 0.6))
    felt = np.empty((POINTS, 5))
    calls = {
        name: partial(along, textures, row, np.zeros(STATE), way_m, PERIOD_S, NORMAL_N, felt)
        for row, name in enumerate(names)
    }
    return {name: 1e9 * each.seconds / POINTS for name, each in in_turns(calls, ROUNDS).items()}


def peak_m(material: Material) -> float:
    """Of the heights over a tile, or of the force of a stroke where there are none; NaN where neither varies."""
    side_m = GRAINS * material.grain_m
    if material.roughness_m > 0:
        return peak_wavelength_m(radial_spectrum(sample_tile(material, side_m, PIXELS), side_m))
    if material.texture != "stick-slip":
        return math.nan
    felt = stroke(material, side_m / PIXELS / PERIOD_S, NORMAL_N, 2 * side_m, PERIOD_S)
    settled_n = felt.force_n[PIXELS : 2 * PIXELS]
    return peak_wavelength_m(line_spectrum(settled_n, side_m))


def _millimetres(metres: float) -> str:
    return "none" if math.isnan(metres) else f"{1e3 * metres:.2f}"
