"""Kernels before they are needed, and functions for fingers: a broken package would end a run without its name."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pluggy
import pytest

from tangible_core import Pipeline, Scene, Workspace
from tangible_core.compiled.background import LATE_STEPS, start_waiting
from tangible_core.errors import BrokenMethod
from tangible_core.pipeline.engine import warm_up as module
from tangible_core.pipeline.engine.hooked import judge_function, legibility_point, simplify_function
from tangible_core.pipeline.engine.warm_up import FELT, _work, run_stages
from tangible_core.plugins import DepthEstimator, hooks
from tangible_core.plugins.registry import Registry, default_registry
from tangible_depth import Luminance, SemiGlobal
from tangible_devices import Mock
from tangible_render import GreyLevel, Penalty
from tangible_texture import Gradient

ROOT = Path(__file__).parents[4]
PICTURE = np.kron(np.arange(16).reshape(4, 4) * 15 % 97, np.ones((12, 12))).astype(np.uint8)
COMPILED = """
import json, sys
from pathlib import Path
import numpy as np
from numba.core.dispatcher import Dispatcher
from tangible_core.data import DisparityMap
from tangible_core import Scene
from tangible_core.pipeline.config.parsing import load_config
from tangible_core.pipeline.engine.engine import Engine
from tangible_core.pipeline.engine.warm_up import warm_up, _work
from tangible_core.plugins.registry import default_registry
from tangible_core.session import run_simulated
from dataclasses import replace

config = load_config(Path(sys.argv[1]), default_registry(), ())
engine = Engine(config, default_registry())
work = _work(engine, "touch")
steps = list(work.function(*work.arguments))
added = []
add = Dispatcher.add_overload
def record_overload(self, result):
    added.append(f"{self.py_func.__module__}.{self.py_func.__qualname__}")
    add(self, result)
Dispatcher.add_overload = record_overload
views = engine.scene.views
rows, columns = np.indices(views.shape, np.float32)
scene = replace(engine.scene, disparity=DisparityMap(6 + 40 * (rows / rows.max()) * (columns / columns.max())))
real = Engine(config.with_values(scene=scene), default_registry())
touch = real.make("touch")
recording = run_simulated(touch, config.felt_device, 1.0, limits=config.safety)
print(json.dumps([steps, added, bool(np.any(recording.force_n))]))
"""


def test_warm_up_of_the_demo_compiles_every_kernel_after_depth():
    words = [sys.executable, "-c", COMPILED, str(ROOT / "configs" / "demo.yaml")]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    steps, added, has_force = json.loads(done.stdout)
    assert steps == ["segments", "touch", FELT]
    assert added == []
    assert has_force


FILLED = """
import json
import numpy as np
from numba.core.dispatcher import Dispatcher
from tangible_depth import SemiGlobal
from tangible_core.data import Views
from tangible_depth.dense.filling.gaps import fill_gaps
from tangible_depth.search.pairs import grey_pair

SemiGlobal(effort=EFFORT).rehearse()
added = []
Dispatcher.add_overload = lambda self, result: added.append(self.py_func.__qualname__)
matched = np.full((300, 400), -32768, np.int16)
matched[::3, 40:300:5], matched[20:90, 50:80] = 320, 480
picture = np.arange(120_000).reshape(300, 400).astype(np.uint8)
fill_gaps(matched, grey_pair(Views(picture, picture), "semi-global").left, EFFORT)
print(json.dumps(added))
"""


@pytest.mark.parametrize("effort", ["balanced", pytest.param("best", marks=pytest.mark.whole)])
def test_rehearsal_compiles_every_kernel_that_fills_gaps(effort: str):
    words = [sys.executable, "-c", FILLED.replace("EFFORT", repr(effort))]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == []


def pipeline(**methods) -> Pipeline:
    given = {"depth": Luminance(), "texture": Gradient(segments=4), "render": Penalty(), "device": Mock()} | methods
    return Pipeline(Scene.photo(PICTURE), workspace=Workspace(width_m=0.04), cached=False, **given)


class TestWork:
    @pytest.mark.parametrize(
        ("methods", "want", "steps"),
        [
            ({}, "touch", ["segments", "touch", FELT]),
            ({}, "segments", ["segments"]),
            ({"render": GreyLevel(), "device": None, "texture": None}, "touch", ["touch", FELT]),
        ],
    )
    def test_work_has_the_wanted_stages_that_the_law_needs(self, methods: dict, want, steps: list[str]):
        work = _work(pipeline(**methods).engine, want)
        assert work is not None and work.names == set(steps)
        assert list(run_stages(*work.arguments)) == steps

    def test_work_without_anything_to_compile_or_of_begun_stages_is_left_out(self, monkeypatch: pytest.MonkeyPatch):
        made = pipeline()
        assert made.segments is not None
        work = _work(made.engine, "touch")
        assert work is not None
        assert work.names == {"touch", FELT}
        assert made.touch is not None
        assert _work(made.engine, "touch") is None
        labelled = Scene.photo(PICTURE, segments=(PICTURE > 40).astype(np.uint8))
        for made, want in (
            (pipeline(texture=None), "surface"),
            (Pipeline(labelled, depth=Luminance(), texture=Gradient(), cached=False), "segments"),
            (Pipeline(Scene.heights(np.eye(8)), render=Penalty(), cached=False), "touch"),
        ):
            assert _work(made.engine, want) is None
        monkeypatch.setattr("tangible_core.compiled.threads.thread_count", lambda: 1)
        assert _work(pipeline().engine, "touch") is None

    def test_work_of_a_begun_depth_rehearses_the_middle_of_a_picture(self, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr(module, "MAX_PX", 20)
        work = _work(pipeline().engine, "touch")
        assert work is not None
        assert np.array_equal(work.arguments[1].left, PICTURE[14:34, 14:34])
        engine = pipeline(depth=SemiGlobal()).engine
        engine.starts.add("disparity")
        rehearsed: list[SemiGlobal] = []
        monkeypatch.setattr(SemiGlobal, "rehearse", lambda self: rehearsed.append(self))
        work = _work(engine, "segments")
        assert work is not None
        assert work.names == {LATE_STEPS, "segments"}
        assert next(run_stages(*work.arguments)) == LATE_STEPS
        assert rehearsed == [SemiGlobal()]


class Loud(DepthEstimator):
    """Says that kernels are compiled, as if they were, and finds what `luminance` does."""

    finds_depth = False

    def estimate(self, views):
        start_waiting()
        return Luminance().estimate(views)


def test_run_is_the_same_with_and_without_warm_up(tmp_path: Path):
    alone = pipeline().run(tmp_path / "alone", seconds=0.5)
    made = pipeline(depth=Loud())
    beside = made.run(tmp_path / "beside", seconds=0.5)
    assert made.engine.compiler is not None
    child = made.engine.compiler._child
    assert child is not None
    assert child.returncode is not None
    for product in ("disparity", "segments", "surface"):
        assert beside.products[product].digest() == alone.products[product].digest()
    assert alone.recording is not None
    assert beside.recording is not None
    assert np.array_equal(beside.recording.rows, alone.recording.rows, equal_nan=True)


def test_run_without_compiling_starts_no_process_and_make_warms_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    pipeline().run(tmp_path / "first", seconds=0.1)
    made = pipeline()
    made.run(tmp_path / "second", seconds=0.1)
    assert made.engine.compiler is not None
    assert made.engine.compiler._child is None
    asked: list[str] = []
    monkeypatch.setattr(module, "_work", lambda _, want: asked.append(want))
    assert pipeline(depth=Loud()).touch is not None
    assert asked == ["touch"]


class Rules:
    def __init__(self, **functions):
        self.functions = functions

    @hooks.hookimpl
    def tangible_legibility(self):
        return self.functions


def registry(*rules: Rules) -> Registry:
    plugins = pluggy.PluginManager("tangible")
    plugins.add_hookspecs(hooks.Specs)
    for rule in rules:
        plugins.register(rule)
    return Registry(plugins)


def test_first_answer_counts_and_an_answer_without_the_name_is_passed_over():
    chosen = legibility_point(registry(Rules(judge="a:b"), Rules(simplify="c:d"), Rules(simplify="e:f")), "simplify")
    assert chosen.value == "c:d"
    assert callable(judge_function(default_registry())) and callable(simplify_function(default_registry()))


@pytest.mark.parametrize(
    ("rules", "why"),
    [
        ((), "no hook tangible_legibility names a function to simplify parts"),
        ((Rules(simplify="nothing.here:f"),), "nothing.here:f, which tangible_legibility names .*No module named"),
        ((Rules(simplify="math:nothing"),), "math:nothing, which tangible_legibility names .*no attribute"),
    ],
)
def test_missing_function_is_named(rules, why):
    with pytest.raises(BrokenMethod, match=why):
        simplify_function(registry(*rules))
