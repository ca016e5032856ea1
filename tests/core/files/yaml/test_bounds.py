"""If one of these fails, a hostile YAML text takes seconds, gigabytes or a traceback instead of one complaint."""

import json
from pathlib import Path

import pytest

from full_disk import unreadable
from hostile import YAML_BOMBS
from tangible_core.errors import MAX_IN_LINE, MAX_LINES, ConfigError
from tangible_core.files.reading import MAX_TEXT_BYTES
from tangible_core.files.yaml import bounds
from tangible_core.files.yaml.bounds import MAX_DEPTH, MAX_DIGITS
from tangible_core.files.yaml.source import Source, parse_source, plain, read_text
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry

PATH = Path("here/p.yaml")


def parse(text: str) -> Source:
    return parse_source(text, PATH, "what it is")


def complaint(text: str) -> str:
    with pytest.raises(ConfigError) as error:
        parse(text)
    (line,) = str(error.value).splitlines()
    assert line.isprintable()
    return line


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", YAML_BOMBS)
def test_yaml_bomb_as_a_pipeline_gives_few_short_complaints(name: str):
    with pytest.raises(ConfigError) as error:
        parse_config(YAML_BOMBS[name], PATH, default_registry())
    lines = str(error.value).splitlines()
    assert len(lines) <= MAX_LINES + 1
    assert all(line.isprintable() and len(line) <= MAX_IN_LINE for line in lines)
    assert lines[0].startswith("here/p.yaml:")


def deep(levels: int) -> str:
    return "x: " + "[" * (levels - 1) + "1" + "]" * (levels - 1)


def test_brackets_and_blocks_beyond_the_depth_limit_are_refused():
    """The parser's events would be a thousand brackets late."""
    assert complaint("scene: " + "[" * 500) == f"here/p.yaml:1:{8 + MAX_DEPTH}: more than {MAX_DEPTH} blocks are nested"
    assert parse(deep(MAX_DEPTH)).tree
    assert complaint(deep(MAX_DEPTH + 1)) == f"here/p.yaml:1:23: more than {MAX_DEPTH} blocks are nested"


def test_values_and_aliases_beyond_the_count_limit_are_refused(monkeypatch: pytest.MonkeyPatch):
    """The mapping, a key, the list, and its items."""
    monkeypatch.setattr(bounds, "MAX_NODES", 100)
    assert parse(f"x: [{'1,' * 97}]").tree
    assert "more than 100 values" in complaint(f"x: [{'1,' * 98}]")
    assert "more than 100 values" in complaint("\n".join(f"x{number}: 1" for number in range(50)))
    monkeypatch.setattr(bounds, "MAX_NODES", 100)
    text = f"a: &a [{'1,' * 9}]\nb: [{{}}]"
    assert len(parse(text.format("*a," * 8 + "1," * 6)).tree["b"]) == 14
    assert "values, aliases expanded" in complaint(text.format("*a," * 8 + "1," * 7))
    assert "values, aliases expanded" in complaint(text.format("*a," * 9))


@pytest.mark.parametrize(
    ("text", "place"),
    [("a: &a [*a]", "1:8"), ("a: &a {b: [1, *a]}", "1:15"), ("a: &a {<<: *a}", "1:12"), ("&a\nb: *a", "2:4")],
)
def test_alias_inside_its_own_anchor_is_refused_with_its_place(text: str, place: str):
    assert complaint(text) == f"here/p.yaml:{place}: an alias refers to a block that contains it"


@pytest.mark.parametrize("text", ["? [a]\n: b", "{[a]: b}", "? {a: b}\n: c", "a: &a [1]\n*a : c", "? " * 20])
def test_key_that_is_a_block_is_refused(text: str):
    assert "a key must be a word or a number" in complaint(text)


def test_number_with_too_many_digits_is_refused():
    assert parse("x: " + "9" * MAX_DIGITS).tree["x"] == int("9" * MAX_DIGITS)
    assert complaint("x: " + "9" * (MAX_DIGITS + 1)) == f"here/p.yaml:1:4: a number of more than {MAX_DIGITS} digits"
    assert "digits" in complaint("x: 0." + "9" * MAX_DIGITS)
    assert parse("x: '" + "9" * 5000 + "'").tree["x"] == "9" * 5000


@pytest.mark.parametrize("text", ["2024-01-01", "2024-13-45", "2024-02-30T99:99:99Z", "0000-00-00"])
def test_date_is_read_as_text(text: str):
    assert parse(f"photo: {text}").tree["photo"] == text


def test_text_with_too_many_bytes_is_refused(tmp_path: Path):
    (tmp_path / "a.yaml").write_text("x: 1\n" + "#" * (MAX_TEXT_BYTES - 5))
    assert parse(read_text(tmp_path / "a.yaml")).tree == {"x": 1}
    (tmp_path / "a.yaml").write_text("x: 1\n" + "#" * (MAX_TEXT_BYTES - 4))
    with pytest.raises(ConfigError, match=r"a\.yaml: cannot be read as text: it holds more than 0\.25 MB"):
        read_text(tmp_path / "a.yaml")
    assert complaint("#" * (MAX_TEXT_BYTES + 1)) == "here/p.yaml: it holds more than 0.25 MB"


@pytest.mark.parametrize(
    ("override", "reason"),
    [
        ("scene=" + "[" * 500, "blocks are nested"),
        ("scene=*a", "undefined alias"),
        ("scene=" + "9" * 5000, "digits"),
        ("x" * 5000, "write key.key=value"),
        (".".join("a" * (MAX_DEPTH + 1)) + "=1", "write key.key=value"),
        ("9" * 5000 + "=1", ""),
        ("²=1", ""),
    ],
)
def test_hostile_override_gives_one_short_complaint(override: str, reason: str):
    with pytest.raises(ConfigError) as error:
        parse_config("scene: builtin/brick", PATH, default_registry(), [override])
    (line,) = str(error.value).splitlines()
    assert line.startswith("--set ")
    assert reason in line
    assert len(line) < 500


@pytest.mark.parametrize(
    "value", ["!foo x", "!!str x", "! x", "!!binary aGk=", "!!set {a, b}", "[1, !foo x]", "{b: !!x 1}"]
)
def test_value_with_a_tag_is_refused_with_its_place(value: str):
    with pytest.raises(ConfigError, match=r"p\.yaml:2:\d+: a value cannot have the tag '.*'; leave it out"):
        parse_source(f"# a comment\na: {value}\n", Path("p.yaml"), "a mapping")


@pytest.mark.parametrize("text", ["<<", "=", "<"])
def test_mark_of_yaml_in_place_of_a_value_is_a_text(text: str):
    tree = parse_source(f"a: {text}\nb: [{text}, 1]\n", Path("p.yaml"), "a mapping").tree
    assert json.loads(json.dumps(plain(tree))) == {"a": text, "b": [text, 1]}


def test_tagged_values_are_read_and_unreadable_text_says_why(tmp_path: Path):
    text = "a: !!int 3\nb: !!bool true\nc: !!opencv-matrix {rows: 3}\nd: !!float 2\n"
    tree = parse_source(text, Path("p.yaml"), "a mapping").tree
    assert {key: plain(value) for key, value in tree.items()} == {"a": 3, "b": True, "c": {"rows": 3}, "d": 2.0}
    for path, why in unreadable(tmp_path, ".yaml"):
        with pytest.raises(ConfigError) as error:
            read_text(path)
        assert str(error.value) == f"{path}: cannot be read as text: {why}"
