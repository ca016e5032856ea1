"""Which regions are merged, in which order."""

import numpy as np

from tangible_texture.regions import merging
from tangible_texture.regions.borders import Border, borders
from tangible_texture.regions.landscape import Landscape
from tangible_texture.regions.merging import merge, number_in_reading_order


class TestMerging:
    LABELS = np.array([[0, 0, 1], [0, 2, 1]], np.int32)
    HEIGHT = np.array([[1, 2, 8], [4, 16, 32]], np.float32)

    def test_borders_are_summed_over_pairs(self):
        edges = np.array([[0, 0, 255], [0, 0, 0]], np.uint8)
        flat = np.zeros_like(self.HEIGHT)
        assert borders(self.LABELS, Landscape(self.HEIGHT, flat, flat), edges, 4) == {
            (0, 1): Border(1, 8, 1),
            (0, 2): Border(2, 32, 0),
            (1, 2): Border(1, 32, 0),
        }

    def test_what_rises_across_a_border_is_an_edge_and_what_rises_along_it_is_none(self):
        edges, flat, steep = np.zeros((2, 3), np.uint8), np.zeros((2, 3), np.float32), np.full((2, 3), -4, np.float32)
        for land, expected in ((Landscape(steep, steep, flat), (1, 1, 1)), (Landscape(steep, flat, steep), (0, 1, 0))):
            found = borders(self.LABELS, land, edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected

    def test_an_oblique_border_may_be_weaker_than_an_edge_begins(self):
        edges = np.zeros((2, 3), np.uint8)
        for across, down, expected in ((1.9, 1.9, (1, 2, 1)), (1.8, 1.8, (0, 0, 0)), (2.7, 1.0, (1, 1, 1))):
            rises = (np.full((2, 3), each, np.float32) for each in (across, down))
            found = borders(self.LABELS, Landscape(self.HEIGHT, *rises), edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected

    def test_one_region_has_no_border(self):
        flat = np.ones((3, 4), np.float32)
        assert borders(np.zeros((3, 4), np.int32), Landscape(flat, flat, flat), np.zeros((3, 4), np.uint8), 4) == {}

    def test_what_edges_do_not_hold_apart_is_merged_however_many_are_wanted(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 1), (0, 2): Border(10, 90, 9)}
        assert merge([50, 50, 50], found, most=9).tolist() == [0, 1, 1]

    def test_the_lowest_border_goes_first_when_fewer_are_wanted(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 9), (2, 3): Border(10, 60, 9)}
        assert merge([50] * 4, found, most=4).tolist() == [0, 1, 2, 3]
        assert merge([50] * 4, found, most=3).tolist() == [0, 1, 1, 3]
        assert merge([50] * 4, found, most=1).tolist() == [0] * 4

    def test_a_small_region_gives_way_before_a_large_one(self):
        found = {(0, 1): Border(10, 50, 9), (1, 2): Border(10, 60, 9)}
        assert merge([5000, 5000, 20], found, most=2).tolist() == [0, 1, 1]

    def test_borders_add_up_when_regions_merge(self):
        found = {(0, 1): Border(10, 10, 0), (0, 2): Border(9, 90, 2), (1, 2): Border(1, 9, 1)}
        assert merge([50] * 3, found, most=9).tolist() == [0, 0, 0]  # 3 of 10 pairs: neither holds

    def test_labels_are_in_reading_order(self):
        labels = np.array([[3, 3, 1], [0, 2, 1]], np.int32)
        assert number_in_reading_order(labels).tolist() == [[0, 0, 1], [2, 3, 1]]

    def test_a_region_beside_many_is_merged_with_them_one_by_one(self, monkeypatch):
        """Of a ground with a thousand grains nothing is queued again that its area says nothing about."""
        queued = []
        push = merging.heapq.heappush
        monkeypatch.setattr(merging.heapq, "heappush", lambda queue, each: (queued.append(each), push(queue, each)))
        star = {(0, grain): Border(10, 10, 3) for grain in range(1, 1000)}
        assert not merge([50] * 1000, star, most=1).any()
        assert len(queued) == len(star)
