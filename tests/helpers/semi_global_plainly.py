"""Semi-global matching written out plainly, of every column or of every few."""

import numpy as np

from tangible_depth.dense.span import UNKNOWN


def plain_census(grey):
    """Bits of the 5 x 5 window, in any order: whether a neighbour is darker."""
    padded = np.pad(grey, 2, mode="edge")
    h, w = grey.shape
    around = [padded[dy : dy + h, dx : dx + w] for dy in range(5) for dx in range(5) if (dy, dx) != (2, 2)]
    return np.stack([each < grey for each in around], axis=-1)


def plain_costs(left, right, span, neutral):
    """Differing bits by row, column and disparity low..high."""
    a, b = plain_census(left), plain_census(right)
    h, w = left.shape
    costs = np.full((h, w, span.high - span.low + 1), neutral, int)
    for i, d in enumerate(range(span.low, span.high + 1)):
        for x in range(w):
            if 0 <= x - d < w:
                costs[:, x, i] = (a[:, x] != b[:, x - d]).sum(axis=-1)
    return costs


def plain_path(costs, steps, penalties):
    """Costs (n, ..., d) summed along the first axis, each kept relative to the minimum before it."""
    before = np.zeros(costs.shape[1:], int)
    out = []
    for cost, step_here in zip(costs, steps, strict=True):
        least = before.min(axis=-1, keepdims=True)
        wall = np.full((*before.shape[:-1], 1), 255)
        up = np.concatenate([wall, before[..., :-1]], axis=-1)
        down = np.concatenate([before[..., 1:], wall], axis=-1)
        jumped = least + penalties.p2_by_step.astype(int)[step_here][..., None]
        best = np.minimum(np.minimum(before, jumped), np.minimum(up, down) + int(penalties.p1))
        before = np.minimum(cost + best - least, 255)
        out.append(before)
    return np.stack(out)


def plain_sums(left, right, span, penalties, stride=1):
    """Costs of four paths through every stride-th column."""
    costs = plain_costs(left, right, span, int(penalties.neutral))[:, ::stride]
    grey = left[:, ::stride].astype(int)
    total = np.zeros_like(costs)
    for axis in (0, 1):
        c, g = np.moveaxis(costs, axis, 0), np.moveaxis(grey, axis, 0)
        steps = np.abs(np.diff(g, axis=0, prepend=g[:1]))
        back = np.abs(np.diff(g[::-1], axis=0, prepend=g[-1:]))
        total += np.moveaxis(plain_path(c, steps, penalties) + plain_path(c[::-1], back, penalties)[::-1], 0, axis)
    return np.minimum(total, 255)


def plain_disparity(sums, span, tolerance, stride=1, width=None):
    """Disparities that pass the left-right check, each for its column and those up to the next that was matched."""
    h, count = sums.shape[0], sums.shape[2]
    w = width or sums.shape[1]
    out = np.full((h, w), UNKNOWN, np.int16)
    right_best = np.full((h, w), 255)
    for i, d in enumerate(range(span.low, span.high + 1)):
        for x in range(0, w, stride):
            if 0 <= x - d < w:
                right_best[:, x - d] = np.minimum(right_best[:, x - d], sums[:, x // stride, i])
    for y, column in np.ndindex(sums.shape[:2]):
        x, s = stride * column, sums[y, column]
        i = count - 1 - int(np.argmin(s[::-1]))  # of equals the largest disparity
        d = span.low + i
        if not 0 <= x - d < w or s[i] == 255 or s[i] > np.float32(tolerance) * np.float32(right_best[y, x - d]):
            continue
        offset = 0.0
        if 0 < i < count - 1:
            before, after = float(s[i + 1]), float(s[i - 1])  # lanes run downwards
            if before == after == s[i]:
                continue
            offset = (before - after) / (2 * (max(before, after) - s[i]))
        out[y, x : x + stride] = np.floor(16 * (d - offset) + 0.5)
    return out
