"""The frames of a film as reliefs: without a common scale the ground moves under the hand from frame to frame."""

from contextlib import suppress

import numpy as np
import pytest

from films import GivenFrames, NearnessOfGrey, greys
from tangible_core.errors import GeometryError
from tangible_core.relief import ReliefScale
from tangible_core.relief.shaping import STRAIGHT
from tangible_core.scene.geometry import ValueRange
from tangible_core.session.film import Reliefs
from tangible_core.session.film.reliefs import ADAPTS_S, Scale

GROUND = np.full((8, 12), 20.0)
BOX = GROUND.copy()
BOX[2:5, 3:7] = 80
NEARER = BOX.copy()
NEARER[4:8, 8:11] = 120


def heights(*pictures):
    """Return the heights of the frames of a film."""
    with Reliefs(lambda: GivenFrames(greys(*pictures)), NearnessOfGrey()) as reliefs:
        return [relief.relief.height_m for relief in reliefs]


def test_scale_of_the_first_frame_is_kept():
    film = heights(BOX, *[NEARER] * 5)
    assert film[-1][6, 9] == film[-1][2, 3] == pytest.approx(0.01), "what is nearer is clipped, and pushes nothing down"
    assert film[-1][0, 0] == 0


def test_scale_is_looked_at_in_each_eighth_frame_after_the_first():
    film = heights(BOX, *[NEARER] * 17)
    box = np.array([each[2, 3] for each in film])
    assert np.flatnonzero(np.diff(box)).tolist() == [7, 15], "between frames 7 and 8, and 15 and 16"


def test_scale_follows_with_its_time_constant_at_any_rate():
    for step_s in (0.1, 1.0):
        scale, seen = Scale(ReliefScale(ValueRange(0, 10), STRAIGHT)), ReliefScale(ValueRange(-5, 20), STRAIGHT**2)
        for number in range(1, round(ADAPTS_S / step_s) + 1):
            scale.look(seen, number * step_s)
        assert scale.current.spans == pytest.approx((-5 + 5 / np.e, 20 - 10 / np.e))
        assert np.allclose(scale.current.tones, STRAIGHT**2 + (STRAIGHT - STRAIGHT**2) / np.e)


def test_scale_of_film_that_begins_dark_adopts_the_first_range():
    film = heights(*[GROUND] * 2, *[BOX] * 30)
    assert not film[0].any()
    assert film[-1][2, 3] == pytest.approx(0.01)


def test_cut_determines_range_and_cameras_again():
    maker = NearnessOfGrey()
    other = 200 - BOX / 2
    with Reliefs(lambda: GivenFrames(greys(BOX, BOX, other, other)), maker) as reliefs:
        film = [relief.relief.height_m for relief in reliefs]
    assert maker.begun == 2
    assert np.array_equal(film[2], film[1]), "one frame late"
    assert film[3][0, 0] == pytest.approx(0.01) and film[3][2, 3] == 0


def test_scene_after_a_dark_pause_begins_with_its_own_range():
    maker, dark, other = NearnessOfGrey(), np.full((8, 12), 255.0), 200 - BOX / 2
    film = []
    with Reliefs(lambda: GivenFrames(greys(BOX, *[dark] * 12, *[other] * 3)), maker) as reliefs:
        while (frame := reliefs.frames.next()) is not None:
            with suppress(GeometryError):
                film.append(reliefs.make(frame).relief.height_m)
    assert maker.begun == 2
    assert film[-1][0, 0] == pytest.approx(0.01) and film[-1][2, 3] == 0, "the range is the new one"
