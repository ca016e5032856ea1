"""The surface of a page to send: coefficients of a spline in whole steps, on a grid that is drawn at once."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float32, Int32, UInt16

from tangible_core.data import HapticSurface, Relief, Work
from tangible_core.scene import middle_pixels, reduced_map, reduced_shape
from tangible_render.surface.coefficients import spline_coefficients
from tangible_render.surface.dequantise import dequantise

MAX_CELLS = 400_000
"""The most cells: software draws them in a fraction of a second, and the page is one for old phones too."""
STEPS_M = (1e-6, 2e-6, 4e-6)
"""Steps of heights: half of one is what a height is off by. Fingers feel no height below 10 um on a smooth surface."""
COARSER = 1.25
"""The factor from one size of cells to the next."""
MAX_COARSER = 12


@dataclass(frozen=True)
class SentSurface:
    """A surface in whole steps of height."""

    numbers: UInt16[np.ndarray, "h4 w4"]
    """Coefficients of the spline: `low_m` plus this number of steps."""
    low_m: float
    step_m: float
    labels: Int32[np.ndarray, "h w"] | None
    extent_m: tuple[float, float]

    @property
    def coefficients(self) -> Float32[np.ndarray, "h4 w4"]:
        """The coefficients in metres, the same bits as in the page."""
        return (self.low_m + self.step_m * self.numbers.astype(np.float64)).astype(np.float32)

    @property
    def height_m(self) -> Float32[np.ndarray, "h w"]:
        """The heights at the cells' centres."""
        whole = self.coefficients.astype(np.float64)
        lines = (whole[1:-3] + 4 * whole[2:-2] + whole[3:-1]) / 6
        return ((lines[:, 1:-3] + 4 * lines[:, 2:-2] + lines[:, 3:-1]) / 6).astype(np.float32)


def surface_to_send(work: Work) -> Iterator[SentSurface]:
    """Yield the surface in finer and coarser forms, the finest first."""
    surface = work.surface
    first = max(1.0, (surface.height_m.size / MAX_CELLS) ** 0.5)
    for coarser in range(MAX_COARSER):
        small = _reduce(surface, first * COARSER**coarser)
        for step_m in STEPS_M:
            yield _quantise(small, step_m)


def fits(work: Work, spline: SentSurface) -> str:
    """Return a sentence on what was made coarser for the page; empty if nothing was."""
    rows, columns = (side - 4 for side in spline.numbers.shape)
    wide, cells = work.surface.height_m.shape[1], f"{columns} x {rows} cells"
    coarse = f"the surface has {cells}, of {wide} x {work.surface.height_m.shape[0]}" if columns < wide else ""
    steps = f"heights are in steps of {1e6 * spline.step_m:.3g} um" if spline.step_m > 1.01 * STEPS_M[0] else ""
    return "; ".join(filter(None, (coarse, steps)))


def _reduce(surface: HapticSurface, factor: float) -> HapticSurface:
    shape = reduced_shape(surface.height_m.shape, factor)
    if shape == surface.height_m.shape:
        return surface
    relief = Relief(reduced_map(surface.height_m, shape), surface.extent_m)
    labels = None if surface.labels is None else np.ascontiguousarray(middle_pixels(surface.labels, shape))
    return replace(surface, relief=relief, labels=labels)


def _quantise(surface: HapticSurface, step_m: float) -> SentSurface:
    coefficients = spline_coefficients(dequantise(surface.height_m)).astype(np.float64)
    low_m = float(coefficients.min())
    step_m = max(step_m, float(np.ptp(coefficients)) / (2**16 - 1))
    numbers = np.rint((coefficients - low_m) / step_m).astype(np.uint16)
    return SentSurface(numbers, low_m, step_m, surface.labels, surface.extent_m)
