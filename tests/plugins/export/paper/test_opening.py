"""Parts opened where a finger has no room: if a case fails, a page keeps a slit, or loses a part without a note."""

import numpy as np

from exported_pictures import labels_work
from tangible_core.data import PartMap
from tangible_core.plugins.notes import collected
from tangible_export.paper import opening
from tangible_export.paper.opening import open_at, open_parts


def test_parts_are_opened_at_the_place_and_nowhere_else():
    labels = np.zeros((60, 120), np.int32)
    labels[:, 88:93] = 1
    opened = open_at(PartMap(labels, (0, 1)), np.array([[0.75, 0.1]]), 0.12, 1).labels
    assert opened[12, 90] == 0
    assert (opened[25:] == labels[25:]).all()
    assert (opened[:, :80] == 0).all()


def test_pieces_too_small_for_a_disc_go_to_their_neighbour():
    """A disc 4.2 mm wide has 13.9 square millimetres."""
    labels = np.zeros((40, 60), np.int32)
    labels[5:10, 5:10] = labels[20:23, 40:43] = 1
    without = opening._without_crumbs(labels, 0.001)
    assert (np.flatnonzero(without.any(axis=1)).tolist(), without.sum()) == ([5, 6, 7, 8, 9], 25)


def test_parts_have_a_grid_of_a_quarter_of_a_millimetre_and_lost_ones_are_named():
    labels = np.zeros((200, 1600), np.int32)
    labels[:, 800:], labels[90:98, :] = 1, 2  # 1 mm
    work = labels_work(labels, ("left", "right", "thread"))
    with collected() as notes:
        opened = open_parts(work, work.simplified, 0.2)
    assert (opened.labels.shape, np.unique(opened.labels).tolist()) == ((100, 800), [0, 1])
    assert notes == ["no room for thread: narrower than 4.2 mm between the middles of outlines"]
