"""A surface in a few sentences: if a case fails, a blind reader is told something else than a hand feels."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tangible_core.data import HapticSurface, Relief
from tangible_core.errors import ArgumentError
from tangible_core.materials.assignment import library
from tangible_report.description import describe

Y, X = np.mgrid[0:60, 0:80] / np.array([60, 80]).reshape(2, 1, 1)


def surface(height: np.ndarray, *names: str, labels: np.ndarray | None = None) -> HapticSurface:
    """8 cm wide and 6 cm long, as high as it says in millimetres."""
    materials = tuple(library()[name] for name in names) or None
    return HapticSurface.from_heights(1e-3 * height, 0.08, labels, materials)


def bump(x: float, y: float) -> np.ndarray:
    return 10 * np.exp(-((X - x) ** 2 + (Y - y) ** 2) / 0.01)


@pytest.mark.parametrize(
    ("height", "says"),
    [
        (bump(0.15, 0.15), "highest at the upper left and lowest nearly everywhere else"),
        (10 - bump(0.5, 0.9), "lowest at the bottom in the middle"),
        (10 * X, "highest on the right and lowest on the left; hardly any of it is flat"),
        (10 * (1 - Y), "highest along the top and lowest along the bottom"),
        (10 * (X > 0.5), "highest on the right and lowest on the left; nearly all of it is flat"),
        (5 + 5 * np.sin(20 * X) * np.sin(20 * Y), "High and low places lie all over it"),
        (np.where(X < 0.5, 3, 3 + 10 * (X - 0.5)), "about 50 % of it is flat, on the left"),
    ],
)
def test_sentence_names_high_and_low_places(height: np.ndarray, says: str):
    assert says in describe(surface(height), "it")


def test_sentence_is_of_slopes_along_cells_and_their_share():
    assert describe(surface(100 + 10 * X), "it") == describe(surface(10 * X), "it")
    oblong = Relief((np.arange(80) * 6e-5 * np.ones((20, 1))).astype(np.float32), (0.08, 0.08))
    assert "; hardly any of it is flat" in describe(HapticSurface(oblong), "it")
    fine = HapticSurface.from_heights(np.arange(600) * 1.5e-5 * np.ones((4, 1)), 0.6)
    assert "; nearly all of it is flat" in describe(fine, "it")
    row, column = np.indices((60, 80))
    height = np.where(X < 0.1, 10, np.where((row + column) % 3, 5, 0))
    assert "highest on the left" in describe(surface(height), "it")
    assert "nearly everywhere else" not in describe(surface(height), "it")
    assert "nearly everywhere else" in describe(surface(np.where(height == 5, 0, height)), "it")


@pytest.mark.parametrize(
    ("height_m", "width_m", "says"),
    [
        (np.eye(8) * 4e-3, 0.08, "a surface 8 cm wide and 8 cm long, up to 4 mm high."),
        (np.eye(4, 9) * 1.234e-4, 0.123, "a surface 12 cm wide and 5.5 cm long, up to 0.12 mm high."),
        (np.zeros((1, 1)), 1e-6, "a surface 0.0001 cm wide and 0.0001 cm long. It is flat everywhere."),
        (np.array([[0.0, 1e-3]]), 0.02, "a surface 2 cm wide and 1 cm long, up to 1 mm high. High and low"),
    ],
)
def test_sentence_has_the_size(height_m: np.ndarray, width_m: float, says: str):
    assert says in describe(HapticSurface.from_heights(height_m, width_m), "x")


def test_sentence_has_materials_with_shares_and_places():
    labels = np.where(X < 0.25, 0, np.where(Y < 0.5, 1, 2)).astype(np.int32)
    flat = np.zeros((60, 80))
    assert describe(surface(flat, "ice", "wood", "sand", labels=labels), "it").endswith(
        "It has 3 materials: sand on 38 % (along the bottom), wood on 38 % (along the top) "
        "and ice on 25 % (on the left)."
    )
    assert describe(surface(flat, "ice", "ice", "ice", labels=labels), "it").endswith("All of it feels like ice.")
    two = describe(surface(flat, "ice", "wood", "ice", labels=labels), "it")
    assert "2 materials: ice on 62 %" in two and "wood on 38 % (along the top)" in two
    many = (np.arange(4800) % 7).reshape(60, 80).astype(np.int32)
    names = ("ice", "wood", "sand", "foam", "glass", "metal", "skin")
    assert re.search(r"7 materials: .* and 3 others on 43 %\.$", describe(surface(flat, *names, labels=many), "it"))


def in_parts(names: tuple[str, ...], *materials: str) -> HapticSurface:
    """A wall, in front of it a table at the bottom, and on that a cup on the right."""
    labels = np.where(Y > 0.6, 1, 0).astype(np.int32)
    labels[(X > 0.7) & (Y > 0.3) & (Y < 0.8)] = 2
    height = np.array([0.0, 2.0, 4.25])[labels]
    return replace(surface(height, *materials, labels=labels), names=names)


def test_sentence_lists_named_and_nearest_parts():
    found = in_parts(("wall", "", "cup\n"), "stone", "wood", "glass")
    assert describe(found, "it").endswith(
        " Its parts, from near to far, are cup\\n (on the right, halfway down, 4.3 mm high, feels like glass), "
        "wall (along the top, feels like stone) and one that has no name."
    )
    assert describe(in_parts(("Wand", "Tisch", "Tasse"), "stone", "wood", "glass"), "es", "de").endswith(
        " Ihre Teile sind, von nah nach fern, Tasse (rechts auf halber Höhe, 4,3 mm hoch, fühlt sich an wie Glas), "
        "Tisch (am unteren Rand entlang, 2 mm hoch, fühlt sich an wie Holz) "
        "und Wand (am oberen Rand entlang, fühlt sich an wie Stein)."
    )
    assert describe(in_parts(("", "", "cup")), "it").endswith(
        "are cup (on the right, halfway down, 4.3 mm high) and 2 that have no name."
    )
    assert "It has 3 materials" in describe(in_parts(("", "", ""), "stone", "wood", "glass"), "it")
    labels = np.repeat(np.arange(30, dtype=np.int32), 160).reshape(60, 80)
    many = replace(surface(labels / 10.0, labels=labels), names=tuple(f"step {each}" for each in range(30)))
    said = describe(many, "it")
    assert "are step 29 (along the bottom, 2.9 mm high), step 28 (" in said
    assert said.endswith("step 18 (halfway down, 1.8 mm high) and 18 others.")
    few = labels[:26]
    one_more = replace(surface(few / 10.0, labels=few), names=tuple(f"step {each}" for each in range(13)))
    assert describe(one_more, "it").endswith(" high) and one other.")
    one = replace(surface(np.zeros((4, 4)), labels=np.zeros((4, 4), np.int32)), names=("plate",))
    assert describe(one, "it").endswith("It is of one part, plate.")


@pytest.mark.usefixtures("unchecked_shapes")
def test_unknown_language_is_refused():
    with pytest.raises(ArgumentError, match="language: is the str 'pt'; it must be one of en, de, fr"):
        describe(surface(10 * X), "", "pt")  # pyright: ignore[reportArgumentType]


def test_scene_kinds_all_have_words():
    hill = surface(bump(0.5, 0.5))
    starts = {kind: describe(hill, "x\n", "en", kind) for kind in ("photograph", "depth", "heights")}
    assert len(set(starts.values())) == 3
    assert all("\n" not in start for start in starts.values())
