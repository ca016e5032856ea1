"""Fit the network of `gabor` to many textures: the weights of `tangible_texture/learned`.

python -m benchmarks.texture_fit WEIGHTS.npz FOLDER...   # hours; folders and archives with pictures of textures

Mosaics of six kinds are made of textures that are scaled, turned and cropped. For each, the network shall bring a cell
near the mean of the other cells of its texture, and far from the means of others; and the distance of two cells shall
tell whether they are of one texture. Every twelfth texture is kept back; the loss on mosaics of these is printed, too.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import torch
from torch import nn
from torch.nn import functional

from tangible_core.testing.synthetic.texture_scenes import without_grey
from tangible_texture.features.features import features
from tangible_texture.features.patterns import CLASSES, PATTERNS, RADII
from tangible_texture.learned.network import FILTERS, WINDOWS

from .texture_kinds import KINDS, regions_of
from .texture_many import find_textures

VARIANTS, MOSAICS, STEPS, BATCH = 2, 3000, 7000, 2
"""Variants of each texture, mosaics of them, steps of the descent, and mosaics a step."""
HIDDEN, VALUES = 24, 6
"""The values of each hidden layer and of the result, four times as many in all: see `orders`."""
SIDE_PX, SIDES_PX = 512, (256, 320, 384, 448, 512)
LARGE_PX = 760  # the side of a texture of which a square of SIDE_PX is cut, turned by any angle
SEGMENTS = 2, 3, 4, 5, 6, 7, 8, 10, 12, 16
KIND_SHARES = {"straight": 0.15, "curved": 0.2, "letters": 0.25, "grid": 0.1, "rings": 0.15, "unequal": 0.15}
"""The share of mosaics of each kind of region."""
KEPT_BACK = 12  # one of so many textures is not fitted to
NOISY, MAX_NOISE = 0.25, 10.0
"""The share of mosaics with noise, and its largest standard deviation in grey levels."""
PAIRED = 384  # the number of cells of a mosaic of which all pairs are judged
CELL_PX = 8


class Example(NamedTuple):
    """The features of a mosaic's narrow windows, each cell's texture, and the share of the cell that it fills."""

    planes: torch.Tensor
    labels: torch.Tensor
    shares: torch.Tensor


def variant(grey: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Return a texture scaled, turned, cropped and without grey: uint8 (512, 512)."""
    scale = float(np.exp(random.uniform(np.log(0.45), np.log(1.3))))
    scaled = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC)
    large = _enlarged(scaled, repeats=_repeats(grey))
    if random.random() < 0.6:
        middle = large.shape[1] / 2, large.shape[0] / 2
        turn = cv2.getRotationMatrix2D(middle, random.uniform(0, 360), 1)
        turn[:, 2] += SIDE_PX / 2 - np.array(middle)
        turned = cv2.warpAffine(large, turn, (SIDE_PX, SIDE_PX), flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    else:
        top, left = (random.integers(0, side - SIDE_PX + 1) for side in large.shape)
        turned = np.rot90(large[top : top + SIDE_PX, left : left + SIDE_PX], int(random.integers(4)))
    values = np.ascontiguousarray(turned).astype(np.float64)
    if random.random() < 0.15:
        values = cv2.GaussianBlur(values, (0, 0), random.uniform(0.5, 1.2))
    return np.rint(without_grey(values)).astype(np.uint8)


def _enlarged(grey: np.ndarray, repeats: bool) -> np.ndarray:
    missing = [(0, max(0, LARGE_PX - side)) for side in grey.shape]
    return np.pad(grey, missing, mode="wrap") if repeats else np.pad(grey, missing, mode="symmetric")


def _repeats(grey: np.ndarray) -> bool:
    values = grey.astype(np.float64)
    inside = sum(np.abs(np.diff(values, axis=axis)).mean() for axis in (0, 1))
    return bool(np.abs(values[0] - values[-1]).mean() + np.abs(values[:, 0] - values[:, -1]).mean() < 1.8 * inside)


def example(variants: Sequence[Sequence[np.ndarray]], seed: int) -> Example | None:
    """Make a mosaic of some textures, each with its variants, and compute its features; None if it is all one."""
    random = np.random.default_rng([77, seed])
    kind = str(random.choice(list(KINDS), p=[KIND_SHARES[each] for each in KINDS]))
    segments = int(random.choice([each for each in SEGMENTS if each <= len(variants)]))
    side = int(random.choice(SIDES_PX if segments < 8 else SIDES_PX[2:]))
    labels = regions_of(kind, segments, side, random)
    picture = np.zeros(labels.shape, np.uint8)
    for label, index in enumerate(random.choice(len(variants), labels.max() + 1, replace=False)):
        own = variants[index]
        top, left = random.integers(0, SIDE_PX - side + 1, 2)
        part = own[random.integers(len(own))][top : top + side, left : left + side]
        part = np.rot90(part[:, ::-1] if random.random() < 0.5 else part, int(random.integers(4)))
        np.copyto(picture, part, where=labels == label)
    if random.random() < NOISY:
        noise = random.normal(0, random.uniform(2, MAX_NOISE), picture.shape)
        picture = np.rint(picture + noise).clip(0, 255).astype(np.uint8)
    found = features(picture, 24.0, 0.0, colour=False)
    if found is None:
        return None
    cells = side // CELL_PX
    narrow = found.narrow.planes.reshape(-1, cells, 2, cells, 2).mean(axis=(2, 4))
    counts = np.eye(labels.max() + 1)[labels].reshape(cells, CELL_PX, cells, CELL_PX, -1).mean(axis=(1, 3))
    return Example(
        torch.tensor(narrow, dtype=torch.float32),
        torch.tensor(counts.argmax(axis=2)),
        torch.tensor(counts.max(axis=2), dtype=torch.float32),
    )


def orders() -> np.ndarray:
    """Return where each feature goes under no change, a quarter turn, a flip, and both: int64 (4, d)."""
    turned = [6 * octave + (i + 3) % 6 for octave in range(FILTERS // 6) for i in range(6)]
    flipped = [6 * octave + -i % 6 for octave in range(FILTERS // 6) for i in range(6)]
    each = PATTERNS // len(RADII)
    for start in range(FILTERS, FILTERS + PATTERNS, each):
        same, axes = list(range(start, start + CLASSES)), start + CLASSES
        groups = axes, axes + 4, axes + 8
        turned += same + [group + (i + 2) % 4 for group in groups for i in range(4)]
        flipped += same + [group + -i % 4 for group in groups[:2] for i in range(4)]
        flipped += [groups[2] + (-i - 2) % 4 for i in range(4)]
    quarter, flip = np.array(turned), np.array(flipped)
    return np.stack([np.arange(quarter.size), quarter, flip, quarter[flip]])


class Network(nn.Module):
    """The layers of `learned_values`, with one value a group of four free to choose."""

    def __init__(self) -> None:
        """Begin with random weights."""
        super().__init__()
        planes = FILTERS + PATTERNS
        self.first = nn.Parameter(torch.randn(HIDDEN, planes) / planes**0.5)
        self.second = nn.Parameter(torch.randn(4, HIDDEN, 3 * HIDDEN) / (12 * HIDDEN) ** 0.5)
        self.last = nn.Parameter(torch.randn(4, VALUES, HIDDEN) / (4 * HIDDEN) ** 0.5)
        self.first_bias, self.second_bias = (nn.Parameter(torch.zeros(HIDDEN)) for _ in range(2))
        self.judge = nn.Parameter(torch.tensor([-2.0, 1.0]))
        """The logarithm of the weight of a squared distance, and the log-odds that cells at distance 0 are alike."""
        self.orders = torch.tensor(orders())

    def weights(self) -> dict[str, torch.Tensor]:
        """Return those of `learned.network.Weights`."""
        second = _tied(self.second).reshape(4 * HIDDEN, 4, 3, HIDDEN).transpose(1, 2).reshape(4 * HIDDEN, -1)
        return {
            "first": torch.cat([self.first[:, order] for order in self.orders]),
            "first_bias": self.first_bias.repeat(4),
            "second": second,
            "second_bias": self.second_bias.repeat(4),
            "last": _tied(self.last),
        }

    def forward(self, planes: torch.Tensor) -> torch.Tensor:
        """Compute the values of each cell: (n, e)."""
        weights, shape = self.weights(), planes.shape[1:]
        values = functional.relu(weights["first"] @ planes.flatten(1) + weights["first_bias"][:, None])
        around = torch.cat([_means(values.reshape(-1, *shape), sigma).flatten(1) for sigma in WINDOWS])
        return (weights["last"] @ functional.relu(weights["second"] @ around + weights["second_bias"][:, None])).T


def _tied(blocks: torch.Tensor) -> torch.Tensor:
    """Return a matrix of 4 x 4 blocks, of which those that a turn or a flip brings to each other are the same."""
    return torch.cat([torch.cat([blocks[row ^ column] for column in range(4)], dim=1) for row in range(4)])


def _means(planes: torch.Tensor, sigma: float) -> torch.Tensor:
    if not sigma:
        return planes
    down, across = (_window(side, sigma) for side in planes.shape[1:])
    return down @ planes @ across.T


def _window(side: int, sigma: float) -> torch.Tensor:
    reach = int(4 * sigma + 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    matrix = np.zeros((side, side))
    for cell in range(side):
        at = np.arange(cell - reach, cell + reach + 1) % (2 * side)
        np.add.at(matrix[cell], np.where(at < side, at, 2 * side - 1 - at), weights / weights.sum())
    return torch.tensor(matrix, dtype=torch.float32)


def loss(network: Network, given: Example) -> torch.Tensor:
    """Compute the loss of a mosaic: of cells and the means of textures, and of pairs of cells."""
    values, labels, shares = network(given.planes), given.labels.flatten(), given.shares.flatten()
    sizes = torch.bincount(labels).float()
    return _of_means(values, labels, shares, sizes) + _of_pairs(network.judge, values, labels, shares, sizes)


def _of_means(values: torch.Tensor, labels: torch.Tensor, shares: torch.Tensor, sizes: torch.Tensor) -> torch.Tensor:
    """Each half of the cells, drawn by lot, is to be nearest to the means of the other half."""
    weights, half, total = shares / sizes[labels].sqrt(), torch.rand(len(labels)) < 0.5, torch.zeros(())
    for chosen in (half, ~half):
        inside = functional.one_hot(labels, len(sizes)) * (chosen * shares**2)[:, None]
        known = inside.sum(dim=0) > 2
        means = inside.T @ values / (inside.sum(dim=0)[:, None] + 1e-3)
        logits = (-0.5 * torch.cdist(values, means) ** 2).masked_fill(~known, -1e4)
        judged = ~chosen & known[labels]
        wrong = functional.cross_entropy(logits[judged], labels[judged], reduction="none")
        total = total + (wrong * weights[judged]).sum() / weights[judged].sum() / 2
    return total


def _of_pairs(
    judge: torch.Tensor, values: torch.Tensor, labels: torch.Tensor, shares: torch.Tensor, sizes: torch.Tensor
) -> torch.Tensor:
    """Judge from the distances of pairs of cells whether they are of one texture; both answers weigh the same."""
    chosen = torch.multinomial(shares**4 / sizes[labels].sqrt(), min(PAIRED, len(labels)))
    own, names = values[chosen], labels[chosen]
    alike = names[:, None] == names
    distances = (own[:, None] - own).square().sum(dim=2)
    wrong = functional.binary_cross_entropy_with_logits(
        judge[1] - judge[0].exp() * distances, alike.float(), reduction="none"
    )
    return wrong[alike & ~torch.eye(len(names), dtype=torch.bool)].mean() / 2 + wrong[~alike].mean() / 2


def fit(examples: list[Example], kept_back: list[Example], steps: int = STEPS) -> Network:
    """Return the network after the descent; prints the mean loss of both lists on the way."""
    torch.manual_seed(0)
    network, random = Network(), np.random.default_rng(0)
    descent = torch.optim.AdamW(network.parameters(), lr=3e-3, weight_decay=1e-4)
    pace = torch.optim.lr_scheduler.OneCycleLR(descent, 3e-3, steps, pct_start=0.1)
    recent: list[float] = []
    for step in range(1, steps + 1):
        batch = [loss(network, examples[i]) for i in random.choice(len(examples), BATCH)]
        total = torch.stack(batch).mean()
        descent.zero_grad()
        total.backward()
        nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        descent.step()
        pace.step()
        recent.append(total.item())
        if step % 500 == 0 or step == steps:
            with torch.no_grad():
                others = np.mean([loss(network, each).item() for each in kept_back])
            print(f"{step} of {steps}: {np.mean(recent):.3f}, of textures kept back {others:.3f}", flush=True)
            recent.clear()
    return network


def main() -> None:
    """Fit to the textures of the folders named, and write the weights as float16."""
    if len(sys.argv) < 3:
        sys.exit("name the file to write, WEIGHTS.npz, and one folder of textures or more")
    textures = find_textures([Path(each) for each in sys.argv[2:]])
    print(f"{len(textures)} textures", flush=True)
    variants = [
        [variant(texture, np.random.default_rng([i, j])) for j in range(VARIANTS)] for i, texture in enumerate(textures)
    ]
    back = [each for i, each in enumerate(variants) if i % KEPT_BACK == 0]
    used = [each for i, each in enumerate(variants) if i % KEPT_BACK]
    made = [each for seed in range(MOSAICS) if (each := example(used, seed))]
    network = fit(made, [each for seed in range(100) if (each := example(back, MOSAICS + seed))])
    with torch.no_grad():
        stored = {name: each.numpy().astype(np.float16) for name, each in network.weights().items()}
    np.savez_compressed(sys.argv[1], allow_pickle=False, **stored)


if __name__ == "__main__":
    main()
