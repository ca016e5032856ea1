"""Depth with the slopes that a network's normals say."""
# pyright: reportCallIssue=false, reportArgumentType=false

import numpy as np
from jaxtyping import Float32, Float64
from scipy.fft import dctn, idctn

STEP = 0.01  # relative change of depth from pixel to pixel from which it is a step from thing to thing, and no slope
GRAZING = 0.1  # least cosine between a normal and its ray at which it says a slope
REACH = 1 / 32  # distance within which normals count more than depth, of the longer side


def join_normals(
    points: Float32[np.ndarray, "h w 3"], normals: Float32[np.ndarray, "h w 3"], sure: Float32[np.ndarray, "h w"] | None
) -> Float64[np.ndarray, "h w"]:
    """Return the depth of a network's points with the slopes that its normals say, 0 where it is unknown.

    Coordinates are those of a camera: right, down, and away but for a constant, which is found as the one that puts
    each point on the ray of its pixel; if there is none, their own depth is returned. sure: 0..1, how much a point
    counts for that. Steps from thing to thing stay those of the points.
    Sources: Wang et al., MoGe, CVPR 2025 (the constant); Simchony, Chellappa & Shao, IEEE TPAMI 12, 1990 (integration).
    """
    shape = points.shape[:2]
    known = np.isfinite(points).all(2) & np.isfinite(normals).all(2) & (points[..., 2] > 0)
    weight = known * (1.0 if sure is None else np.clip(np.nan_to_num(sure), 0, 1))
    x, y, z = np.where(known, np.moveaxis(points, 2, 0), 1).astype(np.float64)
    v, u = (at - (side - 1) / 2 for at, side in zip(np.indices(shape), shape, strict=True))
    # focal x / (z + shift) = u is linear in both unknowns; it is divided by z, so that what is far does not count more.
    terms = np.stack([np.stack([x, y]), -np.stack([u, v])], axis=-1) * (weight / z)[..., None]
    focal, shift = np.linalg.lstsq(terms.reshape(-1, 2), (weight * np.stack([u, v])).ravel())[0]
    if not (focal > 0 and np.median(z + shift) > 0):
        return np.where(known, z, 0)
    known &= z + shift > 0
    logarithm = np.log(np.where(known, z + shift, 1))
    # A plane through a point of depth Z changes its logarithm by -n / (focal n . ray) from pixel to pixel.
    facing = ((normals[..., 0] * u + normals[..., 1] * v) / focal + normals[..., 2])[..., None]
    usable = known[..., None] & (np.abs(facing) > GRAZING)
    slopes = np.divide(-normals[..., :2], focal * facing, out=np.full((*shape, 2), np.nan), where=usable)
    stiff = np.full(shape, (REACH * max(shape)) ** -2.0)
    wanted = logarithm * stiff
    down, across = (logarithm, slopes[..., 1], wanted, stiff), (logarithm.T, slopes[..., 0].T, wanted.T, stiff.T)
    for values, slope, total, stiffness in (down, across):
        change, said = np.diff(values, axis=0), (slope[1:] + slope[:-1]) / 2
        total -= np.diff(np.where(np.abs(said - change) < STEP, said, change), axis=0, prepend=0, append=0)
        stiffness += 2 - 2 * np.cos(np.pi * np.arange(len(values)) / len(values))[:, None]
    return np.where(known, np.exp(idctn(dctn(wanted, norm="ortho") / stiff, norm="ortho")), 0)
