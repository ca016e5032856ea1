"""If one of these fails, a common mistake in a YAML file is not named with its place and a cure."""

from pathlib import Path

import pytest

from tangible_core import Scene
from tangible_core.errors import ConfigError, PictureError
from tangible_core.pipeline.config.parsing import load_config, parse_config
from tangible_core.plugins.registry import default_registry

HEAD = "scene: builtin/brick\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<<<<<<< HEAD\nwant: relief\n=======\nwant: touch\n>>>>>>> other\n", "2:1: a merge has left both versions"),
        ("title: a: b\n", "2:9: mapping values are not allowed here; a text with a colon and a space stands in "),
        ("workspace: {width_m: 0,08}\n", r"2:24: workspace.8: Keys should be words \(a number has a decimal point"),
        ("workspace:\n  width_m: 0,08\n", "3:3: workspace.width_m: .*, not '0,08'; with a decimal point it is 0.08"),
        ("workspace:\n  width_m: 8,5 cm\n", "3:3: workspace.width_m: .*; with a decimal point it is 8.5 cm"),
        ("simplify: !include x.yaml\n", "2:11: a value cannot have the tag '!include'; leave it out, and write"),
        ("title: @me\n", "2:8: found character '@' .*; a text that begins with this character stands in quotes"),
        ("title: *me\n", r"2:8: found undefined alias 'me'; a text that begins with \* stands in quotes"),
        ('title: "me\n', "3:1: found unexpected end of stream; end what was opened, such as quotes"),
        ("want = relief\n", "3:1: could not find expected ':'; a line is `key: value`"),
        ("want: relief\nwant: touch\n", "3:1: found duplicate key .*; remove one of them"),
    ],
)  # fmt: skip
def test_mistake_has_its_place_and_a_cure(text: str, message: str):
    with pytest.raises(ConfigError, match=f"p.yaml:{message}"):
        parse_config(HEAD + text, Path("p.yaml"), default_registry())


def test_dead_link_names_where_it_leads(tmp_path: Path):
    for name in ("p.yaml", "p.png"):
        (tmp_path / name).symlink_to(tmp_path / "gone")
    says = f"is a link to {tmp_path / 'gone'}, which is not there; restore that file, or name another one"
    with pytest.raises(ConfigError, match=f"p.yaml: {says}"):
        load_config(tmp_path / "p.yaml", default_registry())
    with pytest.raises(PictureError, match=f"p.png: {says}"):
        assert Scene.photo(tmp_path / "p.png").views
