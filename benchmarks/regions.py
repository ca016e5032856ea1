"""Photographs divided as people divide them: `hierarchy` beside `gradient` and OpenCV's graph.

TANGIBLE_REGIONS names a folder of photographs, *.jpg, each with the regions that people drew, in an .npz of that name.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from statistics import fmean
from time import process_time
from unittest.mock import patch

import cv2
import numpy as np
from scipy.special import logit

from tangible_bench.metrics.segments import Counts, adjusted_rand_index, contingency
from tangible_core.data import SegmentTree, Views
from tangible_core.data.views import border_pixels
from tangible_core.pipeline.engine.stages.relief import LEVEL, SEEN_LEVEL
from tangible_core.relief import ReliefChoice, edge_relief
from tangible_core.runtime.threads import limited_threads
from tangible_core.scene.workspace import FeltSize
from tangible_networks.seeing import look
from tangible_networks.store import VARIABLE, networks_here
from tangible_texture import Gradient, Hierarchy

from .figures import Figure, judged, mean_and_error, part, table
from .regions_drawn import UNSEEN, Photograph, photographs
from .regions_fit import fit, prepare, tree
from .turns import in_turns

FOLDS = 4
COUNTS = (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 100)
"""The numbers of segments among which the best of a picture is chosen."""
GRAPH = {"sigma": 0.5, "k": 500.0, "min_size": 300}
"""OpenCV's graph at the options that cover the given photographs best, of k 100..1000 and sizes 50..500."""
RUNS, LARGE = 7, (3000, 4000)
Labels = np.ndarray


def rand_index(counts: Counts) -> float:
    """Return the share of pairs of pixels on which both maps agree: together in both, or apart in both.

    The mean over several people's maps is the probabilistic Rand index.
    Source: Unnikrishnan, Pantofaru & Hebert, IEEE TPAMI 29, 2007.
    """
    groups = counts, counts.sum(axis=1), counts.sum(axis=0), counts.sum(keepdims=True)
    both, first, second, every = (int((group * (group - 1) // 2).sum()) for group in groups)
    return 1 - (first + second - 2 * both) / every if every else 1.0


def covering(counts: Counts) -> float:
    """Return how well segments cover the true ones: the greatest overlap of each true segment, weighted by its area.

    The overlap of two segments is their intersection over their union.
    Source: Arbelaez, Maire, Fowlkes & Malik, IEEE TPAMI 33, 2011, sec. 3.1.
    """
    found, true = counts.sum(axis=1), counts.sum(axis=0)
    overlaps = counts / (found[:, None] + true - counts)
    return float((true * overlaps.max(axis=0)).sum() / true.sum())


COUNTED = {"covering": covering, "PRI": rand_index, "ARI": adjusted_rand_index}
MEASURES = *COUNTED, "F"
NEAR = 0.0075  # the distance within which two borders are one, of the diagonal


def section() -> str:
    """Return the section as Markdown."""
    given = photographs()
    if not given:
        return "Not measured: TANGIBLE_REGIONS names no folder of photographs."
    with patch.dict(os.environ, {VARIABLE: os.devnull}):
        quality, figures = part("regions", lambda: _quality(given))
        figures += part("times", lambda: _times(given))
    if networks_here("borders"):
        seen, judgement = part("a network of borders", _with_network)
        quality, figures = [*quality, "", *seen], figures + judgement
    head = (
        f"{len(given)} photographs of the Berkeley data set, each divided by about five people; a measure is the mean "
        "over the people, then over the photographs, with its standard error. Covering: the overlap of each drawn "
        "region with the segment that fits it best, by area. Best: the number that covers this photograph best. "
        "Cross-validation: weights fitted to three quarters of the photographs, measured on the others, "
        f"in {FOLDS} turns. F: of precision, the share of border pixels that are within {100 * NEAR} % of the diagonal "
        "from somebody's border, and recall, the mean share of a person's."
    )
    return "\n".join([head, "", *quality, "", *judged(figures)])


def _quality(given: Mapping[str, Photograph]) -> tuple[list[str], list[Figure]]:
    default: dict[str, list[Mapping[str, float]]] = {
        "people, each against the others": [_people(each) for each in given.values()],
        "`gradient`": _each(given, lambda picture: Gradient().segment(picture).labels),
        "OpenCV's graph": _each(given, _graph),
        "`hierarchy`": _each(given, lambda picture: Hierarchy().segment(picture).labels),
    }
    best: dict[str, list[Mapping[str, float]]] = {
        "`gradient`": [_best(_gradient_cuts(photo.picture), photo) for photo in given.values()],
        "`hierarchy`": [_best(_cuts(Hierarchy().tree(photo.picture)), photo) for photo in given.values()],
    }
    crossed = "`hierarchy`, cross-validation"
    default[crossed], best[crossed] = _crossed(given)
    rows = [
        (name, when, *(mean_and_error([each[measure] for each in found]) for measure in MEASURES))
        for when, kinds in (("found", default), ("best", best))
        for name, found in kinds.items()
    ]
    said = "Of the regions at cells, of 2 x 2 pixels here, in the rows of cross-validation; at pixels in the others."
    means = {measure: fmean(each[measure] for each in default[crossed]) for measure in COUNTED}
    most = fmean(each["covering"] for each in best[crossed])
    figures = [
        Figure(
            "`hierarchy` with its defaults, cross-validation",
            "covering >= .60, PRI >= .83, ARI >= .52",
            ", ".join(f"{measure} {value:.3f}" for measure, value in means.items()),
            means["covering"] >= 0.6 and means["PRI"] >= 0.83 and means["ARI"] >= 0.52,
        ),
        Figure("the same, the best cut of each photograph", "covering >= .66", f"{most:.3f}", most >= 0.66),
    ]
    return [*table(("method", "number of segments", *MEASURES), rows), "", said], figures


def _gradient_cuts(picture: np.ndarray) -> list[Labels]:
    return [Gradient(segments=count).segment(picture).labels for count in COUNTS]


def _cuts(tree: SegmentTree) -> list[Labels]:
    return [tree.cut(count).labels for count in COUNTS]


def _with_network() -> tuple[list[str], list[Figure]]:
    """Measure what a network's borders add, on photographs that it was not trained on, nor the weights fitted to."""
    given = photographs(UNSEEN)
    (without, _), (within, _) = (_crossed(given, seen) for seen in (False, True))
    names = *MEASURES, "lines"
    more = {name: [w[name] - o[name] for w, o in zip(within, without, strict=True)] for name in names}
    rows = [
        (label, *(mean_and_error([each[name] for each in found]) for name in names))
        for label, found in (("`hierarchy`", without), ("`hierarchy` with the network", within))
    ]
    rows.append(("difference", *(mean_and_error(more[name]) for name in names)))
    for label, tasks in (("edges of the picture", ()), ("ridges of the network's map", ("borders",))):
        found = [_raised(photo, look(photo.picture, tasks).borders) for photo in list(given.values())[1::2]]
        rows.append((label, *("" for _ in MEASURES), mean_and_error(found)))
    said = (
        f"{len(given)} other photographs, which the network of borders was not trained on, in cross-validation; the "
        "last rows on every other one, as on the rest their level was chosen. Lines: F of the lines of `relief: edges`."
    )
    figures = [
        Figure(f"a network of borders adds to {name}", ">= .04", f"{fmean(more[name]):.3f}", fmean(more[name]) >= 0.04)
        for name in ("covering", "F")
    ]
    return [said, "", *table(("method", *names), rows)], figures


def _raised(photo: Photograph, borders: np.ndarray | None) -> float:
    size = FeltSize(0.08, 1.0, 0.0, 3e-5, "fill")
    heights = edge_relief(Views(photo.picture), size, ReliefChoice(slope=0), borders=borders).height_m
    return border_f(cv2.ximgproc.thinning(255 * (heights > 0.599).astype(np.uint8)) > 0, photo)


def _crossed(
    given: Mapping[str, Photograph], seen: bool = False
) -> tuple[list[Mapping[str, float]], list[Mapping[str, float]]]:
    prepared = [prepare(each, seen) for each in given.values()]
    default: dict[int, Mapping[str, float]] = {}
    best: dict[int, Mapping[str, float]] = {}
    for fold in range(FOLDS):
        model = fit([each for at, each in enumerate(prepared) if at % FOLDS != fold])
        for at in range(fold, len(prepared), FOLDS):
            photo = Photograph(prepared[at].photograph.picture, prepared[at].drawn)
            found = tree(prepared[at], model)
            lines = border_pixels(found.cut(64, float(logit(SEEN_LEVEL if seen else LEVEL))).labels)
            default[at] = _measures(found.cut(64, 0.0).labels, photo) | {"lines": border_f(lines, photo)}
            best[at] = _best(_cuts(found), photo)
    return [default[at] for at in range(len(prepared))], [best[at] for at in range(len(prepared))]


def _each(given: Mapping[str, Photograph], find: Callable[[np.ndarray], Labels]) -> list[Mapping[str, float]]:
    return [_measures(find(photo.picture), photo) for photo in given.values()]


def _best(cuts: Sequence[Labels], photo: Photograph) -> Mapping[str, float]:
    return max((_measures(labels, photo) for labels in cuts), key=lambda each: each["covering"])


def _measures(labels: Labels, photo: Photograph) -> Mapping[str, float]:
    counts = [contingency(labels, drawn) for drawn in photo.drawn]
    means = {name: fmean(measure(count) for count in counts) for name, measure in COUNTED.items()}
    return means | {"F": border_f(border_pixels(labels), photo)}


def border_f(found: np.ndarray, photo: Photograph) -> float:
    """Return the harmonic mean of the precision and the recall of border pixels, a mask of the photograph's size."""
    drawn = [border_pixels(labels) for labels in photo.drawn]
    reach = NEAR * float(np.hypot(*found.shape))

    def near(some: np.ndarray, others: np.ndarray) -> float:
        away = cv2.distanceTransform((~others).astype(np.uint8), cv2.DIST_L2, 5)
        return float((away[some] <= reach).mean()) if some.any() else 1.0

    precision, recall = near(found, np.any(drawn, axis=0)), fmean(near(each, found) for each in drawn)
    return 2 * precision * recall / max(precision + recall, 1e-9)


def _people(photo: Photograph) -> Mapping[str, float]:
    every = [
        _measures(one, Photograph(photo.picture, [each for other, each in enumerate(photo.drawn) if other != at]))
        for at, one in enumerate(photo.drawn)
    ]
    return {name: fmean(each[name] for each in every) for name in MEASURES}


def _graph(picture: np.ndarray) -> Labels:
    return cv2.ximgproc.segmentation.createGraphSegmentation(**GRAPH).processImage(picture)


def _times(given: Mapping[str, Photograph]) -> list[Figure]:
    picture = next(iter(given.values())).picture
    method = Hierarchy()
    small_ms = _milliseconds(lambda: method.segment(picture))
    large = cv2.resize(picture, LARGE[::-1], interpolation=cv2.INTER_CUBIC)
    large_ms = _milliseconds(lambda: method.segment(large), runs=3)
    extra_mib = _memory_mib()
    rows, columns = picture.shape[:2]
    return [
        Figure(f"`hierarchy`, {columns} x {rows}, one processor", "<= 150 ms", f"{small_ms:.0f} ms", small_ms <= 150),
        Figure(
            f"`hierarchy`, {LARGE[1]} x {LARGE[0]}, one processor",
            "<= 2 s, <= 1 GiB",
            f"{large_ms / 1000:.2f} s, {extra_mib} MiB beyond the picture",
            large_ms <= 2000 and extra_mib <= 1024,
        ),
    ]


def _milliseconds(work: Callable[[], object], runs: int = RUNS) -> float:
    with limited_threads(1):
        return 1000 * in_turns({"": work}, runs, process_time)[""].seconds


def _memory_mib() -> int:
    script = (
        "import numpy as np; from tangible_bench.memory import start_peak; from tangible_core import load_method;"
        f"rows, columns = np.indices({LARGE}, np.int32);"
        "grey = ((rows // 250 + columns // 250) % 2 * 90 + (rows * 7 + columns * 13) % 20).astype(np.uint8);"
        "picture = np.stack([grey, grey // 2, 255 - grey], axis=2); del rows, columns, grey;"
        "method = load_method('texture', 'hierarchy')(); method.segment(picture[:300, :400].copy());"
        "peak = start_peak(); method.segment(picture); print(peak())"
    )
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    return int(printed) >> 20
