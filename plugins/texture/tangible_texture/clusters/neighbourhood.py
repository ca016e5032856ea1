"""Memberships of cells from their own evidence and from their neighbours."""

from functools import cache

import cv2
import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import exponential, njit
from tangible_core.runtime import plain_opencv

from .discriminants import evidence, one_hot, scatters

PULL = 4.0  # the weight of the neighbours' mean membership against evidence
# The weight of evidence, under 1: windows overlap, so that cells are not independent.
EVIDENCE = 0.5
BLOCK = 1024  # the number of cells processed while they are in the cache
# The least membership besides 0, as a share of the cell's largest: denormal numbers are slow.
LEAST = 1e-7
# The standard deviation, in cells, of the window in which a cell's class must prevail for its full weight.
INSIDE_CELLS = 2.0


def smooth_memberships(memberships: Float32[np.ndarray, "k n"], shape: tuple[int, int], sigma: float) -> np.ndarray:
    """Compute Gaussian means of each class's memberships over the grid of cells."""
    result, taps = np.empty(memberships.shape, np.float32), _gaussian(sigma)
    with plain_opencv():
        for membership, out in zip(memberships, result, strict=True):
            cv2.sepFilter2D(
                membership.reshape(shape), -1, taps, taps, dst=out.reshape(shape), borderType=cv2.BORDER_REFLECT
            )
    return result


@cache
def _gaussian(sigma: float) -> Float32[np.ndarray, "t 1"]:
    """Return the taps of a Gaussian, up to four standard deviations: computed once, as grids are small and many."""
    return np.asarray(cv2.getGaussianKernel(2 * round(4 * sigma) + 1, sigma, cv2.CV_32F), np.float32)


def mean_field(
    evidence: Float32[np.ndarray, "k n"],
    memberships: Float32[np.ndarray, "k n"],
    shape: tuple[int, int],
    sigma: float,
    rounds: int,
) -> Float32[np.ndarray, "k n"]:
    """Update each cell's memberships by its evidence and PULL times the mean of those around it, in rounds."""
    # The mean-field approximation of a Potts model with Gaussian neighbourhoods (Krahenbuhl & Koltun, NIPS 2011).
    for _ in range(rounds):
        memberships = _softmax(evidence, smooth_memberships(memberships, shape, sigma), np.float32(PULL))
    return memberships


def interior_shares(labels: Int32[np.ndarray, "n"], shape: tuple[int, int]) -> Float32[np.ndarray, "n"]:
    """Return the share of a cell's own class in the window around it: 1 well inside, about 1/2 on borders."""
    shares = smooth_memberships(one_hot(labels, int(labels.max()) + 1), shape, INSIDE_CELLS)
    return shares[labels, np.arange(labels.size)]


def refit_labels(
    planes: Float32[np.ndarray, "d n"], labels: Int32[np.ndarray, "n"], shape: tuple[int, int], rounds: int, votes: int
) -> Int32[np.ndarray, "n"]:
    """Refine labels in rounds: fit discriminants to inner cells, then settle with neighbours; classes may vanish."""
    memberships = one_hot(labels, int(labels.max()) + 1)
    for _ in range(rounds):
        inside = memberships * smooth_memberships(memberships, shape, INSIDE_CELLS) ** 2  # borders are mixtures
        towards = evidence(planes, scatters(planes, inside))
        memberships = mean_field(EVIDENCE * towards, memberships, shape, 1.5, votes)
        before, labels = labels, memberships.argmax(axis=0)
        if np.mean(before != labels) < 1e-3:
            break
    return np.unique(labels, return_inverse=True)[1].astype(np.int32)


@njit(cache=True, nogil=True)
def _softmax(evidence, around, pull):
    result = np.empty_like(evidence)
    classes, cells = evidence.shape
    for start in range(0, cells, BLOCK):
        stop = min(start + BLOCK, cells)
        highest, total = np.full(stop - start, np.float32(-1e30)), np.zeros(stop - start, np.float32)
        for k in range(classes):
            _towards(evidence[k, start:stop], around[k, start:stop], pull, result[k, start:stop], highest)
        for k in range(classes):
            _raise(result[k, start:stop], highest, total)
        for k in range(classes):
            part = result[k, start:stop]
            for i in range(part.size):
                part[i] /= total[i]
    return result


@njit(cache=True, nogil=True)
def _towards(evidence, around, pull, result, highest):
    for i in range(result.size):
        result[i] = evidence[i] + pull * around[i]
        highest[i] = result[i] if result[i] > highest[i] else highest[i]


@njit(cache=True, nogil=True)
def _raise(result, highest, total):
    for i in range(result.size):
        share = exponential(result[i] - highest[i])
        result[i] = share if share > np.float32(LEAST) else np.float32(0)
        total[i] += result[i]
