"""If one of these fails, a cached result is taken for another one, or a device may get more force than it stands."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core import Calibration, DisparityMap, HapticSurface, Material, MaterialMap, Relief, SegmentMap, Views
from tangible_core.data import NO_FORCE, DeviceSpec, Force, SegmentTree, digest_of, limited
from tangible_core.data.outcome import text_table
from tangible_core.errors import ConfigError, GeometryError, MaterialError, PictureError

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
    def test_record_holds_read_only_arrays_and_has_the_digest_of_its_content(self, record):
        for value in vars(record).values():
            if isinstance(value, np.ndarray):
                with pytest.raises(ValueError, match="read-only"):
                    value[...] = 1
        again = {type(each): each for each in records()}[type(record)]
        assert again is not record
        assert again.digest() == record.digest()


def test_digests_differ_by_kind_type_and_contents():
    digests = [record.digest() for record in records()]
    assert len(set(digests)) == len(digests)
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


QUARTERS = np.array([[0, 0, 1], [2, 3, 1]], np.int32)
JOINS = np.array([[1, 3], [0, 2], [4, 5]], np.int32)
LEVELS = np.array([0.125, 0.5, 0.875], np.float32)  # exact in single precision: a level itself is kept


@pytest.mark.parametrize(
    ("most", "level", "labels", "confidence"),
    [
        (9, 0.0, [[0, 0, 1], [2, 3, 1]], [[0.5, 0.5, 0.125], [0.5, 0.125, 0.125]]),
        (3, 0.0, [[0, 0, 2], [1, 2, 2]], [[0.5, 0.5, 0.875], [0.5, 0.875, 0.875]]),
        (9, 0.125, [[0, 0, 1], [2, 3, 1]], [[0.5, 0.5, 0.125], [0.5, 0.125, 0.125]]),
        (9, 0.2, [[0, 0, 2], [1, 2, 2]], [[0.5, 0.5, 0.875], [0.5, 0.875, 0.875]]),
        (9, 0.6, [[1, 1, 0], [1, 0, 0]], [[0.875] * 3] * 2),
        (2, 0.2, [[1, 1, 0], [1, 0, 0]], [[0.875] * 3] * 2),
        (1, 0.0, [[0] * 3] * 2, [[1.0] * 3] * 2),
        (9, 1.0, [[0] * 3] * 2, [[1.0] * 3] * 2),
    ],
)
def test_cut_keeps_borders_of_the_level_and_at_most_the_number(
    most: int, level: float, labels: list[list[int]], confidence: list[list[float]]
):
    found = SegmentTree(QUARTERS, JOINS, LEVELS).cut(most, level)
    assert found.labels.tolist() == labels
    assert found.confidence == pytest.approx(np.array(confidence, np.float32))


SPEC = DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.1, 0.1), 1e-5)


@given(st.tuples(*[st.floats()] * 3), st.floats(1e-3, 1e3))
def test_limited_force_is_finite_within_the_limit_and_keeps_its_direction(parts, most_n: float):
    force = limited(Force(*parts), most_n)
    if not all(map(math.isfinite, parts)):
        assert force == NO_FORCE
    elif math.hypot(*parts) <= most_n:
        assert force == parts
    else:
        assert math.hypot(*force) == pytest.approx(most_n)
        greatest = max(map(abs, parts))
        unit = np.array(parts) / greatest
        assert np.allclose(np.array(force) / most_n, unit / np.linalg.norm(unit), atol=1e-12)


def test_force_one_percent_over_the_limit_is_scaled_down():
    assert limited(Force(0.0, 3.0, 4.0), 5.0) == (0.0, 3.0, 4.0)
    assert limited(Force(0.0, 3.03, 4.04), 5.0) == pytest.approx((0.0, 3.0, 4.0))


@pytest.mark.parametrize("wrong", [math.inf, -1.0, math.nan, 0.0])
@pytest.mark.parametrize("name", ["max_force_n", "max_stiffness_n_per_m", "resolution_m", "damping_n_s_per_m"])
def test_spec_with_a_number_that_no_device_has_is_refused_by_name(name: str, wrong: float):
    if name == "damping_n_s_per_m" and wrong == 0:
        assert replace(SPEC, damping_n_s_per_m=0.0).damping_n_s_per_m == 0
        return
    with pytest.raises(ConfigError, match=rf"^the device's {name}: is {wrong}; it must be positive and finite$"):
        replace(SPEC, **{name: wrong})


@pytest.mark.parametrize("wrong", [(0.1, -0.1, 0.1), (0.1, 0.1, math.inf), (math.nan, 0.1, 0.1)])
def test_spec_with_a_workspace_without_size_is_refused(wrong: tuple[float, float, float]):
    with pytest.raises(ConfigError, match="the device's workspace_m: is"):
        replace(SPEC, workspace_m=wrong)
