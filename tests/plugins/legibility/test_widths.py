"""Widths of parts: if a case fails, a place too narrow for a finger passes, or a wide one is changed."""

import math

import numpy as np
import pytest

from tangible_core.data import PartMap
from tangible_legibility import legibility
from tangible_legibility.widths import Rims, measure

GAP_M = 0.0032


def strip(width_m: float, angle_deg: float, pitch_m: float, size_m: tuple[float, float] = (0.03, 0.036)) -> PartMap:
    """Return a strip through the middle of a picture, and the parts on its two sides."""
    rows, columns = round(size_m[1] / pitch_m), round(size_m[0] / pitch_m)
    y, x = np.indices((rows, columns)) + 0.5
    turn = math.radians(angle_deg)
    far_m = pitch_m * ((y - rows / 2) * math.cos(turn) - (x - columns / 2) * math.sin(turn))
    labels = np.where(np.abs(far_m) < width_m / 2, 1, np.where(far_m < 0, 0, 2)).astype(np.int32)
    return PartMap(labels, (0, 1, 2))


def shape(labels: np.ndarray) -> PartMap:
    return PartMap(labels.astype(np.int32), tuple(range(int(labels.max()) + 1)))


@pytest.mark.parametrize(("pitch_m", "angle_deg"), [(1e-4, 0), (8e-5, 20), (5e-5, 33), (1e-4, 45), (8e-5, 90)])
def test_gap_strip_of_3_1_mm_fails_and_of_3_3_mm_passes(pitch_m, angle_deg):
    verdicts = [legibility("swell", strip(width_m, angle_deg, pitch_m), 0.03) for width_m in (0.0031, 0.0033)]
    gaps = [[each.verdict for each in found if each.check == "gap"] for found in verdicts]
    assert gaps == [["illegible"], ["ok"]]


@pytest.mark.parametrize(("pixels", "grade"), [(15, "illegible"), (16, "ok"), (17, "ok")])
def test_measure_strip_of_even_or_odd_pixels_is_as_wide_as_its_pixels(pixels, grade):
    parts = strip(pixels * 2e-4, 0, 2e-4, (0.03, 0.0200 + 2e-4 * (pixels % 2)))
    wide = measure(parts.labels, 2e-4, GAP_M)
    assert wide.disc_m[1] == pytest.approx(pixels * 2e-4, rel=3e-3)
    assert (not wide.places) == (grade == "ok")


def test_measure_disc_has_its_diameter():
    y, x = np.indices((301, 301)) - 150
    for radius in (20.25, 64, 131.4):
        disc_m = measure(shape(np.hypot(x, y) <= radius).labels, 1e-4, GAP_M).disc_m[1]
        assert disc_m == pytest.approx(2e-4 * radius, abs=1e-4)


def test_measure_rim_is_a_border():
    labels = np.zeros((200, 200), np.int32)
    labels[:, :20] = 1
    assert measure(labels, 1e-4, GAP_M).disc_m.tolist() == pytest.approx(rel=3e-3, expected=[0.002, 0.018])
    assert [place.width_m for place in measure(labels, 1e-4, GAP_M).places] == pytest.approx(rel=3e-3, expected=[0.002])
    assert not measure(labels, 1e-4, GAP_M, Rims(left=False, top=False, bottom=False)).places


def test_places_tongues_and_necks_count_and_right_corners_do_not():
    labels = np.zeros((300, 500), np.int32)
    labels[50:250, 50:200] = 1
    assert not measure(labels, 1e-4, GAP_M).places
    tongue = labels.copy()
    tongue[140:160, 200:260] = 1
    assert [place.width_m for place in measure(tongue, 1e-4, GAP_M).places] == pytest.approx(rel=3e-3, expected=[0.002])
    neck = labels.copy()
    neck[50:250, 220:400] = 1
    neck[140:160, 200:220] = 1
    (place,) = [place for place in measure(neck, 1e-4, GAP_M).places if place.piece == 1]
    assert place.width_m == pytest.approx(0.002, rel=3e-3)
    assert 195 <= place.at[1] < 225
    assert 140 <= place.at[0] < 160


def test_measure_each_connected_piece_has_a_width():
    labels = np.zeros((100, 300), np.int32)
    labels[20:80, 20:80], labels[40:60, 200:220] = 1, 1
    wide = measure(labels, 1e-4, 0.001)
    assert wide.part.tolist() == [0, 1, 1]
    assert wide.disc_m[1:].tolist() == pytest.approx(rel=3e-3, expected=[0.006, 0.002])
