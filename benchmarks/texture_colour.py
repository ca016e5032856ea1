"""`gabor` on coloured mosaics, with colour and without: the same grey, so that colour alone makes the difference."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float64, Int32, UInt8

from tangible_bench.metrics.segments import segment_errors
from tangible_core.data.pictures import BLUE, RED
from tangible_core.testing.synthetic.texture_scenes import KnownSegments

from .figures import Figure
from .texture_accuracy import found
from .texture_scenes import published

EVERY = 2
"""So many mosaics are passed over for one that is coloured."""
DARKEST, CONTRAST = 48.0, 160 / 255
"""What black becomes, and what is left of the contrast, so that there is room for colour."""
CHROMA = 24.0
"""Length of a tint in grey levels of 255, across what is seen as grey."""
TIE = 0.005
"""ARI by which chance alone lets two results differ."""


def figures() -> list[Figure]:
    """Return the promise about colour, for each way in which a mosaic is coloured."""
    kinds: dict[str, list[tuple[float, float, str]]] = {}
    for name, scene in list(published().items())[::EVERY]:
        for kind, picture in coloured(scene):
            ours, grey = (_ari(picture, scene, colour) for colour in ("auto", False))
            kinds.setdefault(kind, []).append((ours, grey, name))
    return [_figure(kind, each) for kind, each in kinds.items()]


def coloured(scene: KnownSegments) -> Iterator[tuple[str, UInt8[np.ndarray, "h w 3"]]]:
    """Ways to colour a mosaic, and the picture."""
    around = 2 * np.pi * np.arange(scene.count) / scene.count
    yield "each texture has a tint of its own", _tinted(scene, _tints(around)[scene.labels])
    yield "two textures share each tint", _tinted(scene, _tints(around)[scene.labels // 2 * 2])
    columns = np.linspace(-0.5, 0.5, scene.labels.shape[1])
    light = np.broadcast_to(columns[None, :, None] * _tints(np.zeros(1)), (*scene.labels.shape, 3))
    yield "the light grows redder from left to right", _tinted(scene, light)


def _tints(angle_rad: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, "n 3"]:
    """Tints round the grey axis: the luma of each is 0."""
    across = np.linalg.svd([[RED, 1 - RED - BLUE, BLUE]])[2][1:]
    return CHROMA * np.column_stack([np.cos(angle_rad), np.sin(angle_rad)]) @ across


def _tinted(scene: KnownSegments, tint: Float64[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "h w 3"]:
    grey = DARKEST + CONTRAST * scene.picture.astype(np.float64)
    return np.rint((grey[..., None] + tint).clip(0, 255)).astype(np.uint8)


def _ari(picture: UInt8[np.ndarray, "h w 3"], scene: KnownSegments, colour: object) -> float:
    labels: Int32[np.ndarray, "h w"] = found("gabor", picture, scene.count, colour=colour).labels
    return segment_errors(labels, scene.labels)["ari"]


def _figure(kind: str, results: list[tuple[float, float, str]]) -> Figure:
    ours, grey, names = zip(*results, strict=True)
    margins = np.subtract(ours, grey)
    worst = int(margins.argmin())
    return Figure(
        f"colour, {len(names)} mosaics: {kind}; `gabor`",
        f"ARI never below that of grey by more than {TIE:g}",
        f"ARI {np.mean(ours):.3f} against {np.mean(grey):.3f} in grey; below on {np.sum(margins < -TIE)}, worst margin "
        f"{margins[worst]:+.3f} ({names[worst]})",
        bool((margins >= -TIE).all()),
    )
