"""A description part by part: if a case fails, a blind reader is told another size, place or neighbour than is felt."""

from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from tangible_core.data import HapticSurface, MaterialMap, PartMap
from tangible_core.materials.assignment import library
from tangible_report.description import PartFacts, describe_at_length, facts, page_of
from tangible_report.description.at_length import MAX_PARTS

Y, X = np.mgrid[0:60, 0:80] / np.array([60, 80]).reshape(2, 1, 1)
LABELS = np.where(Y >= 0.6, 1, 0).astype(np.int32)
LABELS[(X >= 0.7) & (Y >= 0.3) & (Y < 0.8)] = 2
STONE, WOOD, GLASS = (library()[name] for name in ("stone", "wood", "glass"))


def still_life(names: tuple[str, ...] = ("wall", "", "cup")) -> HapticSurface:
    """A wall, in front of it a table without a name, and on that a cup on the right; 80 by 60 mm."""
    height_m = 1e-3 * np.array([0.0, 2.0, 4.25])[LABELS]
    return replace(HapticSurface.from_heights(height_m, 0.08, LABELS, (STONE, WOOD, GLASS)), names=names)


def test_facts_are_sorted_from_near_to_far_on_any_grid():
    cup, table, wall = facts(still_life())
    assert [each.number for each in (cup, table, wall)] == [2, 1, 0]
    assert (cup.name, table.name, wall.name) == ("cup", "", "wall")
    assert cup.size_m == pytest.approx((0.024, 0.030))
    assert table.size_m == pytest.approx((0.080, 0.024))
    assert (cup.share, wall.share) == pytest.approx((0.15, 0.51))
    assert (cup.height_m, table.height_m) == pytest.approx((0.00425, 0.002))
    assert (cup.place, table.place, wall.place) == ("1 2", "2 -", "0 -")
    assert (cup.material, table.material, wall.material) == ("glass", "wood", "stone")
    assert cup.neighbours == (0, 1)  # 42 sides of pixels with the wall, 36 with the table
    assert table.neighbours == (0, 2)
    swapped = np.array([1, 0, 2])[LABELS]
    cup, _, _ = facts(replace(still_life(), labels=swapped.astype(np.int32)))
    assert (cup.number, cup.neighbours) == (2, (1, 0))
    surface = replace(still_life(), names=None)
    coarse = PartMap(np.where(LABELS[::4, ::4] == 2, 5, 3).astype(np.int32), tuple(range(7)))
    cup, rest = facts(surface, parts=coarse, names=("", "", "", " table ", "", "cup"))
    assert [(each.number, each.name, each.material) for each in (cup, rest)] == [
        (5, "cup", "glass"),
        (3, "table", "stone"),
    ]
    assert cup.size_m == pytest.approx((0.024, 0.028))
    assert cup.height_m == pytest.approx(0.00425)
    fine = PartMap(np.kron(LABELS, np.ones((9, 9), np.int32)), (0, 1, 2))
    assert [fact._replace(name="") for fact in facts(surface, parts=fine)] == [
        fact._replace(name="", share=pytest.approx(fact.share, rel=0.02), size_m=pytest.approx(fact.size_m, rel=0.02))
        for fact in facts(still_life())
    ]


def test_facts_have_the_extent_height_and_material_of_parts():
    labels = np.int32([[1, 0, 0, 0, 1, 0]]).repeat(3, 0)
    height_m = np.where(labels == 1, np.array([[1], [1], [7]]) * 1e-3, 0)
    part, _ = facts(HapticSurface.from_heights(height_m, 0.06, labels))
    assert part.size_m == pytest.approx((0.05, 0.03))
    assert part.height_m == pytest.approx(0.001)
    surface = HapticSurface.from_heights(np.arange(4.0)[None].repeat(2, 0) * 1e-3, 0.04)
    right, left = facts(surface, parts=PartMap(np.int32([[0, 1]]), (0, 1)))
    assert (left.height_m, right.height_m) == pytest.approx((0.001, 0.003))
    bare = replace(still_life(), materials=None)
    assert {fact.material for fact in facts(bare)} == {""}
    of_segments = MaterialMap((GLASS, GLASS, WOOD), ("", "", ""))
    assert [fact.material for fact in facts(bare, of_segments)] == ["wood", "glass", "glass"]


def told(number: int, name: str = "", share: float = 0.2, height_m: float = 0.0, beside: tuple[int, ...] = ()):
    return PartFacts(number, name, "- -", share, (0.01, 0.02), height_m, "", beside)


def lines_of(*parts: PartFacts) -> list[str]:
    return [*describe_at_length(HapticSurface.from_heights(np.zeros((4, 4))), "x", "en", parts)[5:]]


def test_description_has_words_for_shares_and_four_neighbours():
    sizes = {
        0.5: "More than half of the picture (50 %)",
        0.25: "A large part of the picture (25 %)",
        0.08: "A medium-sized part of the picture (8 %)",
        0.004: "A small part of the picture (0.4 %)",
        0.0002: "A small part of the picture (0.1 %)",
    }
    for share, says in sizes.items():
        assert lines_of(told(1, "Who?", share)) == [f"- Who? {says}, 10 mm wide and 20 mm long."]
    assert [", 0." in line for line in lines_of(told(0, height_m=4.9e-5), told(1, height_m=5.1e-5))] == [False, True]
    line = lines_of(told(0, beside=(5, 4, 3, 2, 1)), *map(told, range(1, 6)))[0]
    assert line.endswith("Beside it: part 6, part 5, part 4, part 3.")


def test_description_has_exactly_these_lines_and_a_heading():
    found = describe_at_length(still_life(), "Still life", "en", facts(still_life()))
    assert tuple(line.replace("\u00a0", " ") for line in found) == (
        "Still life",
        "",
        "A surface 80 mm wide and 60 mm long, up to 4.3 mm high. "
        "It is highest on the right, halfway down and lowest along the top; about 94 % of it is flat.",
        "",
        "Parts, from near to far",
        "- cup. On the right, halfway down. A medium-sized part of the picture (15 %), 24 mm wide and 30 mm long, "
        "4.3 mm high. Feels like glass. Beside it: wall, part 2.",
        "- part 2. Along the bottom. A large part of the picture (34 %), 80 mm wide and 24 mm long, 2 mm high. "
        "Feels like wood. Beside it: wall, cup.",
        "- wall. Along the top. More than half of the picture (51 %), 80 mm wide and 36 mm long. "
        "Feels like stone. Beside it: part 2, cup.",
    )
    assert describe_at_length(still_life(), " ", "en", facts(still_life()))[0].strip()


@pytest.mark.parametrize(("extra", "says"), [
    (0, None),
    (1, "One smaller part, 2 % of the picture, is left out."),
    (20, "20 smaller parts, 25 % of the picture together, are left out."),
])  # fmt: skip
def test_description_of_many_parts_has_the_named_and_largest(extra: int, says: str | None):
    count = MAX_PARTS + extra
    labels = np.repeat(np.arange(count, dtype=np.int32), 160).reshape(-1, 80)
    surface = replace(
        HapticSurface.from_heights(labels * 1e-4, 0.08, labels), names=("the lowest", *[""] * (count - 1))
    )
    lines = describe_at_length(surface, "x", "en", facts(surface))
    assert sum("- part " in line or "the lowest" in line for line in lines if line.startswith("- ")) == MAX_PARTS
    assert [line for line in lines if line.startswith("- ")][-1].startswith("- the lowest. ")
    assert (lines[-1] if says else None) == says


class Page(HTMLParser):
    """The tags of a page in order, and its text by the language that it is in."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags, self.text, self.open, self.attributes = list[str](), list[tuple[str, str]](), [("", "")], []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, *attr) for attr in attrs]
        if tag != "meta":
            self.open.append((tag, dict(attrs).get("lang") or self.open[-1][1]))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop()[0] == tag

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.text.append((self.open[-1][1], data.strip()))


def test_page_has_the_words_of_the_lines():
    language = "fr"
    surface = still_life(("wall & <b>", "", "cup"))
    page = Page(page_of(surface, 'A "still" <life>', language, facts(surface)))
    assert page.open == [("", "")]
    assert page.tags.count("h1") == page.tags.count("main") == page.tags.count("title") == page.tags.count("ul") == 1
    assert page.tags.count("li") == 3
    assert page.tags.index("h1") < page.tags.index("h2") < page.tags.index("ul")
    assert {"script", "img", "link", "b"}.isdisjoint(page.tags)
    assert ("html", "lang", language) in page.attributes
    body = " ".join(text for _, text in page.text[2:])
    lines = describe_at_length(surface, 'A "still" <life>', language, facts(surface))
    told = " ".join(line.removeprefix("- ") for line in lines if line)
    assert body == told


def test_page_tells_what_is_left_out():
    page = page_of(HapticSurface.from_heights(np.zeros((4, 4))), "x", "en", [told(0), told(1, share=0.0005)])
    assert "</ul>\n<p>One smaller part, 0.1 % of the picture, is left out.</p>\n</main>" in page


def test_page_marks_names_in_another_language():
    page = Page(page_of(still_life(), "Still life", "fr", facts(still_life()), named_in="en-GB"))
    said = {text for language, text in page.text if language == "en-GB"}
    assert said == {"Still life", "wall", "cup"}
    assert ("fr", "partie 2.") in page.text
    alike = page_of(still_life(), "Still life", "en", facts(still_life()), named_in="en")
    assert "<span" not in alike
