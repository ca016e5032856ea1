"""`scene: {set: ..., folder: ..., name: ...}`: a pair of a standard set in a pipeline file."""

from pathlib import Path

import numpy as np
import pytest

from standard_sets import LAYOUTS, known
from tangible_core.errors import ConfigError
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene_files import SceneFiles


def parse(folder: Path, scene: str, rest: str = "") -> PipelineConfig:
    return parse_config(f"scene: {scene}\n{rest}", folder / "p.yaml", default_registry())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    LAYOUTS["kitti-2015"].make(tmp_path / "kitti-2015", known())
    LAYOUTS["sintel"].make(tmp_path / "films", known())
    return tmp_path


def test_set_scene_gives_views_truth_and_cameras_to_a_pipeline(folder: Path):
    scene = parse(folder, "{set: kitti-2015, name: 000000_10}").scene
    assert isinstance(scene, SceneFiles)
    assert scene.left == folder / "kitti-2015/training/image_2/000000_10.png"
    assert (scene.truth_scale, scene.focal_px, scene.order) == (256, 700, "as-named")
    assert scene.baseline_m == pytest.approx(0.545)
    config = parse(folder, "{set: sintel, folder: films, name: alley_1/frame_0001}", rest="depth: {use: semi-global}\n")
    pipeline = Pipeline.from_config(config, default_registry(), None)
    truth = known().pair.truth_px
    assert np.nanmax(np.abs(pipeline.scene.truth - truth)) < 1e-4
    found = pipeline.make("disparity").disparity_px
    assert np.nanmedian(np.abs(found - truth)) < 0.5


def test_set_scene_written_by_a_run_is_the_same(folder: Path):
    first = parse(
        folder, "{set: sintel, folder: films, name: alley_1/frame_0001, variant: clean, crop: [8, 4, 40, 30]}"
    )
    again = parse_config(first.as_yaml(), folder / "again.yaml", default_registry())
    assert again.scene == first.scene and again.scene.crop == (8, 4, 40, 30) and "clean_left" in str(first.scene.left)


@pytest.mark.parametrize(
    ("scene", "place", "why"),
    [
        ("{set: kitti, name: x}", "p.yaml:1:9", "did you mean"),
        ("{set: kitti-2015}", "p.yaml:1:1", "scene.name"),
        ("{set: eth3d, name: x}", "p.yaml:1:1", "two_view_training.7z"),
        ("{set: kitti-2015, name: x, left: a.png}", "p.yaml:1:35", "scene.left"),
    ],
)
def test_set_scene_with_a_mistake_is_refused_with_its_place(scene: str, place: str, why: str, folder: Path):
    with pytest.raises(ConfigError) as error:
        parse(folder, scene)
    assert place in str(error.value) and why in str(error.value)
