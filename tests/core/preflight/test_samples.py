"""Samples, built-in scenes and photographs pass the preflight with their defaults."""

from pathlib import Path

import cv2
import numpy as np
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
    templates = {path for path, lines in texts.items() if "scene: $scene" in lines}
    return [path for path, named in keys.items() if {"scene", "render", "device"} <= named and path not in templates]


def test_samples_exist():
    assert {path.name for path in sample_files()} >= {"demo.yaml", "feel.yaml"}


def complaints(verdicts: Preflight) -> list[str]:
    """Return all complaints except those on the machine that runs the tests."""
    return [repr(each) for each in verdicts if each.verdict != "ok" and each.check not in ("jitter", "tick")]


@pytest.mark.parametrize("path", sample_files(), ids=lambda path: str(path.relative_to(ROOT)))
def test_sample_passes_preflight(path: Path):
    verdicts = load_pipeline(path).preflight(loop=Loop(seconds=0.05))
    assert len(verdicts) > 10
    assert complaints(verdicts) == []
    assert verdicts.sentence.startswith("Safe")


def test_first_file_of_the_readme_passes_preflight(tmp_path: Path):
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("# mine.yaml\n")[2].partition("```")[0]
    left, right = (Scene.builtin("motorcycle").views.left, Scene.builtin("motorcycle").views.right)
    cv2.imwrite(str(tmp_path / "left.png"), left[:, :, ::-1])
    cv2.imwrite(str(tmp_path / "right.png"), right[:, :, ::-1])
    (tmp_path / "mine.yaml").write_text(text)
    for more in ([], ["device={use: falcon-simulated}"]):
        verdicts = load_pipeline(tmp_path / "mine.yaml", more).preflight(loop=Loop(seconds=0.01))
        assert complaints(verdicts) == []
        assert verdicts.safe


@pytest.mark.parametrize("name", BUILTINS)
def test_builtin_scene_with_defaults_passes_preflight(name: str):
    scene = Scene.builtin(name)
    depth = SemiGlobal() if scene.views.right is not None else Luminance()
    pipeline = Pipeline(scene, depth=depth, texture=Gradient(segments=6), render=Proxy())
    for device in DEVICES:
        verdicts = pipeline.preflight(load_method("device", device)(), loop=Loop(seconds=0.01))
        assert complaints(verdicts) == []
        assert verdicts.safe


def photograph(rows: int, columns: int) -> np.ndarray:
    """Return a bright picture of soft hills, noise, stripes and sharp blocks, a quarter each: all that is steep."""
    random = np.random.default_rng(1)
    y, x = np.mgrid[:rows, :columns]
    hills = cv2.normalize(
        cv2.GaussianBlur(random.normal(size=(rows, columns)), (0, 0), rows / 40), None, 0, 255, cv2.NORM_MINMAX
    )
    noise, stripes = random.integers(0, 256, (rows, columns)), (x // 6 + y // 11) % 2 * 255
    blocks = (x // (columns // 8) + y // (rows // 8)) % 2 * 200 + 20
    top, left = y < rows // 2, x < columns // 2
    return np.select([top & left, top, left], [noise, hills, stripes], blocks).astype(np.uint8)


@pytest.mark.parametrize("size", [(120, 160), (400, 600)])
def test_photograph_with_the_roughest_materials_passes_preflight(size: tuple[int, int]):
    rows, columns = size
    quarters = (np.arange(rows)[:, None] * 2 // rows * 2 + np.arange(columns) * 2 // columns).astype(np.int32)
    scene = Scene.photo(photograph(rows, columns), segments=quarters)
    by = {0: "brick", 1: "carpet", 2: "glass", 3: "stone"}
    pipeline = Pipeline(scene, depth=Luminance(), materials=by, render=Proxy(), cached=False)
    for device in DEVICES:
        verdicts = pipeline.preflight(load_method("device", device)(), loop=Loop(seconds=0.01))
        assert complaints(verdicts) == []
        assert verdicts.safe
