"""Time and error of the dense matchers beside OpenCV's StereoSGBM 3WAY, run in turns, in one table.

    python benchmarks/depth_quick.py                       # scikit-image's motorcycle
    python benchmarks/depth_quick.py FOLDER [FOLDER ...]   # each with left.png, right.png and disparity.npz or .npy

The peer's views are padded on the left so that it answers everywhere, and its gaps are filled from their row's farther
side; the same number of disparities is asked of all. `ratio` is the median of (time / time of the run of 3WAY just
before it): whatever else the machine does then meets both. bad2 is the share of all pixels with a truth whose disparity
is missing or over 2 px off; noc the same over pixels that both views see.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tangible_core.data import Views
from tangible_core.picture_files import read_picture
from tangible_core.pictures import to_grey
from tangible_depth.notes import collected
from tangible_depth.semi_global import SemiGlobal
from tangible_depth.ssd import Ssd
from tangible_depth.zncc import Zncc

PEERS = {"3WAY bs5": (2, 5), "HH4 bs3": (3, 3), "HH bs3": (1, 3), "SGBM bs5": (0, 5)}


class Scene(NamedTuple):
    """A pair with its truth; NaN where there is none."""

    name: str
    views: Views
    truth: np.ndarray

    @property
    def disparities(self) -> int:
        """How many are asked of every method: whole sixteens, as the peer wants it."""
        return int(np.ceil((np.nanmax(self.truth) + 1) / 16) * 16)


def scenes(folders: list[Path]) -> Iterator[Scene]:
    """Those in the folders, or scikit-image's own."""
    for folder in folders:
        pair = [
            np.rint(255 * to_grey(read_picture(folder / f"{side}.png"))).astype(np.uint8) for side in ("left", "right")
        ]
        yield Scene(folder.name, Views(*pair), _truth(folder))
    if not folders:
        from skimage.data import stereo_motorcycle

        left, right, truth = stereo_motorcycle()
        pair = [np.rint(255 * to_grey(each)).astype(np.uint8) for each in (left, right)]
        yield Scene("motorcycle", Views(*pair), np.where(np.isfinite(truth), truth, np.nan))


def _truth(folder: Path) -> np.ndarray:
    if (folder / "disparity.npy").exists():
        return np.load(folder / "disparity.npy")
    with np.load(folder / "disparity.npz") as file:
        return file[file.files[0]]


def seen_by_both(truth: np.ndarray) -> np.ndarray:
    """Left pixels that no nearer one hides in the right view, and that lie within it."""
    h, w = truth.shape
    rows, columns = np.indices(truth.shape)
    known = np.isfinite(truth)
    nearest = np.full((h, w), -np.inf)
    target = np.where(known, columns - truth, -1)
    for column in (np.floor(target), np.ceil(target)):
        inside = known & (column >= 0)
        np.maximum.at(nearest, (rows[inside], column[inside].astype(int)), truth[inside])
    at = np.clip(np.rint(target), 0, w - 1).astype(int)
    return known & (target >= -0.5) & (nearest[rows, at] <= truth + 1)


def peer(views: Views, disparities: int, mode: int, block: int) -> np.ndarray:
    """OpenCV's matcher with the penalties of its documentation, padded and filled."""
    import cv2

    matcher = cv2.StereoSGBM.create(0, disparities, block, 8 * block**2, 32 * block**2, 1, 63, 10, 100, 2, mode)
    padded = [cv2.copyMakeBorder(z, 0, 0, disparities, 0, cv2.BORDER_REPLICATE) for z in (views.left, views.right)]
    found = matcher.compute(*padded)[:, disparities:]
    return filled_from_behind(np.where(found >= 0, found / np.float32(16), np.float32(np.nan)))


def filled_from_behind(disparity: np.ndarray) -> np.ndarray:
    """Each gap takes the farther of its row's two neighbours."""
    known, columns = np.isfinite(disparity), np.arange(disparity.shape[1])
    before = np.maximum.accumulate(np.where(known, columns, -1), axis=1)
    after = np.minimum.accumulate(np.where(known, columns, columns.size)[:, ::-1], axis=1)[:, ::-1]
    sides = [
        np.where(ok, np.take_along_axis(disparity, np.clip(at, 0, columns.size - 1), axis=1), np.inf)
        for at, ok in ((before, before >= 0), (after, after < columns.size))
    ]
    farther = np.minimum(*sides)
    return np.where(known, disparity, np.where(np.isfinite(farther), farther, 0)).astype(np.float32)


def errors(found: np.ndarray, truth: np.ndarray, both: np.ndarray) -> list[float]:
    """bad0.5, bad1, bad2, bad4 and bad2 noc in percent, and the mean error in pixels."""
    known = np.isfinite(truth)
    error = np.where(np.isfinite(found), np.abs(found - truth), np.inf)[known]
    bad = [100 * float(np.mean(error > limit)) for limit in (0.5, 1, 2, 4)]
    finite = error[np.isfinite(error)]
    return [*bad, 100 * float(np.mean(error[both[known]] > 2)), float(finite.mean()) if finite.size else float("nan")]


def in_turns(run: Callable[[], object], base: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Median ratio of the times, and median milliseconds, of `run`; each run follows one of `base`."""
    run()
    times = np.array([[_seconds(base), _seconds(run)] for _ in range(repeats)])
    return float(np.median(times[:, 1] / times[:, 0])), 1000 * float(np.median(times[:, 1]))


def _seconds(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def methods(scene: Scene) -> dict[str, Callable[[], np.ndarray]]:
    """What is measured, by name."""
    n, views = scene.disparities, scene.views
    ours = {
        "semi-global": SemiGlobal(max_disparity_px=n),
        "  range auto": SemiGlobal(),
        "  cost sharp": SemiGlobal(max_disparity_px=n, cost="sharp", realign_rows=False),
        "  strict": SemiGlobal(max_disparity_px=n, check="strict"),
        "  preview": SemiGlobal(max_disparity_px=n, resolution="half"),
        "zncc": Zncc(max_disparity_px=n),
        "ssd": Ssd(max_disparity_px=n),
    }
    table: dict[str, Callable[[], np.ndarray]] = {
        name: lambda each=each: each.estimate(views).disparity_px for name, each in ours.items()
    }
    for name, (mode, block) in PEERS.items():
        table[name] = lambda mode=mode, block=block: peer(views, n, mode, block)
    return table


def main() -> None:
    """Print a table a scene, and the means."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--repeats", type=int, default=9)
    given = parser.parse_args()
    sums: dict[str, list[list[float]]] = {}
    head = f"{'':14s}{'ratio':>7s}{'ms':>9s}{'bad.5':>7s}{'bad1':>7s}{'bad2':>7s}{'bad4':>7s}{'noc':>7s}{'mean':>7s}"
    for scene in scenes(given.folders):
        both = seen_by_both(scene.truth)
        h, w = scene.truth.shape
        print(f"\n{scene.name}: {w} x {h}, {scene.disparities} disparities\n{head}")
        for name, run in methods(scene).items():
            with collected() as notes:
                error = errors(run(), scene.truth, both)
            row = [
                *in_turns(run, lambda s=scene: peer(s.views, s.disparities, *PEERS["3WAY bs5"]), given.repeats),
                *error,
            ]
            sums.setdefault(name, []).append(row)
            print(_line(name, row), "; ".join(notes), flush=True)
    print(f"\nmean of {len(next(iter(sums.values())))}\n{head}")
    for name, rows in sums.items():
        print(_line(name, list(np.mean(rows, axis=0))))


def _line(name: str, row: list[float]) -> str:
    return f"{name:14s}{row[0]:7.2f}{row[1]:9.1f}" + "".join(f"{each:7.2f}" for each in row[2:])


if __name__ == "__main__":
    main()
