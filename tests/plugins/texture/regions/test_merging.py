"""The order in which regions are merged."""

import numpy as np

from tangible_texture.regions import merging
from tangible_texture.regions.borders import Border, borders
from tangible_texture.regions.landscape import Landscape
from tangible_texture.regions.merging import merge, number_in_reading_order, weakest_border


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

    def test_slope_across_a_border_is_an_edge_and_along_it_is_not(self):
        edges, flat, steep = np.zeros((2, 3), np.uint8), np.zeros((2, 3), np.float32), np.full((2, 3), -4, np.float32)
        for land, expected in ((Landscape(steep, steep, flat), (1, 1, 1)), (Landscape(steep, flat, steep), (0, 1, 0))):
            found = borders(self.LABELS, land, edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected

    def test_oblique_border_may_be_weaker_than_an_edge(self):
        edges = np.zeros((2, 3), np.uint8)
        for across, down, expected in ((1.9, 1.9, (1, 2, 1)), (1.8, 1.8, (0, 0, 0)), (2.7, 1.0, (1, 1, 1))):
            rises = (np.full((2, 3), each, np.float32) for each in (across, down))
            found = borders(self.LABELS, Landscape(self.HEIGHT, *rises), edges, 4)
            assert tuple(found[pair].edges for pair in ((0, 1), (0, 2), (1, 2))) == expected

    def test_one_region_has_no_border(self):
        flat = np.ones((3, 4), np.float32)
        assert borders(np.zeros((3, 4), np.int32), Landscape(flat, flat, flat), np.zeros((3, 4), np.uint8), 4) == {}

    def test_regions_without_edges_between_are_merged_for_any_number(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 1), (0, 2): Border(10, 90, 9)}
        assert merge([50, 50, 50], found, most=9).tolist() == [0, 1, 1]

    def test_lowest_border_goes_first_for_a_smaller_number(self):
        found = {(0, 1): Border(10, 90, 9), (1, 2): Border(10, 50, 9), (2, 3): Border(10, 60, 9)}
        assert merge([50] * 4, found, most=4).tolist() == [0, 1, 2, 3]
        assert merge([50] * 4, found, most=3).tolist() == [0, 1, 1, 3]
        assert merge([50] * 4, found, most=1).tolist() == [0] * 4

    def test_small_region_is_merged_before_a_large_one(self):
        found = {(0, 1): Border(10, 50, 9), (1, 2): Border(10, 60, 9)}
        assert merge([5000, 5000, 20], found, most=2).tolist() == [0, 1, 1]

    def test_borders_of_merged_regions_add_up(self):
        found = {(0, 1): Border(10, 10, 0), (0, 2): Border(9, 90, 2), (1, 2): Border(1, 9, 1)}
        assert merge([50] * 3, found, most=9).tolist() == [0, 0, 0]  # 3 of 10 pairs: neither holds

    def test_border_with_six_edges_of_ten_holds(self):
        for edges, merged in ((6, [0, 1]), (5.9, [0, 0])):
            assert merge([50, 50], {(0, 1): Border(10, 50, edges)}, most=2).tolist() == merged

    def test_weakest_border_is_that_of_the_merged_regions(self):
        """Regions 0 and 1 are one: with 2 it has 3 of 10 and 9 of 10, with 3 it has 7 of 10."""
        found = {(0, 1): Border(10, 0, 0), (0, 2): Border(10, 0, 3), (1, 2): Border(10, 0, 9), (1, 3): Border(10, 0, 7)}
        assert weakest_border(found, np.array([0, 0, 2, 3], np.int32)) == 0.6
        assert weakest_border(found, np.array([0, 0, 2, 0], np.int32)) == 0.6
        assert weakest_border(found, np.array([3, 3, 2, 0], np.int32)) == 0.6
        assert weakest_border(found, np.array([0, 0, 0, 3], np.int32)) == 0.7
        assert weakest_border(found, np.zeros(4, np.int32)) == 0

    def test_small_region_is_weighed_by_the_product_of_areas_over_their_sum(self):
        found = {(0, 1): Border(10, 50, 9), (1, 2): Border(10, 60, 9), (2, 3): Border(10, 45, 9)}
        assert merge([100, 100, 100, 1000], found, most=3).tolist() == [0, 0, 2, 3]
        assert merge([1000, 100, 60, 1000], found, most=3).tolist() == [0, 1, 1, 3]
        alike = {(0, 1): Border(10, 50, 9), (2, 3): Border(10, 50, 9)}
        assert merge([100, 100, 1000, 20], alike, most=3).tolist() == [0, 1, 2, 2]

    def test_labels_renumbered_are_in_reading_order(self):
        labels = np.array([[3, 3, 1], [0, 2, 1]], np.int32)
        assert number_in_reading_order(labels).tolist() == [[0, 0, 1], [2, 3, 1]]

    def test_region_with_many_neighbours_queues_each_border_once(self, monkeypatch):
        """A ground with a thousand grains queues no border again that its area does not affect."""
        queued = []
        push = merging.heapq.heappush
        monkeypatch.setattr(merging.heapq, "heappush", lambda queue, each: (queued.append(each), push(queue, each)))
        star = {(0, grain): Border(10, 10, 3) for grain in range(1, 1000)}
        assert not merge([50] * 1000, star, most=1).any()
        assert len(queued) == len(star)
