"""The mosaics that texture is measured on: of textures nothing was tuned on, and of the builtin ones."""

import os
from functools import cache
from pathlib import Path

from tangible_bench.tasks.texture import TextureScene
from tangible_core.testing.synthetic.texture_scenes import KnownSegments, smooth_scene

FOLDER = "TANGIBLE_TEXTURES"
"""Environment variable: folders with pictures of one texture each, with os.pathsep between them.

The first has eight or more that no method was tuned on.
"""
SEGMENTS = (2, 3, 4, 5, 6, 8)
SEEDS = (1, 3, 5, 7, 9)  # odd ones: methods are tuned on even ones
SIDE_PX = 512
SMOOTH_SEEDS = range(700, 716)


@cache
def held_out() -> dict[str, KnownSegments]:
    """Mosaics of the pictures in the first folder that FOLDER names; the builtin ones where it names none."""
    given = folders()
    return _mosaics(given[0]) if given else builtin()


def folders() -> list[Path]:
    """Return the folders that FOLDER names."""
    return [Path(word) for word in os.environ.get(FOLDER, "").split(os.pathsep) if word]


@cache
def builtin() -> dict[str, KnownSegments]:
    """Mosaics of scikit-image's brick, grass and gravel, and of textures made in code."""
    return _mosaics(None)


@cache
def smooth() -> dict[str, KnownSegments]:
    """Fourteen regions of one grey each, under light and noise."""
    return {f"smooth 14 seed {seed}": smooth_scene(14, (SIDE_PX, SIDE_PX), seed) for seed in SMOOTH_SEEDS}


def _mosaics(folder: Path | None) -> dict[str, KnownSegments]:
    specs = [TextureScene(mosaic=k, textures=folder, seed=100 * k + seed) for k in SEGMENTS for seed in SEEDS]
    return {name: scene.open() for spec in specs for name, scene in spec.expand().items()}
