import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core import (
    Calibration,
    DisparityMap,
    Force,
    HapticState,
    HapticSurface,
    Material,
    MaterialMap,
    Relief,
    SegmentMap,
    Views,
)
from tangible_core.data import digest_of
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
    def test_record_is_frozen(self, record):
        with pytest.raises(AttributeError):
            record.left = None

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


def test_digest_is_the_same_in_every_process():
    code = (
        "import numpy as np; from tangible_core import Calibration, Views; "
        "print(Views(np.arange(24, dtype=np.uint8).reshape(4, 6), None, Calibration(1000.0, 0.1)).digest())"
    )
    mine = Views(np.arange(24, dtype=np.uint8).reshape(4, 6), None, Calibration(1000.0, 0.1)).digest()
    theirs = [
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": seed}
        ).stdout.strip()
        for seed in ("1", "2")
    ]
    assert theirs == [mine, mine]


@pytest.mark.parametrize(
    "other",
    [
        GREY.astype(np.uint16),
        GREY.reshape(6, 4),
        GREY.reshape(3, 8),
        np.where(np.indices(GREY.shape).sum(0) == 8, 101, 100).astype(np.uint8),
    ],
    ids=["type", "transposed shape", "shape", "last pixel"],
)
def test_digest_differs_for_different_contents(other):
    assert Views(other).digest() != Views(GREY).digest()


def test_digest_does_not_depend_on_the_memory_layout():
    values = np.arange(24, dtype=np.uint8).reshape(4, 6)
    wide = np.zeros((8, 12), np.uint8)
    wide[::2, ::2] = values
    assert digest_of(np.asfortranarray(values)) == digest_of(values) == digest_of(wide[::2, ::2])


@given(st.recursive(st.none() | st.booleans() | st.integers() | st.text(), lambda part: st.tuples(part, part)))
def test_digest_of_nested_tuples_depends_on_the_nesting(value):
    assert digest_of((value,)) != digest_of(value)
    assert digest_of((value, value)) == digest_of((value, value)) != digest_of((value,))


@pytest.mark.parametrize(("one", "other"), [(1, 1.0), (1, True), ("1", 1), (("a", "b"), ("ab",)), (None, "None")])
def test_digest_differs_for_different_types(one, other):
    assert digest_of(one) != digest_of(other)


def test_record_leaves_the_callers_array_writable():
    picture = GREY.copy()
    views = Views(picture)
    picture[0, 0] = 0
    assert picture.flags.writeable
    assert views.left.base is picture


@pytest.mark.parametrize(
    ("focal_px", "baseline_m", "offset_px"),
    [(0.0, 0.1, 0.0), (-1.0, 0.1, 0.0), (1.0, 0.0, 0.0), (np.nan, 0.1, 0.0), (1.0, np.inf, 0.0), (1.0, 0.1, np.nan)],
)
def test_calibration_without_positive_finite_values_is_refused(focal_px, baseline_m, offset_px):
    with pytest.raises(GeometryError, match="focal_px > 0 and baseline_m > 0"):
        Calibration(focal_px, baseline_m, offset_px)


@pytest.mark.parametrize("shape", [(4, 6), (4, 6, 3), (4, 6, 4), (1, 1)])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float16, np.float32, np.float64, np.bool_])
def test_views_accept_every_shape_and_type_of_picture(shape, dtype):
    assert Views(np.ones(shape, dtype)).shape == shape[:2]


@pytest.mark.parametrize(
    ("left", "complaint"),
    [
        (np.zeros(4, np.uint8), r"left view: a picture is \(h, w\)"),
        (np.zeros((4, 6, 2), np.uint8), r"not \(4, 6, 2\)"),
        (np.zeros((0, 6), np.uint8), "left view: the picture is empty"),
        (
            np.full((4, 6), 70_000),
            "holds whole numbers from 70000 to 70000",
        ),
        (np.zeros((4, 6), np.complex64), "not complex64"),
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


def test_views_of_two_types_are_accepted():
    assert Views(GREY, np.zeros((4, 6, 4), np.float32)).shape == (4, 6)


def test_disparity_map_without_confidence_trusts_known_pixels():
    known = ZEROS.copy()
    known[1, 2] = np.nan
    found = DisparityMap(known)
    assert found.confidence.dtype == np.float32
    assert found.confidence[1, 2] == 0
    assert found.confidence.sum() == known.size - 1


@pytest.mark.parametrize("values", [np.zeros((0, 6), np.float32), np.zeros((1, 0), np.float32)])
def test_disparity_map_without_pixels_is_refused(values):
    with pytest.raises(PictureError, match="at least one pixel"):
        DisparityMap(values)


@pytest.mark.usefixtures("unchecked_shapes")
def test_map_with_a_confidence_of_another_size_is_refused():
    with pytest.raises(PictureError, match="disparity_px is 6 x 4 and confidence is 4 x 6"):
        DisparityMap(ZEROS, ZEROS.T)
    with pytest.raises(PictureError, match="labels is 6 x 4 and confidence is 4 x 6"):
        SegmentMap(LABELS, ZEROS.T)


def test_segment_map_counts_its_segments():
    labels = LABELS.copy()
    labels[2:] = 4
    assert SegmentMap(labels).count == 5
    assert SegmentMap(labels).confidence.min() == 1


def test_record_of_a_wrong_dtype_is_refused_while_tests_run():
    with pytest.raises(TypeError):
        DisparityMap(np.zeros((4, 6), np.float64))
    with pytest.raises(TypeError):
        SegmentMap(np.zeros((4, 6), np.int64))


@pytest.mark.parametrize(
    ("height", "extent_m", "complaint"),
    [
        (np.nan, (0.1, 0.1), "24 values are NaN or infinite"),
        (np.inf, (0.1, 0.1), "24 values are NaN or infinite"),
        (-0.001, (0.1, 0.1), "the lowest is -0.001 m"),
        (0.0, (0.0, 0.1), "a positive width and length"),
        (0.0, (0.1, -1.0), "a positive width and length"),
        (0.0, (0.1, np.nan), "a positive width and length"),
        (0.0, (np.inf, 0.1), "a positive width and length"),
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


def test_relief_pitch_is_the_size_of_a_cell():
    assert Relief(ZEROS, (0.06, 0.02)).pitch_m == pytest.approx((0.01, 0.005))


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.uint8, np.bool_])
def test_surface_from_heights_has_square_cells(dtype):
    surface = HapticSurface.from_heights(np.zeros((4, 6), dtype), width_m=0.06)
    assert surface.extent_m == pytest.approx((0.06, 0.04))
    assert surface.height_m.dtype == np.float32
    assert surface.relief.pitch_m == pytest.approx((0.01, 0.01))


def test_surface_from_one_height_has_one_cell():
    assert HapticSurface.from_heights(np.zeros((1, 1)), 0.05).extent_m == (0.05, 0.05)


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


@pytest.mark.usefixtures("unchecked_shapes")
def test_material_with_a_misspelt_texture_is_refused_with_a_hint():
    with pytest.raises(MaterialError, match=r"no texture model is named 'smoth' \(did you mean 'smooth'\?\)"):
        Material(**{**vars(ICE), "texture": "smoth"})


def test_forces_and_states_equal_plain_tuples():
    assert Force(1.0, 2.0, 3.0) == (1.0, 2.0, 3.0)
    assert HapticState((0.0, 0.0, 0.0)) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0)
