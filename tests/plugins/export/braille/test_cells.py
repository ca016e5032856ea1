"""Places of braille dots and the breaking of lines: if a case fails, braille is unreadable or runs off the page."""

import numpy as np
import pytest

from tangible_core.errors import BrailleError, ConfigError
from tangible_export.braille import DOT_DIAMETER_M, DOT_PITCH_M, dots, height_m, translate, width_m, wrapped


def test_braille_dots_lie_by_nls_specification():
    """Millimetres of NLS Specification 800, 3.2: dots 2.34 apart, cells 6.2, lines 10; y runs down."""
    places = 1000 * dots((0b111111, 0b000000, 0b100001), (0.01, 0.02))
    wanted = [(0, 0), (0, 2.34), (0, 4.68), (2.34, 0), (2.34, 2.34), (2.34, 4.68), (12.4, 0), (14.74, 4.68)]
    assert np.allclose(places, np.add(wanted, (10, 20)), atol=1e-9)
    assert dots(()).shape == dots((0,)).shape == (0, 2)


@pytest.mark.parametrize("count", [1, 2, 40])
def test_braille_width_and_height_enclose_all_dots(count: int):
    places = dots((0b111111,) * count)
    wide, high = np.ptp(places, axis=0) + DOT_DIAMETER_M
    assert width_m((63,) * count) == pytest.approx(wide)
    assert height_m() == pytest.approx(high)
    assert width_m(()) == height_m(0) == 0
    assert height_m(3) == pytest.approx(0.02 + high)


TEXT = "In 1969 the astronaut's helmet stood beside an extraordinarily long table"
WIDE_M = width_m((0,) * 16)


def test_wrapped_lines_break_at_spaces_and_keep_all_cells():
    lines = wrapped(TEXT, "en", WIDE_M)
    assert all(len(line) <= 16 for line in lines)
    assert max(map(len, lines)) > 12
    rejoined = [cell for line in lines for cell in (*line, 0)]
    assert tuple(rejoined[:-1]) == translate(TEXT, "en")
    assert wrapped("", "en", WIDE_M) == wrapped(" \n", "en", WIDE_M) == []


@pytest.mark.parametrize("text", ["noted 15 %", "noted 15\u00a0%", "noted 15\u202fmm"])
def test_wrapped_number_stays_with_its_unit(text: str):
    first, second = wrapped(text, "en", width_m((0,) * 9))
    assert (first, second) == (translate("noted", "en"), translate(text[6:], "en"))


def test_wrapped_lines_have_room_for_their_indent_and_a_single_one_has_none():
    first, *others = wrapped("abcd abcd abc abcd", "en", width_m((0,) * 9), indent=2)
    assert first == translate("abcd abcd", "en")
    assert others == [(0, 0, *translate(word, "en")) for word in ("abc", "abcd")]
    assert wrapped("abcd abcd", "en", width_m((0,) * 9), indent=2) == [first]


def test_wrapped_wide_word_is_broken_after_a_hyphen():
    ten = width_m((0,) * 10)
    lines = wrapped("extraordinarily", "en", ten)
    assert lines == [translate("extraordi-", "en"), translate("narily", "en")]
    assert all(len(line) <= 10 for line in wrapped(TEXT, "en", ten))


def test_wrapped_without_room_is_refused():
    with pytest.raises(BrailleError, match="have room in 5 mm"):
        wrapped("ab", "de", 0.005)
    assert wrapped("a b", "de", DOT_PITCH_M + DOT_DIAMETER_M) == [(1,), (3,)]
    with pytest.raises(ConfigError, match="width_m"):
        wrapped("a", "de", 0.0)
