import numpy as np
import pytest
import torch

from tangible_depth.windows.torch_zncc import OUTSIDE, best_shifts, match, scores
from two_cameras import Scene


def random_pair(*shape, seed=0, dtype=torch.float64):
    return torch.rand(2, *shape, generator=torch.Generator().manual_seed(seed), dtype=dtype)


def test_scores_are_correlations_of_windows():
    left, right = random_pair(1, 1, 9, 12)
    volume = scores(left, right, -2, 4, 3)
    assert volume.shape == (1, 7, 9, 12)
    padded = [np.pad(picture[0, 0].numpy(), 1, mode="edge") for picture in (left, right)]
    for y, x, d in ((4, 6, 0), (0, 5, 3), (8, 11, -0), (3, 4, 4), (2, 9, -2)):
        windows = [part[y : y + 3, c : c + 3].ravel() for part, c in zip(padded, (x, x - d), strict=True)]
        assert volume[0, d + 2, y, x].item() == pytest.approx(np.corrcoef(*windows)[0, 1], abs=1e-9)


def test_flat_or_outside_windows_have_no_score():
    left, right = random_pair(1, 1, 6, 8)
    volume = scores(left, right, -1, 3, 3)
    assert (volume[0, 4, :, :3] == OUTSIDE).all()
    assert (volume[0, 0, :, 7:] == OUTSIDE).all()
    flat = torch.full((1, 1, 6, 8), 0.7)
    assert (scores(flat, flat, 0, 3, 3) == OUTSIDE).all()


def test_gradients_of_scores_are_right():
    left, right = random_pair(1, 1, 4, 5)
    torch.autograd.gradcheck(
        lambda a, b: torch.softmax(5.0 * scores(a, b, 0, 2, 3), dim=1), (left.requires_grad_(), right.requires_grad_())
    )


def test_shift_is_found_to_sub_pixel_and_checked_from_the_right():
    scene = Scene(wall_px=5.4, box_px=12.7)
    left, right = (torch.from_numpy(grey)[None, None] for grey in (scene.left(), scene.right()))
    found = match(left, right, 0, 20, 7)
    error = np.abs(found.disparity_px[0].numpy() - scene.disparity_px())
    known = np.isfinite(error)
    assert known.mean() > 0.8
    assert np.median(error[known]) < 0.15
    hidden = ~scene.visible()
    assert known[hidden].mean() < 0.5 * known[~hidden].mean()
    assert ((found.score >= 0) & (found.score <= 1)).all()


def test_left_right_check_is_exact():
    # Left pixel 1 matches right pixel 0 at 0.9, left pixel 0 the same at 0.5: only the better one stays.
    volume = torch.full((1, 2, 1, 2), OUTSIDE)
    volume[0, 0, 0, 0], volume[0, 1, 0, 1], volume[0, 0, 0, 1] = 0.5, 0.9, 0.1
    found = best_shifts(volume, 0)
    assert torch.isnan(found.disparity_px[0, 0, 0])
    assert found.disparity_px[0, 0, 1] == 1
    assert found.score[0, 0].tolist() == pytest.approx([0, 0.9])


def test_strips_and_batches_give_the_same_result():
    pair = random_pair(3, 1, 40, 30, dtype=torch.float32)
    whole = match(*pair, -3, 9, 5)
    strips = match(*pair, -3, 9, 5, memory_mb=0)
    for a, b in zip(whole, strips, strict=True):
        assert torch.allclose(a, b, atol=1e-3, equal_nan=True)
    alone = match(pair[0][1:2], pair[1][1:2], -3, 9, 5)
    assert torch.allclose(alone.disparity_px[0], whole.disparity_px[1], atol=1e-4, equal_nan=True)


def test_torch_search_agrees_with_the_compiled_one():
    from tangible_depth.sparse.matches import inverse_lengths
    from tangible_depth.sparse.sparse_ncc import match_rows

    scene = Scene()
    left, right = scene.left(), scene.right()
    dense = match(*(torch.from_numpy(grey)[None, None] for grey in (left, right)), 0, 20, 7)
    points = np.column_stack([part.ravel() for part in np.mgrid[30:170:3, 10:140:3]])
    disparity, score = np.empty(len(points), np.float32), np.empty(len(points), np.float32)
    padded = [np.pad(grey, 3, mode="edge") for grey in (left, right)]
    match_rows(*padded, *(inverse_lengths(grey, 3) for grey in (left, right)), points, 0, 20, 3, disparity, score)
    theirs = dense.disparity_px[0].numpy()[points[:, 1], points[:, 0]]
    both = np.isfinite(disparity) & np.isfinite(theirs)
    assert both.mean() > 0.8
    assert disparity[both] == pytest.approx(theirs[both], abs=0.01)
    assert score[both] == pytest.approx(dense.score[0].numpy()[points[:, 1], points[:, 0]][both], abs=1e-3)
