"""The plan of a comparison: keys of the same content, and scenes that cannot be read; and the row of a key."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_bench.config.reading import Comparison, parse_comparison
from tangible_bench.measuring.plan import measurements
from tangible_bench.tasks.depth_scenes import DepthScene
from tangible_core.errors import ConfigError
from tangible_core.plugins.registry import Registry


def parse(registry: Registry, folder: Path, *scenes: str) -> Comparison:
    text = f"compare: depth\nmethods: [constant]\nscenes: [{', '.join(scenes)}]\nrepeats: 1\nwarmups: 0\ncalls: 1\n"
    return parse_comparison(text, folder / "c.yaml", registry)


def pair(folder: Path, name: str) -> str:
    """A scene of two files of this name, whose pictures are always the same."""
    for side, seed in (("left", 0), ("right", 1)):
        grey = np.random.default_rng(seed).integers(0, 255, (24, 32), np.uint8)
        Image.fromarray(grey).save(folder / f"{name}{name}_{side}.png")
    return f"{{pairs: {{left: '{name}*_left.png', right: '{name}*_right.png'}}}}"


def test_same_pictures_under_another_name_are_measured_once(registry: Registry, tmp_path: Path):
    one, other = (measurements(parse(registry, tmp_path, pair(tmp_path, name))) for name in ("a", "b"))
    assert [each.row.key for each in one] == [each.row.key for each in other]
    assert one[0].row.scene != other[0].row.scene


def test_all_scenes_that_cannot_be_read_are_named(registry: Registry, tmp_path: Path):
    scenes = [pair(tmp_path, name) for name in ("a", "b", "c")]
    for name in ("aa_left", "cc_right"):
        (tmp_path / f"{name}.png").write_bytes(b"no picture")
    with pytest.raises(ConfigError) as error:
        measurements(parse(registry, tmp_path, *scenes))
    assert len(error.value.args) == 2
    assert "aa_left.png" in error.value.args[0] and "cc_right.png" in error.value.args[1]


def test_pair_of_a_folder_has_the_truth_beside_it(tmp_path: Path):
    for side in ("left", "right"):
        Image.fromarray(np.full((24, 32), 90, np.uint8)).save(tmp_path / f"{side}.png")
    np.savez(tmp_path / "disparity.npz", disparity=np.full((24, 32), 3, np.float32))
    assert (DepthScene(folder=tmp_path).open().truth_px == 3).all()
