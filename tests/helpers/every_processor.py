"""What every method finds, written down: a program, run once a dispatch by `test_every_processor.py`.

    python tests/helpers/every_processor.py FOLDER THREADS [PART ...]

FOLDER/digests.json holds a digest of each result, by name; FOLDER/arrays.npz the results of torch's methods, which are
compared within a tolerance. Pictures are files that come with scikit-image, and surface and path are whole numbers over
powers of two: only what is measured can differ.
"""

import json
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from shapely import get_coordinates

from compiled_once import compile_once
from tangible_core import load_method
from tangible_core.compiled import threads
from tangible_core.data import DisparityMap, HapticSurface, Relief, SegmentMap, Views, digest_of
from tangible_core.data.pictures import to_grey, to_rgb8
from tangible_core.materials.assignment import library, relative_roughness
from tangible_core.materials.rules import segment_colours
from tangible_core.parts import HeightChoice, Layering, depth_heights, find_parts, guess_heights, reduced_parts
from tangible_core.plugins.interfaces import Filming
from tangible_core.plugins.registry import default_registry
from tangible_core.preflight.bumps import feature_m
from tangible_core.scene.geometry import make_relief, normals, resample, slopes, smooth
from tangible_core.scene.scaling import enlarged_segments, on_grid, reduce_views, to_picture_pixels
from tangible_core.scene.scene import Scene
from tangible_depth.rectify.projective import warp_pair
from tangible_depth.rectify.rectification import rectify
from tangible_depth.rectify.rectifying_rotation import aligning_lenses
from tangible_depth.sparse.harris import harris_response
from tangible_depth.sparse.matches import flow_matches, inverse_lengths, sift_matches
from tangible_export.paper.borders import shared_borders
from tangible_render.haptic_textures import compile_textures, radial_spectrum, sample_tile, stroke

Found = Iterator[tuple[str, Any]]
SIZE = slice(122, 314), slice(232, 488)
"""Of the motorcycle: the part that has most in it."""

SLOW = {"kornia-report", "kornia-zncc", "report"}
"""Methods by which others are measured."""


@cache
def scene(name: str) -> Scene:
    return Scene.builtin(name)


@cache
def pair() -> Views:
    views = scene("motorcycle").views
    return Views(views.left[SIZE], views.right[SIZE], views.calibration)


@cache
def noisy_pair() -> Views:
    """The same with noise, the right view darker and two rows lower: for all that pairs are put right by."""
    noise = np.random.default_rng(0).integers(-12, 13, (2, *pair().left.shape))
    views = pair().left, np.roll(pair().right, 2, axis=0).astype(int) * 7 // 8
    return Views(*(np.clip(view + more, 0, 255).astype(np.uint8) for view, more in zip(views, noise, strict=True)))


@cache
def mosaic() -> np.ndarray:
    """Four textures side by side and over each other, (h, w)."""
    parts = [scene(name).views.left[:128, :144] for name in ("brick", "grass", "gravel", "coins")]
    return np.block([parts[:2], parts[2:]])


@cache
def labels() -> np.ndarray:
    """Of the mosaic."""
    rows, columns = np.indices(mosaic().shape)
    return (2 * (rows >= 128) + (columns >= 144)).astype(np.int32)


@cache
def surface(covered: bool = True) -> HapticSurface:
    """Hills with a step in them, and materials of every kind of texture."""
    rows, columns = np.indices((96, 128))
    hills = (rows * (95 - rows) * columns * (127 - columns) // 4096) % 1500 + 300 * (columns > 80)
    plain = HapticSurface.from_heights(hills / 2.0**17, 0.08)
    some = tuple({each.texture: each for each in library().values()}.values())
    return HapticSurface(plain.relief, (rows // 20 % len(some)).astype(np.int32), some) if covered else plain


@cache
def path() -> np.ndarray:
    """A hand that goes to and fro, in and out of the surface: (n, 3) metres."""
    tick = np.arange(6000)

    def swing(period: int) -> np.ndarray:
        return np.abs(tick % (2 * period) - period) / period - 0.5

    return np.column_stack([0.078 * swing(701), 0.058 * swing(277), 0.006 + 0.016 * swing(1013)])


def ours(kind: Any) -> Iterator[tuple[str, type[Any], dict[str, Any]]]:
    """Name, class and options of every method that comes with this distribution."""
    for listing in default_registry().listings:
        if listing.kind == kind and listing.distribution == "tangible-images":
            cls: Any = load_method(kind, listing.name)
            if listing.name in ("auto", "onnx"):  # another one's, or those of a network that the user brings
                continue
            yield listing.name, cls, {"torch_device": "cpu"} if "torch_device" in cls.model_fields else {}


def pictures() -> Found:
    rgb = pair().left[:64, :65]
    rgba = np.dstack([rgb, np.random.default_rng(1).integers(0, 256, (64, 65, 1), np.uint8)])
    for name, picture in (("rgb", rgb), ("rgba", rgba), ("floats", rgb / 255.0)):
        yield f"grey of {name}", to_grey(picture)
        yield f"8 bits of {name}", to_rgb8(picture)
    rows, columns = np.indices(pair().shape)
    parts = SegmentMap((rows // 32 * 10 + columns // 32).astype(np.int32))
    yield "names of colours", tuple(segment_colours(parts, pair().left))


def depth() -> Found:
    left, right = to_grey(noisy_pair().left), to_grey(np.asarray(noisy_pair().right))
    yield "corners, the response", harris_response(left)
    yield "corners, lengths of windows", inverse_lengths(left, 4)
    yield "matches by flow", tuple(flow_matches(left, right))
    yield "matches by SIFT", tuple(sift_matches(left, right))
    turned = rectify(noisy_pair())
    yield "rectified", (turned.left_homography, turned.right_homography, turned.views)
    pairs_of_points = sift_matches(left, right)
    yield "rectified, lenses", aligning_lenses(pairs_of_points, left.shape, 0.0, (-0.08, -0.08))
    straight = turned.left_homography, turned.right_homography
    yield "rectified, lenses taken out", warp_pair(noisy_pair(), straight, "", 0, (-0.1, -0.08)).views
    for name, cls, options in ours("depth"):
        for of, views in (("pair", pair()), ("noisy pair", noisy_pair())):
            if of == "pair" and name in SLOW:  # on the way to the noisy one's map lies all of this one's
                continue
            found = cls(**options).estimate(views)
            yield f"{name}: disparity of the {of}", found.disparity_px
            yield f"{name}: confidence of the {of}", found.confidence
    for of, views in (("pair", pair()), ("noisy pair", noisy_pair())):
        found = load_method("depth", "semi-global")(effort="best").estimate(views)
        yield f"semi-global, the best effort: {of}", found


def texture() -> Found:
    for name, cls, options in ours("texture"):
        for of, picture, number in (("mosaic", mosaic(), {"segments": 4}), ("colour picture", pair().left, {})):
            segments = cls(**number, **options).segment(picture)
            yield f"{name}: labels of the {of}", segments.labels
            yield f"{name}: confidence of the {of}", segments.confidence


def reliefs() -> Found:
    found = load_method("depth", "semi-global")().estimate(pair())
    relief = make_relief(found, pair().calibration, 0.08, 0.02)
    yield "relief", relief
    yield "relief, smoothed", smooth(relief, 0.001)
    yield "relief, resampled", resample(relief, (101, 87))
    yield "relief, slopes", slopes(relief)
    yield "relief, normals", normals(relief)
    yield "relief, features", feature_m(relief, 0.0032)
    small = reduce_views(pair(), 3)
    yield "views, reduced", small
    yield "views of 16 bits, reduced", reduce_views(Views(pair().left.astype(np.uint16) * 257), 3)
    yield "views of floats, reduced", reduce_views(Views(np.asarray(pair().left / 255, np.float32)), 3)
    disparity = load_method("depth", "semi-global")().estimate(small)
    yield "disparity, enlarged", on_grid(to_picture_pixels(disparity, pair().shape[1]), pair().shape)
    segments = SegmentMap(labels(), np.asarray(mosaic() / 255, np.float32))
    yield "segments, enlarged", enlarged_segments(segments, (300, 331))
    yield "relative roughness", relative_roughness(segments, mosaic())


def layers() -> Found:
    left, truth = pair().left, scene("motorcycle").truth
    segments = SegmentMap((to_grey(left) * 6).astype(np.int32))
    parts = find_parts(segments)
    yield "parts", parts
    yield "parts, reduced", reduced_parts(parts, (100, 131))
    yield (
        "parts, borders",
        tuple(get_coordinates(shared_border) for shared_border in shared_borders(parts, 0.08, 0.0005)),
    )
    guess = guess_heights(parts, 0.004)
    yield "parts, heights guessed", guess
    yield "parts, heights by depth", depth_heights(parts, DisparityMap(truth[SIZE]), 0.004)
    yield "parts, relief", Layering(parts, 0.08, HeightChoice(by="guess"), left).relief(guess.heights_m)


def render() -> Found:
    for name, cls, options in ours("render"):
        for of, felt in (("plain", surface(False)), ("covered", surface())):
            yield f"{name}: forces on a {of} surface", cls(**options).touch(felt).path(path())
            if issubclass(cls, Filming):
                film = cls(**options).film(felt)
                film.show(Relief(felt.height_m[::-1].copy(), felt.extent_m), 1)
                yield f"{name}: forces of a film on a {of} surface", film.touch.path(path())


def haptic_textures() -> Found:
    yield "table of haptic textures", compile_textures(tuple(library().values()))
    for name, material in library().items():
        tile = sample_tile(material, 0.01, 64)
        yield f"{name}: tile", tile
        yield f"{name}: spectrum", radial_spectrum(tile, 0.01)
        yield f"{name}: stroke", tuple(stroke(material, direction_deg=30.0))


PARTS: dict[str, Callable[[], Found]] = {
    each.__name__: each for each in (pictures, depth, texture, reliefs, layers, render, haptic_textures)
}


def main(folder: str, thread_count: str, *wanted: str) -> None:
    """Write down what all parts find, or those named."""
    compile_once()
    threads.thread_count = lambda: int(thread_count)
    found = {name: result for part in wanted or PARTS for name, result in PARTS[part]()}
    torch = {name for kind in ("depth", "texture") for name, _, options in ours(kind) if options}
    arrays = {name: result for name, result in found.items() if name.split(":")[0] in torch}
    np.savez(Path(folder, "arrays.npz"), **arrays)
    digests = {name: digest_of(result) for name, result in found.items() if name not in arrays}
    Path(folder, "digests.json").write_text(json.dumps(digests, indent=1))


if __name__ == "__main__":
    main(*sys.argv[1:])
