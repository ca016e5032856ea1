"""A solid as a picture: seen from above the front edge, in light from the upper left."""

from collections.abc import Mapping
from dataclasses import replace
from typing import cast

import cv2
import numpy as np
from jaxtyping import Float64, UInt8

from tangible_core.data import Record, Relief, Work

from .closed import Solid

COARSE_M = 2e-4  # less than a pixel
MAX_NODES = 300
WIDTH_PX = 640
MARGIN_PX = 8
# Angle between the view and the plumb line: walls are seen, and nothing hides much behind them.
TILT = np.radians(35)
LIGHT = np.array([-0.5, 0.35, 0.8]) / np.linalg.norm([-0.5, 0.35, 0.8])
# Brightness of what lies lowest, as a share of what lies highest: steps between level faces are seen.
LOWEST = 0.72
DARKEST, LIGHTEST = 70, 250


def coarse_work(work: Work) -> Work:
    """Return the work with a relief of at most MAX_NODES along each side."""
    relief = work.relief
    step = -(-max(relief.height_m.shape) // MAX_NODES)
    coarse = Relief(np.ascontiguousarray(relief.height_m[::step, ::step]), relief.extent_m)
    return replace(work, products=cast("Mapping[str, Record | None]", {**work.products, "relief": coarse}))


def shaded(solid: Solid) -> UInt8[np.ndarray, "h w"]:
    """Return the solid on white; nearer triangles are painted over farther ones."""
    at = solid.vertices_mm[solid.triangles]
    normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    towards = np.array([0.0, -np.sin(TILT), np.cos(TILT)])
    visible = (_along(normals, towards) > 0) & (lengths > 0)
    at, normals = at[visible], normals[visible] / lengths[visible, None]
    places, (rows, columns) = _on_picture(at)
    high = at[..., 2].mean(axis=1)
    shares = np.clip((high - (low := np.percentile(high, 1))) / (high.max() - low + 1e-9), 0, 1)
    greys = (DARKEST + (LIGHTEST - DARKEST) * np.clip(_along(normals, LIGHT), 0, 1)) * (LOWEST + (1 - LOWEST) * shares)
    picture = np.full((rows, columns), 255, np.uint8)
    corners = np.rint(16 * places).astype(np.int32)
    for number in np.argsort(_along(at.mean(axis=1), towards)).tolist():
        cv2.fillConvexPoly(picture, corners[number], float(greys[number]), cv2.LINE_8, shift=4)
    return picture


def _along(vectors: Float64[np.ndarray, "m 3"], direction: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "m"]:
    return np.einsum("ij,j->i", vectors, direction)


def _on_picture(at_mm: Float64[np.ndarray, "m 3 3"]) -> tuple[Float64[np.ndarray, "m 3 2"], tuple[int, int]]:
    """Return the corners of triangles in pixels, x and y down, and the picture's rows and columns."""
    up = at_mm[..., 1] * np.cos(TILT) + at_mm[..., 2] * np.sin(TILT)
    flat = np.stack([at_mm[..., 0], -up], axis=-1)
    low = flat.min(axis=(0, 1))
    size_mm = flat.max(axis=(0, 1)) - low
    scale = (WIDTH_PX - 2 * MARGIN_PX) / size_mm.max()
    columns, rows = np.ceil(scale * size_mm).astype(int) + 2 * MARGIN_PX
    return scale * (flat - low) + MARGIN_PX, (int(rows), int(columns))
