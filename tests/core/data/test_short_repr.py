"""Objects in a line, without the numbers of their arrays."""

import numpy as np
import pytest

from tangible_core import HapticSurface, Pipeline, Scene, Views
from tangible_core.data import DisparityMap, Material, MaterialMap, Record, SegmentMap
from tangible_depth import Luminance
from tangible_render import Penalty

GREY = np.arange(6000, dtype=np.uint8).reshape(60, 100)
ICE = Material("ice", 1000.0, 1.0, 0.1, 0.05, texture="smooth")


def records() -> list[Record]:
    disparity = np.linspace(0, 5, 6000, dtype=np.float32).reshape(60, 100)
    return [
        Views(GREY, GREY),
        DisparityMap(np.where(disparity < 1, np.float32(np.nan), disparity)),
        SegmentMap(np.zeros((60, 100), np.int32)),
        MaterialMap((ICE,) * 50, ("because",) * 50),
        HapticSurface.from_heights(np.zeros((60, 100)), labels=np.zeros((60, 100), np.int32), materials=(ICE,)),
    ]


@pytest.mark.parametrize("record", records(), ids=lambda each: type(each).__name__)
def test_record_is_shown_in_a_short_line(record: Record):
    assert repr(record).startswith(f"{type(record).__name__}(")
    assert len(repr(record)) < 250
    assert "array" not in repr(record)
    assert "\n" not in repr(record)


def test_scene_and_pipeline_are_shown_in_a_short_line():
    scene = Scene.photo(GREY)
    assert repr(scene) == "Scene(name='arrays', views=Views(left=<uint8 (60, 100), 0 to 255>))"
    pipeline = Pipeline(scene, depth=Luminance(), cached=False)
    assert repr(pipeline) == "Pipeline('arrays', want='surface', depth='luminance')"
    assert repr(pipeline.config) == "PipelineConfig('arrays', want='surface', depth='luminance')"


def test_touch_is_shown_by_its_kernel():
    surface = HapticSurface.from_heights(np.zeros((6, 10)))
    assert repr(Penalty().touch(surface)) == "CompiledTouch(tangible_render.kernels.penalty.tick)"


def test_range_of_an_array_leaves_out_unknown_numbers():
    assert "<float32 (60, 100), 1 to 5, some NaN>" in repr(records()[1]).replace("1.00017", "1")
