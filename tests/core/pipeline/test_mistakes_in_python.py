"""Mistakes in Python: one sentence with the name that was probably meant, and the plugin that failed."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tangible_core import (
    Calibration,
    Camera,
    DisparityMap,
    HapticSurface,
    Material,
    Pipeline,
    Relief,
    Scene,
    Workspace,
    load_method,
)
from tangible_core.data import Force, HapticState, Views
from tangible_core.errors import OptionError, TangibleError
from tangible_core.plugins.interfaces import DepthEstimator, ForceRenderer, PlainTouch, Touch
from tangible_core.servo import Safety
from tangible_depth import Luminance, SemiGlobal
from tangible_devices import Mock
from tangible_render import Proxy

GREY = np.arange(240, dtype=np.uint8).reshape(12, 20)


def scene() -> Scene:
    return Scene.photo(GREY)


def flat() -> HapticSurface:
    return HapticSurface.from_heights(np.zeros((4, 4)))


@pytest.mark.parametrize(
    ("build", "sentence"),
    [
        (lambda: SemiGlobal(max_disparty_px=64), "SemiGlobal: max_disparty_px: unknown option (did you mean 'max_d"),
        (lambda: SemiGlobal(max_disparity_px=-4), "SemiGlobal: max_disparity_px: Input should be greater than or equ"),
        (lambda: SemiGlobal(64), "SemiGlobal: write options with their names, such as max_disparity_px=..."),
        (lambda: load_method("render", "proxy")(stifness_n_per_m=3), "(did you mean 'stiffness_n_per_m'?)"),
        (lambda: Mock(path="circl"), "Mock: path: Input should be 'raster', 'circle'"),
        (lambda: Mock(path="circl"), "not 'circl' (did you mean 'circle'?)"),
        (lambda: Workspace(widht_m=0.1), "Workspace: widht_m: unknown option (did you mean 'width_m'?)"),
        (lambda: Safety(max_forc_n=1), "Safety: max_forc_n: unknown option (did you mean 'max_force_n'?)"),
        (lambda: Pipeline(scene(), texure=None), "texure: is not a key of the pipeline file (did you mean 'texture'?)"),
        (lambda: Pipeline(scene(), workspace={"widht_m": 1}), "workspace.widht_m: unknown option (did you mean 'width"),
        (lambda: Scene.photo(GREY, rotat=90), "Scene.photo: rotat: unknown option (did you mean 'rotate'?)"),
        (lambda: Scene.photo(GREY, non_finite="msk"), "Input should be 'error' or 'mask', not 'msk' (did you mean"),
        (lambda: Pipeline(scene()).run("out", secnds=3), "Pipeline.run: secnds: unknown option (did you mean 'sec"),
        (lambda: Pipeline(scene()).run("out", sheet="pgn"), "sheet: is the str 'pgn'; it must be one of png, svg, pdf"),
        (lambda: Calibration(focal_px=1, basline_m=2), "Calibration: basline_m: unknown field (did you mean 'base"),
        (lambda: Calibration(focal_px=1), "Calibration: baseline_m: is missing; its fields: focal_px, baseline_m"),
        (lambda: Material("clay", stifness_n_per_m=1), "Material: stifness_n_per_m: unknown field (did you mean 'sti"),
        (lambda: Relief(np.ones((2, 2), np.float32), (1, 1), 3), "Relief: is given 3 values; its fields: height_m, ex"),
        (lambda: Calibration(1, focal_px=2, baseline_m=1), "Calibration: focal_px: is given twice; its fields: focal_"),
        (lambda: Camera(matrx=np.eye(3)), "Camera: matrx: unknown field (did you mean 'matrix'?); its fields: matrix,"),
        (lambda: Pipeline(scene()).feel(secnds=3), "secnds: unknown option (did you mean 'seconds'?)"),
        (lambda: Pipeline(scene(), texture="hierarchy"), "texture: takes an object, not the name 'hierarchy'; `load_m"),
        (lambda: Pipeline(scene(), depth=Proxy()), "depth: takes an object of a class of DepthEstimator, not Proxy("),
        (lambda: Pipeline(scene()).make("surfce"), "no product is named 'surfce' (did you mean 'surface'?); known: d"),
        (lambda: load_method("rendr", "proxy"), "no kind of methods is named 'rendr' (did you mean 'render'?); known"),
        (lambda: flat().height_at([0, 1], [1, 2, 3]), "x_m and y_m: shapes (2,) and (3,) do not go together"),
        (lambda: DisparityMap(np.float32([[1, np.inf]])), "disparity_px: 1 of 2 values is infinite; write NaN where"),
        (lambda: Views(np.int64([[1, 70_000]])), "left view: holds whole numbers from 1 to 70000"),
    ],
)  # fmt: skip
def test_mistake_is_one_sentence_of_ours(build: Callable[[], Any], sentence: str, unchecked_shapes: None):
    with pytest.raises(TangibleError) as caught:
        build()
    assert sentence in str(caught.value)
    assert "pydantic" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_options_with_several_mistakes_have_a_sentence_each():
    with pytest.raises(OptionError) as caught:
        Proxy(stifness_n_per_m=3, texture="yes please")  # pyright: ignore[reportCallIssue]
    assert len(caught.value.args) == 2


def test_options_error_is_a_value_error_for_those_who_catch_one():
    with pytest.raises(ValueError, match="unknown option"):
        Mock(pth="circle")  # pyright: ignore[reportCallIssue]


class BrokenDepth(DepthEstimator):
    """A method with a bug."""

    def estimate(self, views: Views) -> DisparityMap:
        """Fail."""
        raise ZeroDivisionError("a bug")


class BrokenTouch(PlainTouch):
    """A touch with a bug."""

    def force(self, state: HapticState) -> Force:
        """Fail."""
        raise ZeroDivisionError("a bug")


class BrokenLaw(ForceRenderer):
    """A force law with a bug."""

    def touch(self, surface: HapticSurface) -> Touch:
        """Return the touch that fails."""
        return BrokenTouch()


def test_method_that_raises_is_named():
    with pytest.raises(ZeroDivisionError) as caught:
        Pipeline(scene(), depth=BrokenDepth(), cached=False).make("disparity")
    assert caught.value.__notes__ == [f"{__name__}.BrokenDepth failed in estimate"]


@pytest.mark.parametrize("in_real_time", [False, True])
def test_force_law_that_raises_is_named(in_real_time: bool):
    pipeline = Pipeline(scene(), depth=Luminance(), render=BrokenLaw(), cached=False)
    with pytest.raises(Exception, match="a bug") as caught:
        pipeline.feel(Mock(), 0.05, in_real_time=in_real_time)
    assert f"{__name__}.BrokenTouch failed in force" in [*caught.value.__notes__, str(caught.value)]
