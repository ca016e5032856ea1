"""How likely a number of textures is: the weights of `gabor`'s estimate, fitted and tried on textures not fitted to.

TANGIBLE_TEXTURES=... python -m benchmarks.texture_number   # some minutes; the weights stand in clusters/counting.py
"""

import sys
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from tangible_core.testing.synthetic.texture_scenes import KnownSegments
from tangible_texture.clusters.classes import Weights, number_likelihoods
from tangible_texture.clusters.joining import Step
from tangible_texture.gabor import Gabor

from .texture_kinds import reported_half, tuning_half
from .texture_scenes import builtin, held_out

# What the sum of the weights' squares, without the constant's, costs beside the mean log-likelihood.
PENALTY = 0.01


# Sides of the crops, one a mosaic in turn; tries to find one in which each segment has this share; seed of places.
CROPS_PX, CROP_TRIES, MIN_SHARE, CROP_SEED = (96, 128, 192, 256, 320), 60, 0.04, 7


class Joined(NamedTuple):
    """The joinings of a mosaic, and its true number of textures."""

    steps: list[Step]
    textures: int


def joinings(scenes: Iterable[KnownSegments]) -> Iterator[Joined]:
    """Yield what `gabor` would estimate the number of each mosaic from."""
    caught: list[list[Step]] = []

    def catch(steps: Iterable[Step]) -> np.ndarray:
        caught.append(list(steps))
        return caught[-1][-1].labels

    from tangible_texture.clusters import classes

    kept, classes.likeliest_division = classes.likeliest_division, catch
    try:
        for scene in scenes:
            Gabor().segment(scene.picture)
            yield Joined(caught[-1], scene.count)
    finally:
        classes.likeliest_division = kept


def crops(scenes: Iterable[KnownSegments]) -> Iterator[KnownSegments]:
    """Yield a square piece of each mosaic, of few textures or of one; none where all pieces have a sliver of one."""
    for index, scene in enumerate(scenes):
        side, random = CROPS_PX[index % len(CROPS_PX)], np.random.default_rng([CROP_SEED, index])
        for _ in range(CROP_TRIES):
            top, left = (random.integers(0, each - side + 1) for each in scene.labels.shape)
            inside = np.s_[top : top + side, left : left + side]
            _, labels, sizes = np.unique(scene.labels[inside], return_inverse=True, return_counts=True)
            if sizes.min() >= MIN_SHARE * side * side:
                labels = labels.reshape(side, side).astype(np.int32)
                yield KnownSegments(np.ascontiguousarray(scene.picture[inside]), labels)
                break


def fit(mosaics: list[Joined]) -> Weights:
    """Return the weights under which the true numbers are the likeliest."""

    def loss(weights: np.ndarray) -> float:
        likelihoods = [_of(mosaic.textures, mosaic, Weights(*weights)) for mosaic in mosaics]
        return -sum(likelihoods) / len(mosaics) + PENALTY * float((weights[1:] ** 2).sum())

    return Weights(*minimize(loss, np.zeros(len(Weights._fields)), method="BFGS").x.tolist())


def _of(count: int, joined: Joined, weights: Weights) -> float:
    likelihoods = number_likelihoods(joined.steps, weights)
    return next((like for like, step in zip(likelihoods, joined.steps, strict=True) if step.clusters == count), 0.0)


def main() -> None:
    """Print the weights, and how often the numbers that they make the likeliest are right."""
    halves = {
        "tuning half": tuning_half(),
        "built-in textures": builtin(),
        "reported half": reported_half(),
        "photographs of textures": held_out(),
    }
    found: dict[str, list[Joined]] = {}
    for name, scenes in halves.items():
        found |= {name: list(joinings(scenes.values())), f"crops, {name}": list(joinings(crops(scenes.values())))}
    weights = fit(
        [each for name in ("tuning half", "built-in textures") for each in found[name] + found[f"crops, {name}"]]
    )
    print(Weights(*(round(weight, 2) for weight in weights)))
    for name, mosaics in found.items():
        off, worth = zip(*(_guess(mosaic, weights) for mosaic in mosaics), strict=True)
        exact, near = np.equal(off, 0), np.abs(off) <= 1
        print(f"{name}: exact {exact.mean():.3f}, within one {near.mean():.3f}, stated {np.mean(worth):.3f}")


def _guess(joined: Joined, weights: Weights) -> tuple[int, float]:
    likelihoods = np.array(number_likelihoods(joined.steps, weights))
    best = int(likelihoods.argmax())
    return joined.steps[best].clusters - joined.textures, float(np.exp(likelihoods[best]) / np.exp(likelihoods).sum())


if __name__ == "__main__":
    sys.exit(main())
