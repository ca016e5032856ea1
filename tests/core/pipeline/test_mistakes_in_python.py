"""Mistakes in Python. Otherwise a programmer would see a traceback of a library in place of the name that was meant."""

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
from tangible_core.errors import TangibleError
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
        (lambda: SemiGlobal(max_disparty_px=64), "max_disparty_px: unknown option (did you mean 'max_disparity_px'?)"),
        (lambda: SemiGlobal(max_disparity_px=-4), "max_disparity_px: Input should be greater than or equ"),
        (lambda: SemiGlobal(64), "write options with their names"),
        (lambda: load_method("render", "proxy")(stifness_n_per_m=3), "'stiffness_n_per_m'?"),
        (lambda: Mock(path="circl"), "'circle'?"),
        (lambda: Workspace(widht_m=0.1), "'width_m'?"),
        (lambda: Safety(max_forc_n=1), "'max_force_n'?"),
        (lambda: Pipeline(scene(), texure=None), "'texture'?"),
        (lambda: Pipeline(scene(), workspace={"widht_m": 1}), "'width_m'?"),
        (lambda: Scene.photo(GREY, rotat=90), "'rotate'?"),
        (lambda: Scene.photo(GREY, non_finite="msk"), "'mask'?"),
        (lambda: Pipeline(scene()).run("out", secnds=3), "'seconds'?"),
        (lambda: Pipeline(scene()).run("out", sheet="pgn"), "must be one of png, svg, pdf"),
        (lambda: Calibration(focal_px=1, basline_m=2), "'baseline_m'?"),
        (lambda: Calibration(focal_px=1), "baseline_m: is missing"),
        (lambda: Material("clay", stifness_n_per_m=1), "'stiffness_n_per_m'?"),
        (lambda: Relief(np.ones((2, 2), np.float32), (1, 1), 3), "is given 3 values"),
        (lambda: Calibration(1, focal_px=2, baseline_m=1), "focal_px: is given twice"),
        (lambda: Camera(matrx=np.eye(3)), "'matrix'?"),
        (lambda: Pipeline(scene()).feel(secnds=3), "'seconds'?"),
        (lambda: Pipeline(scene(), texture="hierarhcy"), "(did you mean 'hierarchy'?)"),
        (lambda: Pipeline(scene(), render={"use": "proxy", "radius": 1}), "'radius_m'?"),
        *(
            (lambda wrong=wrong: Pipeline(scene(), depth=wrong), "depth: takes a name, or an object of a class")
            for wrong in (Proxy(), Proxy, 3)
        ),
        (lambda: Pipeline(scene()).with_(rendr="proxy"), "'render'?"),
        (lambda: Pipeline(scene()).feel("mok"), "'mock'?"),
        (lambda: Pipeline(scene()).export("swell"), "write `export(folder, to=[NAMES])`"),
        (lambda: Pipeline.suited(), "name one, or left and right"),
        (lambda: Scene("x.png"), "files are read by Scene.photo(...)"),
        (lambda: Pipeline(scene()).make("surfce"), "'surface'?"),
        (lambda: load_method("rendr", "proxy"), "'render'?"),
        (lambda: flat().height_at([0, 1], [1, 2, 3]), "shapes (2,) and (3,)"),
        (lambda: DisparityMap(np.float32([[1, np.inf]])), "1 of 2 values is infinite"),
        (lambda: Views(np.int64([[1, 70_000]])), "from 1 to 70000"),
    ],
)  # fmt: skip
def test_mistake_is_one_sentence_of_ours(build: Callable[[], Any], sentence: str, unchecked_shapes: None):
    with pytest.raises(TangibleError) as caught:
        build()
    assert sentence in str(caught.value)
    assert "pydantic" not in str(caught.value)
    assert "\n" not in str(caught.value)


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
