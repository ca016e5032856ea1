"""A pipeline file edited key by key. Otherwise a change on the page would lose comments or other values."""

import json
import re
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.errors import ConfigError, TangibleError
from tangible_core.files.yaml.editing import json_in_yaml
from tangible_core.files.yaml.source import parse_value, plain
from tangible_core.pipeline.config.editing import REMOVE, edit_text, read_values, relocate_text
from tangible_core.pipeline.config.methods import NamedMethod
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.plugins import Exporter

PATH = Path("here/p.yaml")
OF_MINE = """\
# of mine
scene: {photo: "my photo.png"}   # beside this file
want: touch

# how deep
depth:
  use: semi-global  # the best one
  # none of it is needed:
  confidence: 0.5   # half

# how high
workspace:
  relief_m: 6 mm   # as high as it goes

render: {use: proxy, stiffness_n_per_m: 800 N/m}   # hard
device: mock
"""


@pytest.mark.parametrize(
    ("changes", "before", "after"),
    [
        ({"workspace.relief_m": 0.004}, "relief_m: 6 mm ", "relief_m: 4 mm "),
        ({"workspace.relief_m": "4 mm"}, "relief_m: 6 mm ", "relief_m: 4 mm "),
        ({"workspace.relief_m": "6 mm"}, "", ""),
        ({"workspace.width_m": 0.1}, "as high as it goes\n", "as high as it goes\n  width_m: 100 mm\n"),
        ({"workspace.relief_m": REMOVE}, "workspace:\n  relief_m: 6 mm   # as high as it goes\n", ""),
        ({"workspace": REMOVE}, "workspace:\n  relief_m: 6 mm   # as high as it goes\n", ""),
        ({"workspace.smooth_m": REMOVE}, "", ""),
        ({"workspace": {"relief_m": 0.1}}, ":\n  relief_m: 6 mm   # as high as it goes", ": {relief_m: 100 mm}"),
        ({"depth.confidence": REMOVE}, "  confidence: 0.5   # half\n", ""),
        ({"depth.use": "zncc"}, "semi-global  # the best one", "zncc  # the best one"),
        ({"render.stiffness_n_per_m": 500}, "800 N/m", "500 N/m"),
        ({"render.stiffness_n_per_m": REMOVE}, ", stiffness_n_per_m: 800 N/m", ""),
        ({"render.damping_n_s_per_m": 0}, "N/m}", "N/m, damping_n_s_per_m: 0 N s/m}"),
        ({"render.use": "penalty"}, "{use: proxy, stiffness_n_per_m: 800 N/m}", "{use: penalty}"),
        ({"device.path": "circle"}, "device: mock", "device: {use: mock, path: circle}"),
        ({"device.hand": None}, "device: mock", "device: {use: mock, hand: null}"),
        ({"device.use": "falcon"}, "device: mock", "device: {use: falcon}"),
        ({"device": None}, "device: mock\n", ""),
        ({"device.use": REMOVE}, "device: mock\n", ""),
        ({"scene": "builtin/brick"}, '{photo: "my photo.png"}', "builtin/brick"),
        ({"scene.left": "a: b.png"}, '.png"}', ".png\", left: \"a: b.png\"}"),
        ({"materials": {"by": {"0": "ice", "1": "sand"}}}, "", None),
        ({"materials.by.0": "ice"}, "mock\n", "mock\nmaterials: {by: {0: ice}}\n"),
        ({("materials", "by"): "rules"}, "mock\n", "mock\nmaterials: {by: rules}\n"),
    ],
)  # fmt: skip
def test_change_of_a_key_leaves_the_rest(changes: dict, before: str, after: str | None):
    text = edit_text(OF_MINE, PATH, changes)
    if after is not None:
        options = "  confidence: 0.5   # half\n" if changes.get("depth.use") else ""
        assert text == OF_MINE.replace(options, "").replace(before, after, 1)
    for comment in ("# of mine", "# beside this file", "# how deep", "# how high", "# hard"):
        assert comment in text
    assert edit_text(OF_MINE.replace("\n", "\r\n"), PATH, changes) == text.replace("\n", "\r\n")
    for key, value in changes.items():
        assert value in (None, REMOVE) or _in_metres(_at(read_values(text, PATH), key)) == _in_metres(value)
    left = [key for key in read_values(text, PATH) if key in read_values(OF_MINE, PATH)]
    assert left == [key for key in read_values(OF_MINE, PATH) if key in left]


def _in_metres(value: Any) -> Any:
    """The value as a change has it: a number without its unit."""
    if isinstance(value, dict):
        return {key: _in_metres(each) for key, each in value.items()}
    if isinstance(value, str) and (written := re.fullmatch(r"([\d.]+) (mm|N/m|N s/m)", value)):
        return float(Decimal(written[1]) * Decimal("0.001" if written[2] == "mm" else 1))
    return value


def _at(tree: Any, key: Any) -> Any:
    for part in key.split(".") if isinstance(key, str) else key:
        tree = tree[part]
    return tree


@pytest.mark.parametrize(
    ("before", "changes", "after"),
    [
        ("", {"scene": "builtin/brick"}, "scene: builtin/brick\n"),
        ("# mine", {"scene.photo": "a.png"}, "# mine\nscene: {photo: a.png}\n"),
        ("scene: builtin/brick", {"depth": "zncc"}, "scene: builtin/brick\ndepth: zncc\n"),
        ("# mine\nscene: builtin/brick\n", {"scene": REMOVE}, "# mine\n"),
        ("scene: a\n", {"materials": {"0": "ice"}}, "scene: a\nmaterials: {0: ice}\n"),
        ("scene: a\n", {"export.heights.width_m": 0.1}, "scene: a\nexport: [{use: heights, width_m: 100 mm}]\n"),
        ("a: 1\nm: &m {scale: 2}\n", {"m.scale": 3}, "a: 1\nm: &m {scale: 3}\n"),
        ("depth:\n  use: zncc  # one\n", {"depth": {"use": "auto", "a": 9}}, "depth: {use: auto, a: 9}\n"),
    ],
)
def test_small_file_takes_changes(before: str, changes: dict, after: str):
    assert edit_text(before, PATH, changes) == after


LISTED = "scene: builtin/coins  # mine\nexport: [heights, {use: text, language: de}]  # for others\n"


@pytest.mark.parametrize(
    ("changes", "exporters"),
    [
        ({"export.heights.width_m": 0.1}, "[{use: heights, width_m: 100 mm}, {use: text, language: de}]"),
        ({"export.text.language": "fr"}, "[heights, {use: text, language: fr}]"),
        ({"export.1.language": "fr"}, "[heights, {use: text, language: fr}]"),
        ({"export.text.language": REMOVE}, "[heights, {use: text}]"),
        ({("export", 1, "use"): "heights"}, "[heights, {use: heights}]"),
        ({"export": ["text"]}, "[text]"),
        ({"export.swell.page": "a3"}, "[heights, {use: text, language: de}, {use: swell, page: a3}]"),
    ],
)  # fmt: skip
def test_exporter_changed_by_its_name_keeps_the_list(changes: dict, exporters: str):
    text = edit_text(LISTED, PATH, {"scene": "builtin/brick", **changes})
    assert text == f"scene: builtin/brick  # mine\nexport: {exporters}  # for others\n"


def test_exporter_files_are_found_from_another_folder(tmp_path: Path):
    class Framed(Exporter):
        frame: Path = Path()

        def write(self, work, stem):
            raise NotImplementedError

    text = "scene: builtin/coins\nexport: [heights, {use: framed, frame: frames/oak.svg}]\n"
    frames = Path(), tmp_path / "frames/oak.svg"
    exporters = tuple(NamedMethod(f"{each}", "", Framed(frame=each)) for each in frames)
    config = PipelineConfig(scene="builtin/coins", export=exporters)
    found = relocate_text(text, tmp_path / "p.yaml", config, tmp_path / "sub" / "p.yaml")
    assert found == text.replace("frames/", "../frames/")


def test_alias_changed_in_one_place_leaves_the_other():
    text = "scene: builtin/brick  # mine\nworkspace: {width_m: &w 0.1, relief_m: *w}\n"
    for key, size in (("relief_m", {"width_m": 0.1, "relief_m": 0.2}), ("width_m", {"width_m": 0.2, "relief_m": 0.1})):
        assert read_values(edit_text(text, PATH, {f"workspace.{key}": 0.2}), PATH)["workspace"] == size
    shared = "a: &b {c: 1}\nd: *b\n"
    assert read_values(edit_text(shared, PATH, {"d.c": 2}), PATH) == {"a": {"c": 1}, "d": {"c": 2}}
    assert json.dumps(read_values("workspace: {width_m: .nan, 3: 2001-01-01}\n", PATH), allow_nan=False)


@pytest.mark.parametrize(
    ("text", "changes", "says"),
    [
        ("scene: [\n", {"want": "touch"}, "p.yaml:2:1"),
        ("- a\n", {"want": "touch"}, "p.yaml:1:1"),
        ("materials: {rules: []}\n", {"materials.rules.0": "x"}, "rules is a list; set it as a whole"),
        ("export: [heights]\n", {"export.heights": {"width_m": 0.1}}, "export is a list; set it as a whole"),
        ("scene: a\n", {"": 1}, "is not a key"),
        ("scene: a\n", {"depth..use": 1}, "is not a key"),
        ("scene: a\n", {"x." * 30 + "x": 1}, "is not a key"),
        ("scene: a\n", {"workspace.width_m": 10**70}, "a number of more than 64 digits"),
        ("scene: a\n", {"scene": "x" * 300_000}, "holds more than"),
        ("scene: a\n", {"scene": json.loads("[" * 500 + "]" * 500)}, "more than 20 blocks are nested"),
        ("scene: a\n", {"depth": {1, 2, PATH.open}}, "a value that JSON can express"),
    ],
)
def test_impossible_change_is_refused(text: str, changes: dict, says: str):
    with pytest.raises(TangibleError, match=says):
        edit_text(text, PATH, changes)


TEXTS = [
    OF_MINE,
    OF_MINE.rstrip("\n"),
    "{scene: builtin/brick, depth: {use: zncc}}",
    "",
    "--- # one\nscene: |\n  of\n  lines\ndepth:\nworkspace:\n    holes: cut\n\n    # below\n...\n",
]
keys = st.sampled_from(
    ["scene", "scene.photo", "want", "depth", "depth.use", "render.use", "workspace.width_m", "workspace.holes",
     "workspace", "materials", "materials.by", "materials.by.0", "materials.1", "render.x.y", "device.path"]
)  # fmt: skip
scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.sampled_from(["zncc", "1e3", "no"])
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text() | st.sampled_from("0x"), inner, max_size=3),
    max_leaves=5,
)


@given(st.sampled_from(TEXTS), st.lists(st.tuples(keys, values | st.just(REMOVE)), min_size=1, max_size=4))
def test_edited_text_has_the_changes_and_the_rest(text: str, changes: list):
    tree = read_values(text, PATH)
    for key, value in changes:
        try:
            _set(tree, key.split("."), value)
        except ConfigError:
            with pytest.raises(ConfigError, match="is a list"):
                edit_text(text, PATH, {key: value})
            return
        text = edit_text(text, PATH, {key: value})
        assert _json(read_values(text, PATH)) == _json(tree)


def _set(tree: dict, parts: list[str], value: Any) -> None:
    """Apply a change in another way: blocks down, then the key, then empty blocks up."""
    name, *rest = parts
    if not rest:
        if value is REMOVE or (value is None and name in ("depth", "texture", "render", "device")):
            tree.pop(name, None)
        elif name == "use" and tree.get("use") != value:
            tree.clear()
            tree[name] = value
        else:
            tree[name] = value
        return
    block = tree.get(name)
    if isinstance(block, list):
        raise ConfigError("a list")
    if isinstance(block, str) and name in ("depth", "texture", "render", "device"):
        block = {"use": block}
    if not isinstance(block, dict):
        block = {} if value is not REMOVE else block
    if isinstance(block, dict):
        held = bool(block)
        _set(block, rest, value)
        tree[name] = block
        if held and not block:
            del tree[name]


def _json(tree: Any) -> Any:
    return json.dumps(_with_word_keys(tree), sort_keys=True)


def _with_word_keys(node: Any) -> Any:
    if isinstance(node, dict):
        return {str(key): _with_word_keys(value) for key, value in node.items()}
    if isinstance(node, list):
        return [_with_word_keys(value) for value in node]
    return str(node) if isinstance(node, float) and not abs(node) < float("inf") else node


@given(
    st.recursive(st.text() | st.sampled_from("\x7f\x85\u2028\ufffe\udce9🙂"), lambda more: st.lists(more, max_size=3))
)
def test_json_in_yaml_is_read_as_the_same_value_by_both(value: Any):
    written = json_in_yaml(value)
    assert plain(parse_value(written)) == value
    assert json.loads(written) == value
    assert len(written.splitlines()) == 1
