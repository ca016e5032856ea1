"""Photographs divided as people divide them: `hierarchy` beside `gradient` and OpenCV's graph.

TANGIBLE_REGIONS names a folder of photographs, *.jpg, each with the regions that people drew, in an .npz of that name.
"""

import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from statistics import fmean
from time import process_time

import cv2
import numpy as np

from tangible_bench.metrics.segments import adjusted_rand_index, contingency, covering, rand_index
from tangible_core.data import SegmentTree
from tangible_core.runtime.threads import limited_threads
from tangible_texture import Gradient, Hierarchy

from .figures import Figure, judged, mean_and_error, part, table
from .regions_drawn import Photograph, photographs
from .regions_fit import fit, prepare, tree
from .turns import in_turns

FOLDS = 4
COUNTS = (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 100)
"""The numbers of segments among which the best of a picture is chosen."""
GRAPH = {"sigma": 0.5, "k": 500.0, "min_size": 300}
"""OpenCV's graph at the options that cover the given photographs best, of k 100..1000 and sizes 50..500."""
RUNS, LARGE = 7, (3000, 4000)
Labels = np.ndarray
MEASURES = {"covering": covering, "PRI": rand_index, "ARI": adjusted_rand_index}


def section() -> str:
    """Return the section as Markdown."""
    given = photographs()
    if not given:
        return "Not measured: TANGIBLE_REGIONS names no folder of photographs."
    quality, figures = part("regions", lambda: _quality(given))
    figures += part("times", lambda: _times(given))
    head = (
        f"{len(given)} photographs of the Berkeley data set, each divided by about five people; a measure is the mean "
        "over the people, then over the photographs, with its standard error. Covering: the overlap of each drawn "
        "region with the segment that fits it best, by area. Best: the number that covers this photograph best. "
        "Cross-validation: weights fitted to three quarters of the photographs, measured on the others, "
        f"in {FOLDS} turns."
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
    means = {measure: fmean(each[measure] for each in default[crossed]) for measure in MEASURES}
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
    """Return what `gradient` makes of each number of COUNTS."""
    return [Gradient(segments=count).segment(picture).labels for count in COUNTS]


def _cuts(tree: SegmentTree) -> list[Labels]:
    return [tree.cut(count).labels for count in COUNTS]


def _crossed(given: Mapping[str, Photograph]) -> tuple[list[Mapping[str, float]], list[Mapping[str, float]]]:
    """Return the measures of trees whose weights were fitted to other photographs: at a cost of 0, and the best."""
    prepared = [prepare(each) for each in given.values()]
    default: dict[int, Mapping[str, float]] = {}
    best: dict[int, Mapping[str, float]] = {}
    for fold in range(FOLDS):
        model = fit([each for at, each in enumerate(prepared) if at % FOLDS != fold])
        for at in range(fold, len(prepared), FOLDS):
            photo = Photograph(prepared[at].photograph.picture, prepared[at].drawn)
            found = tree(prepared[at], model)
            default[at] = _measures(found.cut(64, 0.0).labels, photo)
            best[at] = _best(_cuts(found), photo)
    return [default[at] for at in range(len(prepared))], [best[at] for at in range(len(prepared))]


def _each(given: Mapping[str, Photograph], find: Callable[[np.ndarray], Labels]) -> list[Mapping[str, float]]:
    return [_measures(find(photo.picture), photo) for photo in given.values()]


def _best(cuts: Sequence[Labels], photo: Photograph) -> Mapping[str, float]:
    return max((_measures(labels, photo) for labels in cuts), key=lambda each: each["covering"])


def _measures(labels: Labels, photo: Photograph) -> Mapping[str, float]:
    """Return the mean of each measure over the people."""
    counts = [contingency(labels, drawn) for drawn in photo.drawn]
    return {name: fmean(measure(each) for each in counts) for name, measure in MEASURES.items()}


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
    """Return the peak of a process that divides a large picture, beyond the picture itself, MiB."""
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
