"""If one of these fails, a result is taken from the cache for another one, or an impossible record is made."""

import numpy as np
import pytest

from tangible_core import Calibration, DisparityMap, HapticSurface, Material, MaterialMap, Relief, SegmentMap, Views
from tangible_core.data import digest_of
from tangible_core.data.outcome import text_table
from tangible_core.errors import GeometryError, MaterialError, PictureError

ICE = Material("ice", 2000.0, 1.0, 0.1, 0.03)
GREY = np.full((4, 6), 100, np.uint8)
ZEROS = np.zeros((4, 6), np.float32)
LABELS = np.zeros((4, 6), np.int32)


def records():
    yield Calibration(1000.0, 0.1, 2.5)
    yield Views(GREY, GREY.copy(), Calibration(1000.0, 0.1))
    yield DisparityMap(ZEROS)
    yield SegmentMap(LABELS)
    yield Relief(ZEROS, (0.06, 0.04))
    yield MaterialMap((ICE,), ("it is cold",))
    yield HapticSurface.from_heights(ZEROS, 0.06, LABELS, (ICE,))


@pytest.mark.parametrize("record", list(records()), ids=lambda record: type(record).__name__)
class TestEveryRecord:
    def test_record_holds_read_only_arrays(self, record):
        for value in vars(record).values():
            if isinstance(value, np.ndarray):
                with pytest.raises(ValueError, match="read-only"):
                    value[...] = 1

    def test_record_of_equal_content_has_the_same_digest(self, record):
        again = {type(each): each for each in records()}[type(record)]
        assert again is not record
        assert again.digest() == record.digest()


def test_records_of_different_kinds_have_different_digests():
    digests = [record.digest() for record in records()]
    assert len(set(digests)) == len(digests)


def test_digest_differs_for_different_contents():
    last = np.where(np.indices(GREY.shape).sum(0) == 8, 101, 100).astype(np.uint8)
    for other in (GREY.astype(np.uint16), GREY.reshape(6, 4), GREY.reshape(3, 8), last):
        assert Views(other).digest() != Views(GREY).digest()


@pytest.mark.parametrize(("one", "other"), [(1, 1.0), (1, True), ("1", 1), (("a", "b"), ("ab",)), (None, "None")])
def test_digest_differs_for_different_types(one, other):
    assert digest_of(one) != digest_of(other)


@pytest.mark.parametrize(
    ("focal_px", "baseline_m", "offset_px"),
    [(0.0, 0.1, 0.0), (-1.0, 0.1, 0.0), (1.0, 0.0, 0.0), (np.nan, 0.1, 0.0), (1.0, np.inf, 0.0), (1.0, 0.1, np.nan)],
)
def test_calibration_without_positive_finite_values_is_refused(focal_px, baseline_m, offset_px):
    with pytest.raises(GeometryError, match="focal_px > 0 and baseline_m > 0"):
        Calibration(focal_px, baseline_m, offset_px)


@pytest.mark.parametrize(
    ("left", "complaint"),
    [
        (np.zeros(4, np.uint8), r"left view: .* \(4,\)"),
        (np.zeros((4, 6, 2), np.uint8), r"not \(4, 6, 2\)"),
        (np.zeros((0, 6), np.uint8), "empty"),
        (np.full((4, 6), 70_000), "70000"),
        (np.full((4, 6), -1), "-1"),
        (np.zeros((4, 6), np.complex64), "complex64"),
        (np.where(np.arange(6) == 3, np.nan, GREY), "4 values are NaN or infinite, the first at row 0, column 3"),
        (np.full((4, 6, 3), np.inf, np.float32), "72 values are NaN or infinite"),
    ],
)
def test_views_of_an_array_that_is_not_a_picture_are_refused(left, complaint):
    with pytest.raises(PictureError, match=complaint):
        Views(left)
    with pytest.raises(PictureError, match=complaint.replace("left", "right")):
        Views(GREY, left)


def test_views_of_two_sizes_are_refused():
    with pytest.raises(PictureError, match="the left view is 6 x 4 and the right one 4 x 6"):
        Views(GREY, GREY.T)


@pytest.mark.usefixtures("unchecked_shapes")
def test_map_with_a_confidence_of_another_size_is_refused():
    with pytest.raises(PictureError, match="disparity_px is 6 x 4 and confidence is 4 x 6"):
        DisparityMap(ZEROS, ZEROS.T)
    with pytest.raises(PictureError, match="labels is 6 x 4 and confidence is 4 x 6"):
        SegmentMap(LABELS, ZEROS.T)


@pytest.mark.parametrize(
    ("height", "extent_m", "complaint"),
    [
        (np.nan, (0.1, 0.1), "24 values are NaN"),
        (np.inf, (0.1, 0.1), "24 values are NaN"),
        (-0.001, (0.1, 0.1), "lowest"),
        *((0.0, extent_m, "positive width") for extent_m in [(0.0, 0.1), (0.1, -1.0), (0.1, np.nan), (np.inf, 0.1)]),
    ],
)
def test_relief_with_impossible_heights_or_extent_is_refused(height, extent_m, complaint):
    with pytest.raises(GeometryError, match=complaint):
        Relief(np.full((4, 6), height, np.float32), extent_m)


@pytest.mark.parametrize("shape", [(0, 6), (6, 0)])
def test_relief_without_cells_is_refused(shape):
    with pytest.raises(GeometryError, match="at least one cell"):
        Relief(np.zeros(shape, np.float32), (0.1, 0.1))
    with pytest.raises(GeometryError, match="at least one cell"):
        HapticSurface.from_heights(np.zeros(shape))


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.uint8, np.bool_])
def test_surface_from_heights_has_square_cells(dtype):
    surface = HapticSurface.from_heights(np.zeros((4, 6), dtype), width_m=0.06)
    assert surface.extent_m == pytest.approx((0.06, 0.04))
    assert surface.height_m.dtype == np.float32
    assert surface.relief.pitch_m == pytest.approx((0.01, 0.01))


def test_surface_with_labels_of_another_size_is_refused():
    with pytest.raises(GeometryError, match="labels are 4 x 6, heights 6 x 4"):
        HapticSurface.from_heights(ZEROS, labels=np.zeros((6, 4), np.int32))


@pytest.mark.parametrize(("label", "materials"), [(-1, (ICE,)), (-1, None), (1, (ICE,)), (0, ())])
def test_surface_with_a_label_without_material_is_refused(label, materials):
    with pytest.raises(MaterialError, match="labels run from"):
        HapticSurface.from_heights(ZEROS, 0.08, np.full((4, 6), label, np.int32), materials)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"stiffness_n_per_m": -1.0}, "stiffness_n_per_m is -1.0; it must be >= 0"),
        ({"stiffness_n_per_m": 0.0}, "must be above 0"),
        ({"grain_m": 0.0}, "must be above 0"),
        ({"damping_n_s_per_m": np.nan}, "damping_n_s_per_m is nan"),
        ({"static_friction": np.inf}, "static_friction is inf"),
        ({"roughness_m": -1e-6}, "roughness_m is -1e-06"),
        ({"dynamic_friction": 0.2}, "dynamic_friction 0.2 is above static_friction 0.1"),
        ({"anisotropy": 1.5}, "anisotropy 1.5 and irregularity 0.0 are at most 1"),
        ({"texture": "smooth", "roughness_m": 1e-5}, "texture is smooth and roughness_m 1e-05"),
        ({"texture": "drag"}, "needs a drag_n_s_per_m above 0"),
        ({"texture": "stick-slip", "dynamic_friction": 0.0}, "needs a dynamic_friction above 0"),
    ],
)
def test_material_with_contradictory_values_is_refused(change, complaint):
    with pytest.raises(MaterialError, match=f"material 'ice': .*{complaint}"):
        Material(**{**vars(ICE), **change})


def test_text_table_has_columns_and_no_spaces_at_the_end_of_a_line():
    assert text_table(("a", "b", "why"), [("wide", "1", ""), (" x", "22", "so")]) == (
        "a     b   why\nwide  1\n x    22  so"
    )
