"""Samples and built-in scenes. Otherwise the first surface that somebody tries would be unsafe."""

from pathlib import Path

import pytest

from tangible_core import Pipeline, Scene, load_method, load_pipeline
from tangible_core.preflight import Loop, Preflight
from tangible_core.scene.scene_files import BUILTINS
from tangible_depth import Luminance, SemiGlobal
from tangible_render import Proxy
from tangible_texture import Gradient

ROOT = Path(__file__).parents[3]
FOLDERS = "configs", "tangible_core"
DEVICES = "mock", "falcon-simulated"


def sample_files() -> list[Path]:
    """Return the samples with a force law and a device; examples name devices that are installed with them."""
    files = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.yaml"))]
    texts = {path: path.read_text(encoding="utf-8").splitlines() for path in files}
    keys = {path: {line.partition(":")[0] for line in lines} for path, lines in texts.items()}
    templates = {path for path, lines in texts.items() if any(line.startswith("scene: $scene") for line in lines)}
    return [path for path, named in keys.items() if {"scene", "render", "device"} <= named and path not in templates]


def complaints(verdicts: Preflight) -> list[str]:
    """Return all complaints except those on the machine that runs the tests."""
    return [
        repr(verdict) for verdict in verdicts if verdict.verdict != "ok" and verdict.check not in ("jitter", "tick")
    ]


@pytest.mark.parametrize("path", sample_files(), ids=lambda path: str(path.relative_to(ROOT)))
def test_sample_passes_preflight(path: Path):
    verdicts = load_pipeline(path).preflight(loop=Loop(seconds=0.05))
    assert len(verdicts) > 10
    assert complaints(verdicts) == []
    assert verdicts.sentence.startswith("Safe")


@pytest.mark.whole
@pytest.mark.parametrize("name", BUILTINS)
def test_builtin_scene_with_defaults_passes_preflight(name: str):
    scene = Scene.builtin(name)
    depth = SemiGlobal() if scene.views.right is not None else Luminance()
    pipeline = Pipeline(scene, depth=depth, texture=Gradient(segments=6), render=Proxy())
    for device in DEVICES:
        verdicts = pipeline.preflight(load_method("device", device)(), loop=Loop(seconds=0.01))
        assert complaints(verdicts) == []
        assert verdicts.safe
