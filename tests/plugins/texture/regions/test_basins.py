"""Basins, the seeds of segments."""

import numpy as np

from tangible_texture.regions.basins import basins


class TestBasins:
    HEIGHT = np.array([[1, 1, 9, 3, 3, 9, 2], [1, 1, 9, 3, 3, 9, 2], [9, 9, 9, 9, 9, 9, 9]], np.float32)

    def test_one_level_has_its_connected_parts(self):
        found, count = basins(self.HEIGHT, [1], 4)
        assert count == 1
        assert found.tolist() == [[0, 0, -1, -1, -1, -1, -1]] * 2 + [[-1] * 7]

    def test_higher_level_adds_parts_without_a_basin(self):
        found, count = basins(self.HEIGHT, [1, 3], 4)
        assert count == 2
        assert found.tolist() == [[0, 0, -1, 1, 1, -1, -1]] * 2 + [[-1] * 7]

    def test_part_with_one_basin_belongs_to_it(self):
        found, count = basins(self.HEIGHT, [1, 9], 4)
        assert count == 1
        assert np.all(found == 0)

    def test_part_with_several_basins_stays_as_it_is(self):
        found, count = basins(self.HEIGHT, [3, 9], 4)
        assert count == 2
        assert found.tolist() == [[0, 0, -1, 1, 1, -1, -1]] * 2 + [[-1] * 7]

    def test_part_smaller_than_asked_for_is_no_basin(self):
        for smallest_px, count in ((1, 3), (2, 3), (3, 2), (4, 2), (5, 0)):
            assert basins(self.HEIGHT, [3], smallest_px)[1] == count

    def test_corners_do_not_connect(self):
        assert basins(np.array([[0, 1], [1, 0]], np.float32), [0], 1)[1] == 2
