"""Local energy in a bank of Gabor filters, and k-means, in torch and kornia; import it inside a verb."""

from collections.abc import Sequence

import numpy as np
import torch
from jaxtyping import Float32
from kornia.filters import fft_conv
from torch import Tensor

from .energies.gabor_bank import Gabor, kernel
from .energies.local_energy import fft, padding, smoothing_px, smoothing_table, standardise
from .kmeans.lloyd import SAME


def energies(
    grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor], step_px: int, sigma_px: float, device: torch.device
) -> Tensor:
    """Compute the planes of `local_energy.energy_planes` from every pixel of responses: (filters, rows, columns)."""
    pad_px = padding(filters, sigma_px)
    picture = standardise(grey)
    cells = [-(-side // step_px) for side in grey.shape]
    planes = []
    for gabor in filters:
        waves = kernel(gabor)
        around = pad_px + len(waves) // 2
        ends = [(around, fft.next_fast_len(side + 2 * around) - around - side) for side in grey.shape]
        mirror = torch.from_numpy(np.pad(picture, ends, mode="symmetric")).to(device)
        parts = torch.from_numpy(np.stack([np.real(waves), np.imag(waves)]).astype(np.float32)).to(device)
        response = fft_conv(mirror.expand(2, 1, -1, -1), parts, padding="valid")
        energy = response.square().sum(dim=(0, 1))
        down, along = (
            _dense_smoothing_table(count, step_px, smoothing_px(gabor, sigma_px), side, pad_px).to(device)
            for count, side in zip(cells, energy.shape, strict=True)
        )
        planes.append(down @ energy @ along.T)
    return torch.stack(planes)


def _dense_smoothing_table(cells: int, step_px: int, wide_px: float, samples: int, pad_px: int) -> Tensor:
    first, weights = smoothing_table(cells, step_px, wide_px, samples, 1.0, pad_px)
    matrix = np.zeros((cells, samples), np.float32)
    np.put_along_axis(matrix, first[:, None] + np.arange(weights.shape[1]), weights, axis=1)
    return torch.from_numpy(matrix)


def standardise_roots(planes: Tensor) -> Tensor:
    """Return amplitudes, one row a cell (n, filters): mean 0 and deviation 1 for each filter, or 0 if constant."""
    rows = planes.flatten(1).T.sqrt()
    rows = rows - rows.mean(dim=0)
    deviation = rows.square().mean(dim=0).sqrt()
    return rows / torch.where(deviation > 0, deviation, 1.0)


# The label of each row, int64, the centres (k, d), and the cost, as `lloyd.Clusters`.
Clustering = tuple[Tensor, Tensor, float]


def kmeans(rows: Tensor, clusters: int, restarts: int = 1, seed: int = 0, rounds: int = 1000) -> Clustering:
    """Run `lloyd.kmeans` in torch from a k-means++ start; the CPU draws, so that every device starts alike."""
    uniform = np.random.default_rng(seed).random((restarts, clusters))
    return min((_settle(rows, _start(rows, numbers.tolist()), rounds) for numbers in uniform), key=lambda run: run[2])


def _start(rows: Tensor, uniform: list[float]) -> Tensor:
    least = SAME**2 * rows.square().sum(dim=1).max()
    centres = [rows[int(uniform[0] * len(rows))]]
    away = torch.full_like(rows[:, 0], torch.inf)
    for chance in uniform[1:]:
        away = torch.minimum(away, (rows - centres[-1]).square().sum(dim=1))
        weights = torch.where(away > least, away, 0.0).double().cumsum(dim=0)
        if weights[-1] == 0:
            break
        centres.append(rows[torch.searchsorted(weights, chance * weights[-1], right=True)])
    return torch.stack(centres)


def _settle(rows: Tensor, centres: Tensor, rounds: int) -> Clustering:
    labels = torch.full((len(rows),), -1, device=rows.device)
    away = torch.empty_like(rows[:, 0])
    for _ in range(rounds):
        before = labels
        away, labels = torch.cdist(rows, centres).min(dim=1)
        if torch.equal(labels, before):
            break
        members = torch.nn.functional.one_hot(labels, len(centres)).to(rows.dtype)
        counts = members.sum(dim=0)
        means = (members.T @ rows) / counts.clamp(min=1)[:, None]
        centres = torch.where(counts[:, None] > 0, means, centres)
    occupied, labels = torch.unique(labels, return_inverse=True)
    return labels, centres[occupied], float(away.square().sum())
