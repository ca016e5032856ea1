"""Titles and names of files in any script: if a case fails, no page comes out, or one with wrong braille."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from command_line import tangible
from tangible_core import Pipeline, Scene
from tangible_core.errors import ConfigError
from tangible_export.braille import title_in_braille, translate, visible

HALVES = np.repeat([[60] * 40 + [200] * 40], 60, axis=0).astype(np.uint8)


@pytest.mark.parametrize("name", ["家", pytest.param("two\nlines", marks=pytest.mark.whole)], ids=ascii)
def test_page_and_solid_come_out_whatever_the_file_is_called(tmp_path: Path, name: str):
    Image.fromarray(HALVES).save(tmp_path / f"{name}.png")
    done = tangible("export", f"{name}.png", "--to", "swell,stl", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {path.suffix for path in (tmp_path / "out").iterdir()} >= {".svg", ".pdf", ".stl"}
    assert ("the title is left out" in done.stderr) is (name == "家")


def test_title_without_braille_is_left_out_and_others_lose_what_nobody_sees():
    assert title_in_braille("Дом", "en") == ""
    assert title_in_braille("\ufeffa\u200dcab\u202e", "en") == "acab"
    assert translate("\u2066a cab\u2069") == translate("a cab")
    assert visible("a\u00a0b") == "a\u00a0b"


def test_title_with_half_a_character_is_refused_in_plain_words():
    with pytest.raises(ConfigError, match="title"):
        Pipeline(Scene.heights(np.eye(8)), title="caf\udce9")
