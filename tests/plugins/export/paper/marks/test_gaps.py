"""Gaps between marks: if a case fails, marks that a finger cannot tell apart go to print."""

import pytest

from tangible_core.errors import BrokenMethod
from tangible_export.paper.marks.gaps import too_near
from tangible_export.paper.marks.reading import read

SIZE = 'width="80mm" height="60mm" viewBox="0 0 80 60"'


def near(shapes: str):
    return too_near(read(f'<svg xmlns="http://www.w3.org/2000/svg" {SIZE}>{shapes}</svg>'))


def disc(x: float, y: float, what: str = "fill") -> str:
    return f'<g data-mark="{what}" aria-label="{what} {x}"><circle cx="{x}" cy="{y}" r="1"/></g>'


def line(*at: tuple[float, float], closed: bool = True) -> str:
    path = "M" + "L".join(f"{x} {y}" for x, y in at) + ("Z" if closed else "")
    return f'<path data-mark="outline" aria-label="part" fill="none" stroke="#000" stroke-width="1" d="{path}"/>'


@pytest.mark.parametrize(("x", "y"), [(1.0, 0.0), (0.6, 0.8), (-0.8, 0.6)])
@pytest.mark.parametrize("gap_mm", [3.1, 3.35])
def test_gap_is_measured_within_a_pixel_in_any_direction(gap_mm, x, y):
    pairs = near(disc(40, 30) + disc(40 + x * (2 + gap_mm), 30 + y * (2 + gap_mm)))
    if gap_mm > 3.2:
        assert not pairs
    else:
        assert [pair.gap_mm for pair in pairs] == pytest.approx([gap_mm], abs=0.11)


def stroke(*at: tuple[float, float]) -> str:
    path = "M" + "L".join(f"{x} {y}" for x, y in at)
    return f'<path data-mark="fill" aria-label="{path}" fill="none" stroke="#000" stroke-width="1" d="{path}"/>'


def test_gap_is_exact_along_the_pixels_and_has_its_place():
    [pair] = near(stroke((40, 10), (40, 20)) + stroke((44, 10), (44, 20)))
    assert pair.gap_mm == pytest.approx(3)
    assert pair.place_mm[0] == pytest.approx(42, abs=0.2)
    assert 9.5 <= pair.place_mm[1] <= 20.5


def test_gap_of_long_marks_is_the_narrowest():
    [pair] = near(stroke((10, 20), (70, 20)) + stroke((10, 23), (70, 25)))
    assert pair.gap_mm == pytest.approx(2, abs=0.1)


def test_gap_between_dots_counts_between_texts_only():
    dots = '<circle cx="40" cy="30" r="0.72"/><circle cx="42.34" cy="30" r="0.72"/>'
    assert not near(f'<g data-mark="braille">{dots}</g>')
    one, other = (f'<g data-mark="braille" aria-label="{n}">{dot}/></g>' for n, dot in enumerate(dots.split("/>")[:2]))
    assert [each.gap_mm for each in near(one + other)] == pytest.approx([0.9], abs=0.11)


def test_gap_of_touching_marks_is_zero():
    [pair] = near(disc(40, 30) + disc(41.5, 30, "braille"))
    assert pair.gap_mm == 0
    [pair] = near(line((10, 10), (70, 10), (70, 50), (10, 50)) + disc(40, 11))
    assert pair.gap_mm == 0
    assert not near(line((10, 10), (40, 10), (40, 50), (10, 50)) + line((40, 10), (70, 10), (70, 50), (40, 50)))


def test_gap_within_one_net_of_outlines_is_measured():
    neck = [(10, 10), (70, 10), (70, 50), (42, 50), (42, 24), (10, 24)]
    assert not near(line(*neck))
    throat = [(10, 10), (70, 10), (70, 50), (10, 50), (10, 33), (40, 33), (40, 30), (10, 30)]
    pairs = near(line(*throat))
    assert pairs
    assert min(pair.gap_mm for pair in pairs) == pytest.approx(2, abs=0.4)
    assert all(pair.between_outlines for pair in pairs)


def test_gap_within_a_part_names_this_part_and_not_one_around_it():
    frame = line((2, 2), (78, 2), (78, 58), (2, 58)).replace('"part"', '"frame"')
    upper, lower = [(10, 10), (30, 10), (30, 28.5), (50, 28.5), (50, 10), (70, 10)], [(70, 50), (50, 50), (50, 31.5)]
    pairs = near(frame + line(*upper, *lower, (30, 31.5), (30, 50), (10, 50)))
    assert {mark.label for pair in pairs for mark in pair.marks} == {"part"}


@pytest.mark.parametrize("shapes", ["<text>a</text>", '<path d="M0 0h5z"/>'])
def test_reading_svg_with_other_elements_is_refused(shapes):
    with pytest.raises(BrokenMethod):
        near(shapes)
