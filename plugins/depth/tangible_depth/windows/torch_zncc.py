"""Dense zero-mean normalised cross-correlation in torch of tensors (b, 1, h, w), white at 1; import it in a verb."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import reduce
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float32
from torch import Tensor
from torch.nn.functional import pad

from tangible_core.runtime import TorchDevice, pick_device

# Smallest variance of a window, white being 1: a smaller one is rounding error of float32.
FLAT_VARIANCE = 1e-7
# Score if the right window's centre is outside the picture, or a window is flat: never the best.
OUTSIDE = -1.0
SAME_SCORE = 1e-5  # largest difference of equal scores, the rounding of float32


class BestMatches(NamedTuple):
    """The best shift of each left pixel (b, h, w) in pixels, NaN without one, and its score in 0..1."""

    disparity_px: Tensor
    score: Tensor


def scores(left: Tensor, right: Tensor, low: int, high: int, window_px: int) -> Tensor:
    """Compute ZNCC of left pixels with right ones d = low..high to their left: (b, high - low + 1, h, w), in -1..1."""
    half = window_px // 2
    middle = (left.mean(dim=(-2, -1), keepdim=True) + right.mean(dim=(-2, -1), keepdim=True)) / 2
    edges = (half, half, half, half)
    left, right = (pad(picture - middle, edges, mode="replicate") for picture in (left, right))
    left_mean, left_variance = _statistics(left, window_px)
    right_mean, right_variance = (_shift(part, low, high, 0.0) for part in _statistics(right, window_px))
    products = _mean(left * _shift(right, low, high, 0.0), window_px)
    is_textured = (left_variance > FLAT_VARIANCE) & (right_variance > FLAT_VARIANCE)
    spread = torch.where(is_textured, left_variance * right_variance, 1.0).sqrt()
    return torch.where(is_textured, (products - left_mean * right_mean) / spread, OUTSIDE)


def _statistics(padded: Tensor, window_px: int) -> tuple[Tensor, Tensor]:
    mean = _mean(padded, window_px)
    return mean, _mean(padded * padded, window_px) - mean * mean


def _mean(padded: Tensor, window_px: int) -> Tensor:
    columns, rows = padded.shape[-1] - window_px + 1, padded.shape[-2] - window_px + 1
    # Sums of slices are ten times as fast as torch's pooling, and a GPU's convolution would round to 10 bits.
    along = reduce(torch.add, (padded[..., i : i + columns] for i in range(window_px)))
    return reduce(torch.add, (along[..., i : i + rows, :] for i in range(window_px))) / window_px**2


def _shift(values: Tensor, low: int, high: int, outside: float) -> Tensor:
    """Shift (b, 1, h, w) right by low..high: (b, high - low + 1, h, w), `outside` beyond its edges."""
    width = values.shape[-1]
    before, after = max(high, 0), max(-low, 0)
    wide = pad(values, (before, after), value=outside)
    return torch.cat([wide[..., before - d : before - d + width] for d in range(low, high + 1)], dim=1)


def best_shifts(volume: Tensor, low: int) -> BestMatches:
    """Find the best of scores (b, n, h, w) of disparities low, low + 1, ..., with a left-right check and a parabola."""
    count, width = volume.shape[1], volume.shape[-1]
    value, at = volume.max(dim=1)
    columns = torch.arange(width, device=volume.device)
    right_columns = (columns - at - low).clamp(0, width - 1)
    mutual = value >= _right_best(volume, low).gather(-1, right_columns)
    before = volume.gather(1, (at - 1).clamp(0)[:, None])[:, 0]
    after = volume.gather(1, (at + 1).clamp(max=count - 1)[:, None])[:, 0]
    # As in a picture that is constant along its rows.
    level = torch.minimum(before, after) >= value - SAME_SCORE if count > 1 else torch.zeros_like(mutual)
    bend = 2 * value - before - after
    has_peak = (at > 0) & (at < count - 1) & (before > OUTSIDE) & (after > OUTSIDE) & (bend > 0)
    move = torch.where(has_peak, 0.5 * (after - before) / torch.where(has_peak, bend, 1.0), 0.0)
    valid_mask = mutual & (value > 0) & ~level
    return BestMatches(
        torch.where(valid_mask, at + low + move, torch.nan), torch.where(valid_mask, value.clamp(0, 1), 0.0)
    )


def _right_best(volume: Tensor, low: int) -> Tensor:
    """Return the best score of each right pixel (b, h, w): its scores lie on the volume's diagonals."""
    width = volume.shape[-1]
    best = torch.full_like(volume[:, 0], OUTSIDE)
    for k, scores_at in enumerate(volume.unbind(dim=1)):
        d = low + k
        first, last = max(0, d), min(width, width + d)
        if first < last:
            part = best[..., first - d : last - d]
            part.copy_(torch.maximum(part, scores_at[..., first:last]))
    return best


def match(left: Tensor, right: Tensor, low: int, high: int, window_px: int, memory_mb: int = 64) -> BestMatches:
    """Find the best shift of every pixel in low..high, in strips of rows whose scores take about memory_mb."""

    def one_strip(first: int, last: int, skip: int, rows: int) -> BestMatches:
        with torch.no_grad():
            volume = scores(left[..., first:last, :], right[..., first:last, :], low, high, window_px)
            return BestMatches(*(part[..., skip : skip + rows, :] for part in best_shifts(volume, low)))

    # On a CPU small strips are fastest: they fit its caches.
    strips = list(_strips(left, high - low + 1, window_px // 2, memory_mb))
    results = [one_strip(*strip) for strip in strips] if left.is_cuda else _on_all_cores(one_strip, strips)
    return BestMatches(*(torch.cat(parts, dim=-2) for parts in zip(*results, strict=True)))


# First and last row to read, number of context rows before the wanted ones, number of wanted rows.
Strip = tuple[int, int, int, int]


def _on_all_cores(work: Callable[[int, int, int, int], BestMatches], strips: list[Strip]) -> list[BestMatches]:
    """Run one strip per thread: torch's own threads wait for each other at every sum, and spin on a busy core."""
    threads = torch.get_num_threads()
    try:
        with ThreadPoolExecutor(threads, initializer=torch.set_num_threads, initargs=(1,)) as pool:
            return list(pool.map(lambda strip: work(*strip), strips))
    finally:
        torch.set_num_threads(threads)


def _strips(left: Tensor, count: int, half: int, memory_mb: int) -> Iterator[Strip]:
    batch, _, height, width = left.shape
    # Four volumes are alive at once in each thread: shifted pictures, their products, statistics and scores.
    row_bytes = 4 * torch.get_num_threads() * batch * width * count * left.element_size()
    rows = max(2 * half + 1, memory_mb * 2**20 // row_bytes - 2 * half)
    for first in range(0, height, rows):
        row_count = min(rows, height - first)
        above = max(0, first - half)
        yield above, min(height, first + row_count + half), first - above, row_count


def match_pair(
    left: Float32[np.ndarray, "h w"],
    right: Float32[np.ndarray, "h w"],
    low: int,
    high: int,
    window_px: int,
    torch_device: TorchDevice,
    memory_mb: int,
) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Run `match` on arrays; return disparity in pixels, NaN if unknown, and score in 0..1."""
    device = pick_device(torch_device)
    first, second = (torch.from_numpy(np.ascontiguousarray(grey)).to(device)[None, None] for grey in (left, right))
    disparity, score = match(first, second, low, high, window_px, memory_mb)
    return disparity[0].float().cpu().numpy(), score[0].float().cpu().numpy()
