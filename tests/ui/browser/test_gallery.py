"""The gallery of the docs: otherwise an example fails, is not on the page, or its picture shows another result."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from benchmarks.gallery import examples, picture, run
from command_line import tangible
from page_files import ROOT

GALLERY = ROOT / "docs" / "gallery"
LANGUAGES = {".sh": "sh", ".yaml": "yaml", ".py": "python"}
DAILY = {"force-law", "landscape", "materials-by-rules", "words"}
TIMED = {"kiosk", "pareto", "preflight", "replay"}
"""Examples whose results depend on how well the machine keeps time."""


def call(words: list[str]) -> str:
    done = tangible(*words, cwd=Path())
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_gallery_page_shows_every_example_its_picture_and_its_file():
    page = GALLERY.joinpath("index.md").read_text("utf-8")
    assert len(examples(GALLERY)) >= 20
    for path in examples(GALLERY):
        assert f"```{LANGUAGES[path.suffix]}\n{path.read_text('utf-8')}```\n" in page
        assert f"]({path.stem}.png)\n" in page and f"[{path.name}]({path.name})" in page
        assert path.with_suffix(".png").stat().st_size <= 40_000


@pytest.mark.parametrize("name", sorted(DAILY))
def test_gallery_example_makes_what_it_names(tmp_path: Path, name: str):
    [example] = [path for path in examples(GALLERY) if path.stem == name]
    paths, printed = run(example, tmp_path, call)
    assert all(path.stat().st_size > 1000 for path in paths) and (paths or len(printed) > 100)


@pytest.mark.parametrize("example", examples(GALLERY), ids=lambda path: path.stem)
def test_gallery_picture_shows_the_result(browser: Any, tmp_path: Path, example: Path):
    with Image.open(example.with_suffix(".png")) as stored:
        pair = (stored.convert("RGB"), picture(browser, *run(example, tmp_path, call)))
    before, now = (np.asarray(shown.reduce(8), float) for shown in pair)
    assert np.abs(before - now).mean() < (15 if example.stem in TIMED else 3), (
        "take it anew: python -m benchmarks.gallery docs/gallery"
    )
