"""Pictures whose segments are known exactly: mosaics of textures, and smooth surfaces with edges between them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float64, Int32, UInt8

from ...data import Record
from ...data.pictures import is_one_colour, to_grey
from ...errors import PictureError
from ...runtime.opencv import plain_opencv
from ...scene.formats.pictures import read_picture
from ...scene.scene import Scene
from .textures import FAMILIES, Family, Shape, smooth_noise, without_grey

PHOTOGRAPHS = ("brick", "grass", "gravel")
"""Pictures of scikit-image that are textures."""
WARP, WARP_SIGMA = 18 / 512, 28 / 512
"""Amplitude and wavelength of the warp of borders, as shares of the root of the picture's area."""
CANDIDATES = 40
"""Random candidates for each scattered point: more spread the points more evenly."""
ENDINGS = frozenset((".png", ".jpg", ".jpeg", ".tif", ".tiff"))


@dataclass(frozen=True, eq=False)
class KnownSegments(Record):
    """A picture and its true labels, int32 (h, w), 0..n-1, all present."""

    picture: np.ndarray
    labels: Int32[np.ndarray, "h w"]

    @property
    def count(self) -> int:
        """The number of true segments."""
        return int(self.labels.max()) + 1


def texture_mosaic(
    segments: int, shape: Shape = (512, 512), seed: int = 0, textures: Mapping[str, Family] | None = None
) -> KnownSegments:
    """Return a mosaic of n textures, uint8 (h, w), in curvy regions, one or more each. Raises: PictureError."""
    available = builtin_textures() if textures is None else textures
    if len(available) < segments:
        raise PictureError(f"a mosaic of {segments} needs as many textures, but there are {len(available)}; add some")
    random = np.random.default_rng(seed)
    names = random.choice(sorted(available), segments, replace=False)
    # Each loses local mean and contrast, so that grey tells nothing; a picture too small has fewer segments.
    count = max(segments + 2, 8 * segments // 5)
    of_region = random.permutation(np.arange(count) % segments)
    labels = in_order(of_region[curvy_regions(shape, count, random)])
    picture = np.empty(shape)
    for label, name in enumerate(names[: labels.max() + 1]):
        np.copyto(picture, without_grey(available[name](shape, random)), where=labels == label)
    return KnownSegments(_bytes(picture), labels)


def smooth_scene(segments: int = 14, shape: Shape = (512, 512), seed: int = 0, noise: float = 6.0) -> KnownSegments:
    """Return curvy regions of one grey each under a gradient of light, blurred, with noise of `noise` grey levels."""
    import cv2

    random = np.random.default_rng(seed)
    labels = in_order(curvy_regions(shape, segments, random))
    greys: np.ndarray = random.permutation(np.linspace(30, 225, segments))
    rows, columns = np.indices(shape, np.float64) / np.reshape(shape, (2, 1, 1))
    light = 25 * (columns * random.uniform(-1, 1) + rows * random.uniform(-1, 1))
    picture: np.ndarray = greys[labels] + light
    with plain_opencv():
        smooth = cv2.GaussianBlur(picture, (0, 0), 1.0, borderType=cv2.BORDER_REFLECT)
    return KnownSegments(_bytes(smooth + noise * random.standard_normal(shape)), labels)


def curvy_regions(shape: Shape, count: int, random: np.random.Generator) -> Int32[np.ndarray, "h w"]:
    """Return Voronoi cells of scattered points under a smooth random warp: labels 0..count-1, some perhaps absent."""
    side = np.sqrt(shape[0] * shape[1])
    places = np.indices(shape, np.float64)
    for place in places:
        place += WARP * side * smooth_noise(shape, random, WARP_SIGMA * side)
    nearest, labels = np.full(shape, np.inf), np.zeros(shape, np.int32)
    for index, (row, column) in enumerate(scatter_points(shape, count, random)):
        distance = (places[0] - row) ** 2 + (places[1] - column) ** 2
        labels[distance < nearest] = index
        np.minimum(nearest, distance, out=nearest)
    return labels


def in_order(labels: np.ndarray) -> Int32[np.ndarray, "h w"]:
    """Renumber labels to 0..n-1, all present."""
    _, inverse = np.unique(labels, return_inverse=True)
    return inverse.reshape(labels.shape).astype(np.int32)


def scatter_points(shape: Shape, count: int, random: np.random.Generator) -> Float64[np.ndarray, "n 2"]:
    """Return points (row, column) far apart: each is the one of CANDIDATES that is furthest from earlier points."""
    # Best candidate: Mitchell, Spectrally optimal sampling for distribution ray tracing, SIGGRAPH 1991.
    points = random.uniform(0, shape, (1, 2))
    while len(points) < count:
        candidates = random.uniform(0, shape, (CANDIDATES, 2))
        gaps = np.linalg.norm(candidates[:, None] - points, axis=2).min(axis=1)
        points = np.vstack([points, candidates[gaps.argmax()]])
    return points


def builtin_textures() -> dict[str, Family]:
    """Return the synthetic textures and those of scikit-image, by name."""
    return {**FAMILIES, **{name: partial(_crop, _builtin_photograph(name)) for name in PHOTOGRAPHS}}


def folder_textures(folder: Path) -> dict[str, Family]:
    """Return every picture of a folder, in grey, by its name without the ending. Raises: PictureError."""
    paths = sorted(path for path in folder.glob("*.*") if path.suffix.lower() in ENDINGS)
    if not paths:
        raise PictureError(f"{folder}: has no texture pictures; add some, such as bark.png")
    return {path.stem: partial(_crop, _texture(read_picture(path), str(path))) for path in paths}


def _builtin_photograph(name: str) -> Float64[np.ndarray, "h w"]:
    views = Scene.builtin(name).views
    assert views is not None  # builtin pictures are no height maps
    return _texture(views.left, name)


def _texture(picture: np.ndarray, name: str) -> Float64[np.ndarray, "h w"]:
    if is_one_colour(picture):
        raise PictureError(f"{name}: is one flat colour, not a texture; remove it")
    return to_grey(picture).astype(np.float64)


def _crop(texture: Float64[np.ndarray, "H W"], shape: Shape, random: np.random.Generator) -> np.ndarray:
    """Crop a random part; a texture that is too small is continued by its mirror image."""
    missing = [max(0, side - has) for side, has in zip(shape, texture.shape, strict=True)]
    large = np.pad(texture, [(0, more) for more in missing], mode="symmetric")
    top, left = random.integers(0, np.subtract(large.shape, shape) + 1)
    return large[top : top + shape[0], left : left + shape[1]]


def _bytes(values: np.ndarray) -> UInt8[np.ndarray, "h w"]:
    return np.rint(values.clip(0, 255)).astype(np.uint8)
