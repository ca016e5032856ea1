"""Structure tensors of brightness and of shares, against exact ones."""

import numpy as np
import pytest

from tangible_texture.tree.cues import EMPTY, LEVELS, tensors, weighted_strength


def test_ramp_has_the_tensor_of_its_slope():
    rows, columns = np.indices((30, 40), np.float32)
    found = tensors(0.03 * columns - 0.01 * rows, {})
    assert found.shape == (1, 3, 30, 40)
    assert (
        pytest.approx(np.array([[9e-4, -3e-4, 1e-4]] * 22 * 32), rel=1e-3) == found[0, :, 4:-4, 4:-4].reshape(3, -1).T
    )


def test_step_of_shares_has_a_tensor_across_it_at_every_width():
    share = np.zeros((2, 48, 64), np.float32)
    share[0, :, :32], share[1, :, 32:] = 1, 1
    found = tensors(np.zeros((48, 64), np.float32), {"one": share, "none": np.ones((1, 48, 64), np.float32)})
    assert len(found) == 1 + 2 * LEVELS
    assert not found[0].any()
    assert not found[1 + LEVELS :].any()
    for level in range(LEVELS):
        across, mixed, down = found[1 + level]
        assert across[24, 31:33].min() > 0.5 * across.max()
        assert across[24, 31:33].max() > 50 * across[24, 0]
        assert np.abs(mixed).max() < 1e-6
        assert down.max() < 1e-6


def test_wider_windows_change_further_from_the_step():
    share = np.zeros((2, 48, 64), np.float32)
    share[0, :, :32], share[1, :, 32:] = 1, 1
    found = tensors(np.zeros((48, 64), np.float32), {"one": share})[1:, 0, 24]
    widths = [np.count_nonzero(each > each.max() / 2) for each in found]
    assert widths[0] < widths[1] < widths[2]


def test_change_of_shares_is_measured_between_their_square_roots():
    share = np.zeros((1, 3, 200), np.float32)
    share[0] = np.linspace(0.2, 0.4, 200)
    found = tensors(np.zeros((3, 200), np.float32), {"one": share})[1, 0, 1, 20:-20]
    slope = 0.2 / 199
    assert found == pytest.approx(slope**2 / (4 * (share[0, 1, 20:-20] + EMPTY)), rel=1e-3)


def test_strength_is_the_root_of_the_steepest_change_whatever_its_direction():
    angles = np.linspace(0, np.pi, 7)
    steep, flat = 0.09, 0.01
    cosine, sine = np.cos(angles), np.sin(angles)
    tensor = np.array(
        [
            steep**2 * cosine**2 + flat**2 * sine**2,
            (steep**2 - flat**2) * cosine * sine,
            steep**2 * sine**2 + flat**2 * cosine**2,
        ],
        np.float32,
    ).reshape(1, 3, 1, 7)
    both = np.concatenate([tensor, 16 * tensor])
    assert weighted_strength(both, np.float32([1, 0])) == pytest.approx(np.full((1, 7), 0.3), rel=1e-5)
    assert weighted_strength(both, np.float32([1, 2])) == pytest.approx(np.full((1, 7), 0.3 + 2 * 0.6), rel=1e-5)
