"""Conversion of pictures to a network's input, and of its maps to the size of the picture and to disparity."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32

from tangible_core.data import DisparityMap, Views
from tangible_core.runtime import cv2, plain_opencv

from .card import Means, NetworkInput

Map = Float32[np.ndarray, "h w"]


def to_disparity(values: Map, sure: Map | None, means: Means, views: Views) -> DisparityMap:
    """Convert a network's numbers to a disparity map; unknown where a number is not finite or not a distance."""
    known = np.isfinite(values)
    if means != "disparity-px":
        known &= values > 0 if means in ("depth", "depth-m") else known
    values = np.where(known, values, 1).astype(np.float64)
    cameras = views.calibration
    if means == "disparity-px":
        disparity = values
    elif means == "depth-m" and cameras is not None:
        disparity = cameras.focal_px * cameras.baseline_m / values - cameras.offset_px
    else:
        near = values if means == "inverse-depth" else 1 / values
        disparity = _stretch(near, known)
    in_px = means == "disparity-px" or (means == "depth-m" and cameras is not None)
    confidence = np.ones_like(disparity) if sure is None else np.clip(np.nan_to_num(sure), 0, 1)
    return DisparityMap(
        np.where(known, disparity, np.nan).astype(np.float32),
        np.where(known, confidence, 0).astype(np.float32),
        "px" if in_px else "relative",
    )


def _stretch(near: np.ndarray, known: np.ndarray) -> np.ndarray:
    if not known.any():
        return near
    low, high = float(near[known].min()), float(near[known].max())
    if high - low <= 4 * np.finfo(np.float32).eps * max(abs(low), abs(high)):
        return np.zeros_like(near)
    return np.clip((near - low) / (high - low), 0, 1)


Colours = Float32[np.ndarray, "h w 3"]  # red, green and blue in 0..1
OVERLAP = 0.25  # share of a strip in which it fades into the next
MIN_ROWS = 64  # of a strip: a network needs context


class Fit(NamedTuple):
    """The size (rows, columns) of a resized picture, and that size with padding."""

    resized: tuple[int, int]
    padded: tuple[int, int]


def fit_size(shape: tuple[int, int], takes: NetworkInput, most_px: int) -> Fit:
    """Choose the size for a network: at most `most_px` pixels, in its multiples, or its fixed size."""
    if takes.size_px is not None:
        return Fit(takes.size_px, takes.size_px)
    shrink = min(1.0, (most_px / (shape[0] * shape[1])) ** 0.5)
    height, width = (max(1, round(side * shrink)) for side in shape)
    if takes.fit == "resize":
        near = tuple(max(1, round(side / takes.multiple)) * takes.multiple for side in (height, width))
        return Fit((near[0], near[1]), (near[0], near[1]))
    up = tuple(-(-side // takes.multiple) * takes.multiple for side in (height, width))
    return Fit((height, width), (up[0], up[1]))


def tensor(picture: Colours, takes: NetworkInput, fit: Fit) -> Float32[np.ndarray, "1 3 rows columns"]:
    """Convert a picture to the network's input."""
    picture = resize(picture, fit.resized)
    down, right = (whole - part for whole, part in zip(fit.padded, fit.resized, strict=True))
    if down or right:
        picture = np.pad(picture, ((0, down), (0, right), (0, 0)), mode="edge")
    if takes.order == "bgr":
        picture = picture[..., ::-1]
    mean, std = np.asarray(takes.mean, np.float32), np.asarray(takes.std, np.float32)
    normal = (picture * np.float32(takes.white) - mean) / std
    return np.ascontiguousarray(normal.transpose(2, 0, 1)[None])


def restore_size(output: np.ndarray, fit: Fit, shape: tuple[int, int], channel: int | None = None) -> Map | None:
    """Remove the padding from a network's output and resize it to the picture; None if it is not a map."""
    values = np.asarray(output, np.float32)
    if channel is not None and values.ndim and channel < values.shape[-1]:
        values = values[..., channel]
    while values.ndim > 2 and values.shape[0] == 1:
        values = values[0]
    if values.ndim == 3 and values.shape[2] == 1:
        values = values[..., 0]
    if values.ndim != 2 or values.size == 0:
        return None
    if values.shape != fit.padded:
        values = resize(values, fit.padded)
    return resize(np.ascontiguousarray(values[: fit.resized[0], : fit.resized[1]]), shape)


def resize(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Resize bilinearly, or by averaging to a smaller size; return the same array if it has this size."""
    if values.shape[:2] == shape:
        return values
    shrinks = shape[0] * shape[1] < values.shape[0] * values.shape[1]
    with plain_opencv():
        return cv2.resize(values, shape[::-1], interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR)


def map_in_strips(shape: tuple[int, int], most_px: int, multiple: int, work: Callable[[slice], list[Map]]) -> list[Map]:
    """Compute maps that mean the same in every strip in strips of at most `most_px` pixels, and fade them."""
    rows = max(MIN_ROWS, most_px // shape[1] // multiple * multiple)
    if rows >= shape[0]:
        return work(slice(0, shape[0]))
    total: list[Map] = []
    weight = np.zeros((shape[0], 1), np.float32)
    for strip in _strips(shape[0], rows):
        ramp = _ramp(strip, shape[0], max(1, round(OVERLAP * rows)))
        maps = work(strip)
        total = total or [np.zeros(shape, np.float32) for _ in maps]
        for whole, part in zip(total, maps, strict=True):
            whole[strip] += ramp * part
        weight[strip] += ramp
    return [whole / weight for whole in total]


def _strips(height: int, rows: int) -> Iterator[slice]:
    step = max(1, rows - round(OVERLAP * rows))
    starts = list(range(0, height - rows, step))
    for start in [*starts, height - rows]:
        yield slice(start, start + rows)


def _ramp(strip: slice, height: int, fade: int) -> Float32[np.ndarray, "r 1"]:
    count = strip.stop - strip.start
    up = np.ones(count) if strip.start == 0 else np.minimum(1, np.arange(1, count + 1) / (fade + 1))
    down = np.ones(count) if strip.stop == height else np.minimum(1, np.arange(count, 0, -1) / (fade + 1))
    return np.minimum(up, down).astype(np.float32)[:, None]
