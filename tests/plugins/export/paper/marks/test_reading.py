"""Marks read from the text of a page, and the pixels that they cover."""

import numpy as np
import pytest

from tangible_core.errors import BrokenMethod
from tangible_export.paper.marks.reading import read
from tangible_export.paper.marks.rendering import black


def page(shapes: str, box: str = "0 0 8 6"):
    return read(f'<svg xmlns="http://www.w3.org/2000/svg" width="8mm" height="6mm" viewBox="{box}">{shapes}</svg>')


@pytest.mark.parametrize("box", ["0 0 6 8", "0 0 80 60", "1 0 8 6"])
def test_page_with_another_view_box_than_its_size_is_refused(box: str):
    with pytest.raises(BrokenMethod, match="the view box of a page is its size in millimetres"):
        page("", box)


def test_closed_line_ends_where_it_begins():
    [mark] = page('<path data-mark="outline" stroke="#000" stroke-width="1" d="M1 1L5 1L5 4Z"/>').marks
    assert np.asarray(mark.shape.vertices).tolist() == [[1, 1], [5, 1], [5, 4], [1, 1]]
    assert np.asarray(mark.shape.codes).tolist() == [1, 2, 2, 79]
    assert mark.stroke_mm == 1


def test_pixel_is_black_that_ink_covers_by_half():
    ink = black(page('<path data-mark="fill" d="M1 2L2.03 2L2.03 2.97L1 2.97Z"/>'), 10)
    assert ink.shape == (60, 80)
    assert np.flatnonzero(ink.any(axis=0)).tolist() == list(range(10, 20))
    assert np.flatnonzero(ink.any(axis=1)).tolist() == list(range(20, 30))
