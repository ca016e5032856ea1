"""What is spoken while a hand explores a picture is enough to rebuild it, by a program that is not fooled."""

import re

import numpy as np
import pytest

from benchmarks import by_ear
from benchmarks.by_ear_pictures import pictures
from benchmarks.by_ear_rebuild import rebuild


def test_pictures_are_rebuilt_from_what_is_spoken_alone():
    made = pictures()
    said = by_ear.announced(made, by_ear.STROKES)
    scores = [by_ear.score(picture, rebuild(each), each) for picture, each in zip(made, said, strict=True)]
    assert len(scores) == 10 and min(each.parts for each in scores) >= 5
    for name in ("precision", "recall", "order"):
        assert np.mean([getattr(each, name) for each in scores]) >= by_ear.LEAST, (name, scores)
    assert min(min(each.precision, each.recall, each.order) for each in scores) >= 0.8, scores

    contacts = [re.findall(r"Touching [^.]+\.", " ".join(each)) for each in said]  # without what a stroke tells
    assert all(not rebuild(each).touching for each in contacts)
    mixed = by_ear.score(made[1], rebuild(said[5]), said[5])  # what was said of another picture
    assert mixed.recall < 0.5


def test_rebuild_reads_edges_and_takes_no_step_over_what_was_left_out():
    found = rebuild(
        [
            "Touching wall, stone.",
            "Up 1.2 mm: helmet, glass. Level: wood, part 4.",
            "Over 2 other edges; Down 3.0 mm: table, wood. Right rim of the picture.",
            "In the air.",
            "Touching sea.",
        ]
    )
    assert found.touching == {frozenset({"wall", "helmet"}), frozenset({"helmet", "part 4"})}
    assert found.height_mm["helmet"] - found.height_mm["wall"] == pytest.approx(1.2)
    assert found.height_mm["part 4"] == pytest.approx(found.height_mm["helmet"])
