"""Comparison files and their plan: keys, scenes that cannot be opened, and the messages on wrong ones."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from standard_sets import put
from tangible_bench.config.reading import Comparison, load_comparison, parse_comparison
from tangible_bench.measuring.plan import measurements
from tangible_bench.tasks.depth_scenes import DepthScene
from tangible_core.errors import ConfigError
from tangible_core.plugins.registry import Registry

PATH = Path("here/c.yaml")
GOOD = "compare: depth\nmethods: [constant]\nscenes: [synthetic/steps]\n"


def parse(text: str, registry: Registry, *overrides: str) -> Comparison:
    return parse_comparison(text, PATH, registry, overrides)


def complaints(text: str, registry: Registry) -> list[str]:
    with pytest.raises(ConfigError) as error:
        parse(text, registry)
    return str(error.value).splitlines()


def test_file_sets_every_field_that_has_defaults(registry: Registry):
    found = parse(GOOD, registry)
    assert [method.label for method in found.methods] == ["constant"]
    assert list(found.scenes) == ["steps 480x360"] and [damage.name for damage in found.damages] == ["none"]
    assert (found.protocol.repeats, found.protocol.warmups, found.baseline, found.out) == (5, 1, None, Path("out/c"))
    text = """\
compare: depth
methods:
  - constant
  - {use: constant, label: other, value_px: 2}
scenes: [{synthetic: planes, width_px: 64, height_px: 48, seed: 3}, builtin/motorcycle]
perturb: [none, {noise: [2, 5]}, {shift: -0.5, gain: 0.8}]
repeats: 2
warmups: 0
calls: 1
timeout_s: 10
fill: [other]
baseline: constant
out: ../results
"""
    found = parse(text, registry)
    assert [method.label for method in found.methods] == ["constant", "other"]
    assert list(found.scenes) == ["planes 64x48 seed 3", "builtin/motorcycle"]
    assert [damage.name for damage in found.damages] == ["none", "noise 2", "noise 5", "shift -0.5", "gain 0.8"]
    assert (found.finishes, found.baseline) == ({"fill": {"other"}}, "constant")
    assert found.out == Path("results")


def test_sweep_gives_a_method_for_each_grid_point(registry: Registry):
    text = GOOD.replace("[constant]", "[{use: constant, label: c, sweep: {value_px: [1, 2], seconds: [0, 0.5]}}]")
    found = parse(text, registry)
    assert [method.label for method in found.methods] == [
        "c value_px=1 seconds=0",
        "c value_px=1 seconds=0.5",
        "c value_px=2 seconds=0",
        "c value_px=2 seconds=0.5",
    ]
    assert [method.choice.method.model_dump() for method in found.methods][3] == {"value_px": 2.0, "seconds": 0.5}


def test_file_with_many_mistakes_reports_all_with_places(registry: Registry):
    text = """\
compare: depth
methods:
  - constnt
  - use: constant
    valu_px: 3
  - use: constant
    sweep:
      value_px: [1, wide]
  - constant
  - constant
scenes:
  - synthetic/stairs
  - {synthetic: steps, width_px: 1}
perturb:
  - {noise: [2, -1]}
  - {blurr: 1}
repeats: 0
filll: [constant]
fill: [constat]
baseline: constat
"""
    found = complaints(text, registry)
    assert {line.split(": ")[0]: line for line in found}.keys() == {
        f"here/c.yaml:{place}"
        for place in ("3:5", "5:5", "8:7", "10:5", "12:5", "13:24", "15:6", "16:6", "17:1", "18:1", "19:8", "20:1")
    }
    text = "\n".join(found)
    assert "did you mean 'constant'?" in text
    assert "unknown option (did you mean 'value_px'?)" in text
    assert "two methods are called 'constant'" in text
    assert "did you mean 'blur'?" in text
    assert "did you mean 'fill'?" in text
    assert "noise: standard deviation in grey levels of 255, both views, above 0, not -1" in text
    assert "no method here is called 'constat' (did you mean 'constant'?)" in text


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        ("", "1:1", "`compare:`"),
        ("methods: [constant]\n", "1:1", "`compare:`"),
        ("compare: dept\n", "1:1", "'depth'"),
        ("compare: export\n", "1:1", "exporters"),
        ("compare: device\n", "1:1", "stress"),
        (GOOD.replace("methods: [constant]\n", ""), "1:1", "missing"),
        (GOOD.replace("[constant]", "constant"), "2:1", "list"),
        (GOOD.replace("[constant]", "[]"), "2:1", "list"),
        (GOOD.replace("constant", "{use: constant, sweep: [1]}"), "2:27", "`sweep:`"),
        (GOOD.replace("constant", "{use: constant, sweep: {seconds: 1}}"), "2:27", "`sweep:`"),
        (GOOD.replace("constant", "{use: constant, label: [1]}"), "2:27", "label"),
        (GOOD.replace("constant", "{use: ranged, given: [seed]}"), "2:25", "'seed'"),
        (GOOD.replace("constant", "{use: ranged, given: 3}"), "2:25", "max_disparity_px"),
        (GOOD.replace("constant", "{use: half, given: [value_px]}"), "2:23", "nothing"),
        (GOOD + "perturb: [loud]\n", "4:11", "none"),
        (GOOD + "perturb: [{noise: loud}]\n", "4:12", "'loud'"),
        (GOOD + "out: [1]\n", "4:1", "folder"),
        (GOOD.replace("synthetic/steps", "motorcycle"), "3:10", "'motorcycle'"),
        (GOOD.replace("synthetic/steps", "{folder: nowhere}"), "3:10", "left.png"),
        (GOOD.replace("synthetic/steps", "synthetic/steps, synthetic/steps"), "3:27", "two scenes"),
        (GOOD.replace("synthetic/steps", "{builtin: a, folder: b}"), "3:10", "one of builtin"),
    ],
)
def test_file_with_one_mistake_reports_its_place(registry: Registry, text: str, place: str, what: str):
    found = complaints(text, registry)
    assert found[0].startswith(f"here/c.yaml:{place}: ") and what in found[0], found


def test_override_replaces_a_key(registry: Registry):
    assert parse(GOOD, registry, "repeats=2").protocol.repeats == 2
    assert list(parse(GOOD, registry, "scenes=[synthetic/bars]").scenes) == ["bars 480x360"]
    with pytest.raises(ConfigError, match=r"methods is a list; set it as a whole: methods=\[...\]"):
        parse(GOOD, registry, "methods.0.value_px=3")


def test_folder_of_pairs_gives_a_scene_each(registry: Registry, tmp_path: Path):
    def load(scenes: str) -> Comparison:
        (tmp_path / "c.yaml").write_text(GOOD.replace("synthetic/steps", scenes))
        return load_comparison(tmp_path / "c.yaml", registry)

    truth = np.full((20, 30), 3, np.float32)
    for name, kind in (("b", "npy"), ("a", "png")):
        (tmp_path / "pairs" / name).mkdir(parents=True)
        for side in ("left", "right"):
            put(tmp_path / f"pairs/{name}/{side}.png", np.zeros(truth.shape, np.uint8))
        truth[0, :5] = 0 if kind == "png" else np.nan
        path = tmp_path / f"pairs/{name}/disparity.{kind}"
        np.save(path, truth) if kind == "npy" else put(path, truth.astype(np.uint8))
    (tmp_path / "pairs" / "empty").mkdir()
    found = load("{folder: pairs}")
    assert list(found.scenes) == ["a", "b"]
    for scene in found.scenes.values():
        pair = scene.open()
        assert np.isnan(pair.truth_px[0, :5]).all() and (pair.truth_px[1:] == 3).all()
        np.testing.assert_array_equal(pair.visible[1:], np.arange(30) >= 3 + np.zeros((19, 1)))
    with pytest.raises(ConfigError, match="two scenes are called 'b'"):
        load("{folder: pairs}, {folder: pairs/a/../b}")
    (tmp_path / "pairs/a/disparity.png").unlink()
    with pytest.raises(ConfigError, match="true disparity"):
        measurements(load("{folder: pairs/a}"))


def parse_scenes(registry: Registry, folder: Path, *scenes: str) -> Comparison:
    text = f"compare: depth\nmethods: [constant]\nscenes: [{', '.join(scenes)}]\nrepeats: 1\nwarmups: 0\ncalls: 1\n"
    return parse_comparison(text, folder / "c.yaml", registry)


def pair(folder: Path, name: str) -> str:
    """A scene of two files of this name, whose pictures are always the same."""
    for side, seed in (("left", 0), ("right", 1)):
        grey = np.random.default_rng(seed).integers(0, 255, (24, 32), np.uint8)
        Image.fromarray(grey).save(folder / f"{name}{name}_{side}.png")
    return f"{{pairs: {{left: '{name}*_left.png', right: '{name}*_right.png'}}}}"


def test_pictures_are_measured_once_with_the_truth_beside_them(registry: Registry, tmp_path: Path):
    one, other = (measurements(parse_scenes(registry, tmp_path, pair(tmp_path, name))) for name in ("a", "b"))
    assert [each.row.key for each in one] == [each.row.key for each in other]
    assert one[0].row.scene != other[0].row.scene
    for side in ("left", "right"):
        Image.fromarray(np.full((24, 32), 90, np.uint8)).save(tmp_path / f"{side}.png")
    np.savez(tmp_path / "disparity.npz", disparity=np.full((24, 32), 3, np.float32))
    assert (DepthScene(folder=tmp_path).open().truth_px == 3).all()


def test_all_scenes_that_cannot_be_read_are_named(registry: Registry, tmp_path: Path):
    scenes = [pair(tmp_path, name) for name in ("a", "b", "c")]
    for name in ("aa_left", "cc_right"):
        (tmp_path / f"{name}.png").write_bytes(b"no picture")
    with pytest.raises(ConfigError) as error:
        measurements(parse_scenes(registry, tmp_path, *scenes))
    assert len(error.value.args) == 2
    assert "aa_left.png" in error.value.args[0] and "cc_right.png" in error.value.args[1]
