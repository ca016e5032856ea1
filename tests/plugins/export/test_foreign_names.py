"""Titles and names of files in any script: a page and a solid come out, and what has no braille is told."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from command_line import tangible
from tangible_core import Pipeline, Scene
from tangible_core.errors import ConfigError
from tangible_core.files.paths import as_path
from tangible_export.braille import title_in_braille, translate, visible

HALVES = np.repeat([[60] * 40 + [200] * 40], 60, axis=0).astype(np.uint8)


@pytest.mark.parametrize(
    "name", ["Дом", "Σπίτι", "家", "🐱 cat", "№ 5", "\u200e\ufeffcat", "two\nlines", "~"], ids=ascii
)
def test_page_and_solid_come_out_whatever_the_file_is_called(tmp_path: Path, name: str):
    Image.fromarray(HALVES).save(tmp_path / f"{name}.png")
    done = tangible("export", f"{name}.png", "--to", "swell,stl", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {each.suffix for each in (tmp_path / "out").iterdir()} >= {".svg", ".pdf", ".stl"}
    has_braille = name in ("\u200e\ufeffcat", "two\nlines", "~")
    assert ("the title is left out" in done.stderr) is not has_braille


def test_title_without_braille_is_left_out_and_others_lose_what_nobody_sees():
    assert title_in_braille("Дом", "en") == ""
    assert title_in_braille("\ufeffa\u200dcab\u202e", "en") == "acab"
    assert translate("\u2066a cab\u2069") == translate("a cab")
    assert visible("a\u00a0b") == "a\u00a0b"


def test_title_with_half_a_character_is_refused_in_plain_words():
    with pytest.raises(ConfigError, match=r"title: Input should be text of whole characters, not 'caf\\udce9'"):
        Pipeline(Scene.heights(np.eye(8)), title="caf\udce9")


def test_tilde_begins_a_file_name_where_no_user_has_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    assert as_path("~.png") == Path("~.png")
    Path("~nobody here").touch()
    assert as_path("~nobody here") == Path("~nobody here")
    assert as_path("~/x.png") == Path.home() / "x.png"
    with pytest.raises(ConfigError, match="no user here is named 'no-such-user'"):
        as_path("~no-such-user/x.png")
