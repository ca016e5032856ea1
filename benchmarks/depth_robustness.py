"""Damaged pairs: `semi-global` as it comes against the better of OpenCV's 3WAY and HH4, cell by cell."""

from collections.abc import Iterator
from functools import partial

from tangible_bench.tasks.depth import PERTURBATIONS, fill, measure
from tangible_core.plugins.interfaces import DepthEstimator
from tangible_core.testing.synthetic.stereo_scenes import KnownPair
from tangible_depth.opencv_sgbm import OpenCVSGBM
from tangible_depth.semi_global import SemiGlobal

from .depth_opencv import PEERS, filled
from .depth_pairs import KnownScene, known, large, real, synthetic
from .figures import Figure, table
from .turns import in_turns

DAMAGES = (
    ("noise", 2), ("noise", 5), ("noise", 10), ("noise", 15), ("gain", 0.8), ("gamma", 1.4), ("jpeg", 50),
    ("shift", 0.5), ("shift", 1), ("blur", 1),
)  # fmt: skip


def measured() -> tuple[list[Figure], list[str]]:
    """Return the promise about damaged pairs, and bad2 by damage, mean over the scenes."""
    scenes = {**real(), **synthetic()}
    cells = {
        (kind, value): {name: _errors(_damaged(scene, kind, value)) for name, scene in scenes.items()}
        for kind, value in DAMAGES
    }
    margins, best = (
        {
            (f"{kind} {value:g}", name): errors[effort] - min(errors[2:])
            for (kind, value), by_scene in cells.items()
            for name, errors in by_scene.items()
        }
        for effort in (0, 1)
    )
    best_worst = max(best, key=best.__getitem__)
    worst = max(margins, key=margins.__getitem__)
    above = sum(margin > 0 for margin in margins.values())
    shares = dict(_shares())
    slowest = max(shares, key=shares.__getitem__)
    figure = Figure(
        "robustness, damaged pairs, defaults",
        "bad2 never above the better of 3WAY and HH4, at <= 1.2 x 3WAY from 300 kpx up",
        f"worst of {len(margins)} cells {margins[worst]:+.2f} ({', '.join(worst)}; {above} above); "
        f"slowest {shares[slowest]:.2f} x ({', '.join(slowest)})",
        margins[worst] <= 0 and shares[slowest] <= 1.2,
    )
    of_best = Figure(
        "robustness, damaged pairs, `effort: best`",
        "bad2 never above the better of 3WAY and HH4",
        f"worst of {len(best)} cells {best[best_worst]:+.2f} ({', '.join(best_worst)})",
        best[best_worst] <= 0,
    )
    rows = []
    for (kind, value), by_scene in cells.items():
        means = [sum(column) / len(by_scene) for column in zip(*by_scene.values(), strict=True)]
        name = f"{kind} {value:g}"
        times = ", ".join(f"{share:.2f}" for (damage, _), share in shares.items() if damage == name)
        furthest = max(margin for (damage, _), margin in margins.items() if damage == name)
        rows.append((name, *(f"{mean:.2f}" for mean in means), f"{furthest:+.2f}", times))
    headings = (
        "damage",
        "semi-global",
        "best",
        "3WAY",
        "HH4",
        "worst margin to the better",
        f"time / 3WAY: {', '.join(large())}",
    )
    return [figure, of_best], table(headings, rows)


def _damaged(scene: KnownScene, kind: str, value: float) -> KnownScene:
    damaged: KnownPair = PERTURBATIONS[kind].apply(scene.pair, value)
    return known(damaged)


def _errors(scene: KnownScene) -> tuple[float, ...]:
    """bad2 of ours with either effort, of 3WAY and of HH4."""
    return tuple(measure(fill(method.estimate(scene.pair.views)), scene.pair)["bad2"] for method in _methods(scene))


def _methods(scene: KnownScene) -> Iterator[DepthEstimator]:
    yield from (SemiGlobal(), SemiGlobal(effort="best"))
    for name in ("3WAY", "HH4"):
        mode, block = PEERS[name]
        yield OpenCVSGBM.model_validate(
            {"mode": mode, "block_px": block, "second_pass": False, "max_disparity_px": scene.disparities}
        )


def _shares() -> Iterator[tuple[tuple[str, str], float]]:
    for name, scene in large().items():
        for kind, value in DAMAGES:
            each = _damaged(scene, kind, value)
            calls = {"3WAY": partial(filled, each), "ours": partial(SemiGlobal().estimate, each.views)}
            yield (f"{kind} {value:g}", name), in_turns(calls, 5)["ours"].ratio
