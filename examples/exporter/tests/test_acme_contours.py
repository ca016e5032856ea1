import numpy as np
import pytest
from acme_contours.contours import Contours

from tangible_core import Relief
from tangible_core.errors import GeometryError
from tangible_core.plugins import Work
from tangible_core.testing import conforms

test_contours = conforms("export", "acme-contours")


def work(top_m: float) -> Work:
    heights_m = np.zeros((30, 40), np.float32)
    heights_m[10:20, 5:15] = top_m
    return Work("A box", "en", {"relief": Relief(heights_m, (0.08, 0.06))})


def test_a_box_is_as_many_lines_as_it_has_steps(tmp_path):
    (path,) = Contours(step_m=0.001).write(work(0.0031), tmp_path / "box")
    text = path.read_text()
    assert text.count("<path") == 3
    assert 'width="80.000mm" height="60.000mm"' in text
    assert "M11.000,21.000" in text, "its corner: the sixth cell of 2 mm, the eleventh row"


def test_what_has_no_line_is_refused(tmp_path):
    with pytest.raises(GeometryError, match="make step_m smaller"):
        Contours(step_m=0.01).write(work(0.003), tmp_path / "box")
