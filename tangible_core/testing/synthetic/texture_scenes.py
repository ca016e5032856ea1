"""Pictures whose segments are known exactly: mosaics of synthetic textures, and smooth surfaces with edges."""

# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Float64, Int32, UInt8

from ...data import Record
from ...data.pictures import is_one_colour, to_grey
from ...errors import PictureError
from ...runtime.opencv import cv2, plain_opencv
from ...scene.formats.pictures import read_picture
from ...scene.scene import Scene

Shape = tuple[int, int]
Values = Float64[np.ndarray, "h w"]
Family = Callable[[Shape, np.random.Generator], Values]

GREY, CONTRAST = 128.0, 40.0  # mean and standard deviation of every texture, in grey levels of 255
# Standard deviation of the Gaussian in which the local mean and contrast are measured.
WINDOW_PX = 24.0


def without_grey(texture: np.ndarray) -> Values:
    """Remove local mean and contrast from a texture and map its ranks onto one histogram: float64 in 0..255."""
    from scipy.special import ndtri

    values = texture - _mean_around(texture)
    deviation = np.sqrt(_mean_around(values**2).clip(0))
    values /= deviation + 1e-6 * values.std() + np.finfo(np.float64).tiny
    # A Gaussian, cut at 0 and 255: all textures of one size have the same values, in other places.
    ranks = np.empty(values.size)
    ranks[np.argsort(values, axis=None, kind="stable")] = (np.arange(values.size) + 0.5) / values.size
    return np.clip(GREY + CONTRAST * ndtri(ranks).reshape(values.shape), 0, 255)


def grain(shape: Shape, random: np.random.Generator) -> Values:
    """Return noise of one wavelength, 5 px, in all directions."""
    return _filter_noise(shape, random, lambda across, down: _bell(np.hypot(across, down), 1 / 5, 0.03))


def fibres(shape: Shape, random: np.random.Generator) -> Values:
    """Return noise of 6 px along one direction, long across it, like brushed metal."""
    return _filter_noise(shape, random, lambda across, down: _bell(across, 1 / 6, 0.06) * _bell(down, 0, 0.012))


def ripples(shape: Shape, random: np.random.Generator) -> Values:
    """Return noise of 12 px, mostly in one direction, like water."""
    return _filter_noise(shape, random, lambda across, down: _bell(across, 0.03, 0.02) * _bell(down, 1 / 12, 0.02))


def clouds(shape: Shape, random: np.random.Generator) -> Values:
    """Return fractal noise: the amplitude falls as 1 / frequency."""
    return _filter_noise(shape, random, lambda across, down: 1 / np.maximum(np.hypot(across, down), 1 / 64))


def maze(shape: Shape, random: np.random.Generator) -> Values:
    """Return noise of 11 px, saturated to black and white: winding bands with sharp edges."""
    noise = _filter_noise(shape, random, lambda across, down: _bell(np.hypot(across, down), 1 / 11, 0.012))
    return np.tanh(4 * noise / noise.std())


def stripes(shape: Shape, random: np.random.Generator) -> Values:
    """Return wavy bands of 8 px that rise to the right."""
    rows, columns = _wavering(shape, random, 1.5)
    return np.cos(2 * np.pi * (columns * np.sin(0.6) + rows * np.cos(0.6)) / 8)


def zigzag(shape: Shape, random: np.random.Generator) -> Values:
    """Return bands that go up and down at 45 degrees, every 7 px of a column and 28 px of a row, like a herringbone."""
    rows, columns = _wavering(shape, random, 0.5)
    return np.cos(2 * np.pi * (rows + np.abs(columns % 28 - 14)) / 7)


def weave(shape: Shape, random: np.random.Generator) -> Values:
    """Return threads 6 px wide, each over one that crosses it and under the next."""
    rows, columns = (places / 6 for places in _wavering(shape, random, 0.5))
    over = (np.floor(rows) + np.floor(columns)) % 2 == 0
    return np.where(over, np.sin(np.pi * (rows % 1)), np.sin(np.pi * (columns % 1)))


def bricks(shape: Shape, random: np.random.Generator) -> Values:
    """Return a wall of rough bricks, 24 x 10 px, each course shifted by half a brick."""
    rows, columns = _wavering(shape, random, 0.5)
    course = np.floor(rows / 10)
    joint = np.minimum(_to_line(rows, 10), _to_line(columns + 12 * course, 24))
    return np.minimum(joint, 2.5) + 0.5 * random.standard_normal(shape)


def dots(shape: Shape, random: np.random.Generator) -> Values:
    """Return round spots about 11 px apart, irregularly placed."""
    nearest, _ = _distances(shape, random, 11)
    return np.exp(-0.5 * (nearest / 2.2) ** 2)


def pebbles(shape: Shape, random: np.random.Generator) -> Values:
    """Return domes about 16 px wide that touch."""
    nearest, second = _distances(shape, random, 16)
    return np.sqrt(np.maximum(1 - (nearest / (nearest + second) * 2) ** 2, 0))


def cracks(shape: Shape, random: np.random.Generator) -> Values:
    """Return thin lines between plates about 20 px wide, with fine noise: the borders of Voronoi cells."""
    nearest, second = _distances(shape, random, 20)
    return np.minimum(second - nearest, 2.5) + 0.25 * random.standard_normal(shape)


FAMILIES: Mapping[str, Family] = {
    family.__name__: family
    for family in (grain, fibres, ripples, clouds, maze, stripes, zigzag, weave, bricks, dots, pebbles, cracks)
}


def smooth_noise(shape: Shape, random: np.random.Generator, sigma_px: float) -> Values:
    """Return periodic noise blurred by a Gaussian: mean 0, standard deviation 1 (0 for a picture of one pixel)."""
    noise = _filter_noise(
        shape, random, lambda across, down: _bell(np.hypot(across, down), 0, 1 / (2 * np.pi * sigma_px))
    )
    return noise / max(float(noise.std()), np.finfo(np.float64).tiny)


def _filter_noise(shape: Shape, random: np.random.Generator, gain: Callable[[Values, Values], Values]) -> Values:
    """Return white noise times a gain of the frequency (across, down) in cycles a pixel, without its mean."""
    across, down = np.meshgrid(np.fft.rfftfreq(shape[1]), np.fft.fftfreq(shape[0]))
    spectrum = np.fft.rfft2(random.standard_normal(shape)) * gain(across, down)
    spectrum[0, 0] = 0
    return np.fft.irfft2(spectrum, shape)


def _mean_around(values: np.ndarray) -> Values:
    """Return the mean under a Gaussian of WINDOW_PX, by a cosine transform, which mirrors the picture at its border."""
    from scipy.fft import dctn, idctn

    down, across = (_bell(np.fft.rfftfreq(2 * side)[:side], 0, 1 / (2 * np.pi * WINDOW_PX)) for side in values.shape)
    return np.asarray(idctn(dctn(values) * np.outer(down, across)))


def _bell(value: Float64[np.ndarray, "..."], centre: float, deviation: float) -> Float64[np.ndarray, "..."]:
    return np.exp(-0.5 * ((value - centre) / deviation) ** 2)


def _wavering(shape: Shape, random: np.random.Generator, deviation_px: float) -> tuple[Values, Values]:
    places = np.indices(shape, np.float64) + random.uniform(0, 1000, (2, 1, 1))
    rows, columns = (place + deviation_px * smooth_noise(shape, random, 12) for place in places)
    return rows, columns


def _to_line(place: Values, period: float) -> Values:
    return np.abs((place + period / 2) % period - period / 2)


def _distances(shape: Shape, random: np.random.Generator, pitch_px: float) -> tuple[Values, Values]:
    """Return the distances of each pixel to the nearest and second nearest of random points, one in each square."""
    from scipy.spatial import KDTree

    squares = np.indices([int(side / pitch_px) + 4 for side in shape]).reshape(2, -1).T - 2
    points = (squares + random.uniform(0, 1, squares.shape)) * pitch_px
    distances: np.ndarray = KDTree(points).query(np.indices(shape).reshape(2, -1).T, k=2)[0]
    return distances[:, 0].reshape(shape), distances[:, 1].reshape(shape)


PHOTOGRAPHS = ("brick", "grass", "gravel")  # pictures of scikit-image that are textures
# Amplitude and wavelength of the warp of borders, as shares of the root of the picture's area.
WARP, WARP_SIGMA = 18 / 512, 28 / 512
# Random candidates for each scattered point: more spread the points more evenly.
CANDIDATES = 40
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
    missing = [max(0, side - has) for side, has in zip(shape, texture.shape, strict=True)]
    large = np.pad(texture, [(0, more) for more in missing], mode="symmetric")
    top, left = random.integers(0, np.subtract(large.shape, shape) + 1)
    return large[top : top + shape[0], left : left + shape[1]]


def _bytes(values: np.ndarray) -> UInt8[np.ndarray, "h w"]:
    return np.rint(values.clip(0, 255)).astype(np.uint8)
