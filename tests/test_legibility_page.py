"""What docs/legibility.md tells is done here; with TANGIBLE_DOCS_PICTURES=1 its pictures are written."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from colour_parts import by_colour
from drawn_parts import drawn
from tangible_authoring.label_picture import distinct_colours
from tangible_core.data import PartMap
from tangible_core.parts import SimplifyChoice
from tangible_core.plugins.notes import collected
from tangible_legibility import legibility, simplify

ROOT = Path(__file__).parents[1]
PAGE = ROOT.joinpath("docs", "legibility.md").read_text(encoding="utf-8")
MOST_BYTES, SIDE_PX, COLOURS, WIDTH_M = 150_000, 420, 64, 0.16


@pytest.fixture
def keep(tmp_path: Path) -> Callable[..., None]:
    """Writes pictures side by side, small, to where that is asked for; the page shows them."""

    def kept(name: str, *pictures: np.ndarray) -> None:
        assert f"](legibility/{name}.png)" in PAGE
        folder = ROOT / "docs" / "legibility" if os.environ.get("TANGIBLE_DOCS_PICTURES") else tmp_path
        folder.mkdir(exist_ok=True)
        width = SIDE_PX * pictures[0].shape[1] // pictures[0].shape[0]
        row = [np.asarray(Image.fromarray(each).resize((width, SIDE_PX), Image.Resampling.BOX)) for each in pictures]
        between = np.full((SIDE_PX, 12, 3), 255, np.uint8)
        wide = np.concatenate([part for each in row for part in (each, between)][:-1], axis=1)
        small = Image.fromarray(wide).quantize(COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        small.save(folder / f"{name}.png", optimize=True)
        assert (folder / f"{name}.png").stat().st_size < MOST_BYTES

    return kept


def coloured(parts: PartMap, by: tuple[int, ...]) -> np.ndarray:
    return distinct_colours(max(by) + 1)[np.array(by)[parts.labels]]


def test_colours_of_a_cup_become_legible_parts(keep):
    picture = drawn("coffee").picture
    parts = by_colour(picture)
    found = simplify(parts, WIDTH_M, SimplifyChoice(), (), picture)
    assert legibility("swell", found, WIDTH_M).readable
    left = len(np.unique(found.labels))
    assert f"the {round(parts.count, -2):,} parts" in PAGE
    assert f"{left} parts that" in PAGE
    keep("coffee", picture, coloured(parts, parts.segments), coloured(found, found.segments))


def test_drawn_parts_lose_what_is_too_thin(keep):
    motorcycle = drawn("motorcycle")
    numbers = tuple(range(motorcycle.parts.count))
    with collected() as notes:
        found = simplify(motorcycle.parts, WIDTH_M, SimplifyChoice(), motorcycle.names)
    assert "(fork)" in notes[0]
    keep("motorcycle", motorcycle.picture, coloured(motorcycle.parts, numbers), coloured(found, numbers))
