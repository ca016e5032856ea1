"""Features of a picture's texture in windows of three widths."""

import logging
from typing import Literal, NamedTuple

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.data import to_grey
from tangible_core.plugins import note
from tangible_core.runtime import plain_opencv

from ..energies.filter_choice import is_flat, is_one_texture
from ..energies.gabor_bank import bank, octaves
from ..energies.local_energy import energy_planes, mean_energies, padding, picture_spectrum, standardise
from .cells import CELL_PX, ENERGY_SIGMA_PX, cap_rare_values, channels, standardise_roots, window_means
from .patterns import PATTERNS, pattern_frequencies

log: logging.Logger = logging.getLogger(__name__)

# The standard deviations of the windows, px: along borders, for the classes, and for the initial division.
NARROW_PX, MIDDLE_PX, WIDE_PX = 5.0, 10.0, 18.0
# The root of a picture's area, px, below which windows are narrower in proportion, down to half as wide.
LARGE_PX = 320
# The least difference of windows in colour, as a share of white, beyond chance and an even change of light.
COLOURFUL = 0.02
COLOUR_WEIGHT = 3.0  # the weight of a plane of colour against one of ninety planes of texture


class Window(NamedTuple):
    """Features of mean 0 and deviation 1, one column a cell, in windows of one width; and the grid of cells."""

    planes: Float32[np.ndarray, "d n"]
    shape: tuple[int, int]


class Features(NamedTuple):
    """The same features in windows of three widths: energies, frequencies of patterns, colours."""

    wide: Window
    middle: Window
    narrow: Window
    # The numbers of the filters whose energies are the first planes, in the order of `bank`.
    filters: tuple[int, ...] = ()


def features(
    picture: np.ndarray, lambda_max_px: float, least_energy: float, colour: bool | Literal["auto"]
) -> Features | None:
    """Compute features in windows of three widths; None if all agree. Raises: PictureError as `check_picture`."""
    grey = to_grey(picture)
    if is_flat(grey):
        note(log, "one segment: the picture is flat")
        return None
    planes, filters, colour_count = _planes(picture, grey, lambda_max_px, least_energy, colour)
    # Narrow windows have a value every 4 pixels, middle ones every 8, wide ones every 16; in small pictures all every
    # 4.
    step = 2 if min(planes.shape[1:]) >= 32 else 1
    narrow_px, middle_px, wide_px = _widths(grey.size)
    narrow = window_means(planes, (narrow_px**2 - ENERGY_SIGMA_PX**2) ** 0.5 / CELL_PX, out=planes)
    middle = window_means(narrow, (middle_px**2 - narrow_px**2) ** 0.5 / CELL_PX, step)
    if is_one_texture(np.sqrt(middle), middle_px / CELL_PX / step, grey):
        note(log, "one segment: the picture has the same texture everywhere")
        return None
    wide = window_means(middle, (wide_px**2 - middle_px**2) ** 0.5 / CELL_PX / step, step)
    return Features(_window(wide, colour_count), _window(middle, colour_count), _window(narrow, colour_count), filters)


def _widths(pixels: int) -> tuple[float, float, float]:
    share = min(1.0, max(0.5, pixels**0.5 / LARGE_PX))
    return min(NARROW_PX, 0.9 * MIDDLE_PX * share), MIDDLE_PX * share, WIDE_PX * share


def _window(planes: Float32[np.ndarray, "d rows columns"], colour_count: int) -> Window:
    """Standardise planes in place; the last `colour_count` ones weigh more."""
    rows, columns = planes.shape[1:]
    flat = planes.reshape(len(planes), -1)
    standardise_roots(flat)
    flat[len(flat) - colour_count :] *= np.float32(COLOUR_WEIGHT)
    return Window(flat, (rows, columns))


def _planes(
    picture: np.ndarray,
    grey: Float32[np.ndarray, "h w"],
    lambda_max_px: float,
    least_energy: float,
    colour: bool | Literal["auto"],
) -> tuple[Float32[np.ndarray, "d rows columns"], tuple[int, ...], int]:
    """Return energies, pattern frequencies and colours, cell by cell; the filters' numbers; and how many colours."""
    filters = bank(octaves(lambda_max_px))
    spectrum = picture_spectrum(grey, padding(filters, ENERGY_SIGMA_PX))
    means = mean_energies(spectrum, filters)
    numbers = tuple(np.flatnonzero(means >= least_energy * means.sum()).tolist())
    filters_used = [filters[number] for number in numbers]
    if len(filters_used) < len(filters):
        note(log, f"{len(filters) - len(filters_used)} of {len(filters)} filters left out: they hold hardly any energy")
    colours = _colour_planes(picture, colour)
    rows, columns = (-(-side // CELL_PX) for side in grey.shape)
    # One array: for a large picture it has hundreds of megabytes, and so would each copy.
    planes = np.empty((len(filters_used) + PATTERNS + len(colours), rows, columns), np.float32)
    energies, patterns = planes[: len(filters_used)], planes[len(filters_used) : len(filters_used) + PATTERNS]
    cap_rare_values(energy_planes(spectrum, filters_used, grey.shape, CELL_PX, ENERGY_SIGMA_PX, energies))
    pattern_frequencies(standardise(grey), patterns)
    planes[len(filters_used) + PATTERNS :] = colours
    return planes, numbers, len(colours)


def _colour_planes(picture: np.ndarray, colour: bool | Literal["auto"]) -> Float32[np.ndarray, "colours rows columns"]:
    """Return red against green and both against blue, cell by cell, 0..2; no plane where colour is not used."""
    rows, columns = (-(-side // CELL_PX) for side in picture.shape[:2])
    none = np.empty((0, rows, columns), np.float32)
    if colour is False:
        return none
    paint = channels(picture, colour=True)
    if paint.shape[2] == 1:
        note(log, "colour left out: the picture has none")
        return none
    red, green, blue = np.moveaxis(paint, 2, 0)
    opponents = (1 + (red - green) / 2, 1 + (red + green) / 4 - blue / 2)
    with plain_opencv():
        planes = np.stack(
            [cv2.resize(opponent, (columns, rows), interpolation=cv2.INTER_AREA) for opponent in opponents]
        )
    differ = float(np.sqrt(_remove_slope(window_means(planes, MIDDLE_PX / CELL_PX)).var(axis=(1, 2)).sum()))
    if colour == "auto" and differ < COLOURFUL:
        note(log, f"colour left out: it differs between windows by {differ:.3f} of white, under {COLOURFUL:g}")
        return none
    note(log, f"colour used: it differs between windows by {differ:.3f} of white")
    return planes


def _remove_slope(planes: Float32[np.ndarray, "d rows columns"]) -> Float32[np.ndarray, "d rows columns"]:
    for axis in (1, 2):
        place = np.arange(planes.shape[axis], dtype=np.float32) - np.float32((planes.shape[axis] - 1) / 2)
        place = np.expand_dims(place, tuple({0, 1, 2} - {axis}))
        slope = (planes * place).mean(axis=(1, 2), keepdims=True) / max(float(np.square(place).mean()), 1e-9)
        planes = planes - slope * place
    return planes
