"""The surface as the page of a study gets it: without names, on a grid that is no finer than the page needs."""

from base64 import b64decode

import numpy as np
import pytest

from tangible_core import HapticSurface
from tangible_core.materials.assignment import library
from tangible_study.desks.page import MAX_CELLS, surface_for_page


def test_surface_is_packed_without_what_would_name_it():
    heights = np.float32(np.arange(12).reshape(3, 4) / 1000)
    labels = np.int32([[0, 0, 1, 1]] * 3)
    made_of = tuple(library()[each] for each in ("wood", "sand"))
    sent = surface_for_page(HapticSurface.from_heights(heights, 0.08, labels, made_of), 7)
    meta = sent["meta"]
    assert np.array_equal(np.frombuffer(b64decode(sent["heights"]), "<f4").reshape(3, 4), heights)
    assert np.frombuffer(b64decode(sent["labels"]), "<u2").tolist() == labels.ravel().tolist()
    assert (sent["kinds"], [each["name"] for each in meta.pop("materials")]) == ([0, 1], ["", ""])
    assert meta == {
        "digest": "7", "name": "", "shows": "surface", "rows": 3, "columns": 4, "extent_m": pytest.approx([0.08, 0.06]),
        "height_m": pytest.approx([0.0, 0.011]), "levels": [{"step": 1, "rows": 3, "columns": 4}], "labels": 2,
        "label_bytes": 2, "parts": None, "photo": False, "fine_photo": None, "layers": {},
    }  # fmt: skip
    bare = surface_for_page(HapticSurface.from_heights(heights, 0.08), 8)
    assert (bare["labels"], bare["kinds"], bare["meta"]["labels"], bare["meta"]["materials"]) == ("", [], 0, [])


def test_large_surface_has_fewer_cells_of_which_labels_are_of_the_middles():
    labels = (np.indices((900, 1200))[1] >= 700).astype(np.int32)
    made_of = tuple(library()[each] for each in ("wood", "sand"))
    surface = HapticSurface.from_heights(np.float32(labels * 0.001), 0.12, labels, made_of)
    sent = surface_for_page(surface, 1)
    rows, columns = sent["meta"]["rows"], sent["meta"]["columns"]
    assert 0.8 * MAX_CELLS < rows * columns <= MAX_CELLS and columns / rows == pytest.approx(4 / 3, rel=0.01)
    at = np.frombuffer(b64decode(sent["labels"]), "<u2").reshape(rows, columns)
    middle = ((np.arange(columns) + 0.5) * 1200 / columns).astype(int)
    assert np.array_equal(at[0], middle >= 700)
    assert np.frombuffer(b64decode(sent["heights"]), "<f4").size == rows * columns
    assert sent["meta"]["extent_m"] == pytest.approx([0.12, 0.09])
