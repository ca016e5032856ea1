"""The first disparity of a process, with nothing compiled on disk and with everything."""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from skimage.data import stereo_motorcycle

from .figures import Figure

FIRST_DISPARITY = """
import json, logging, sys
from time import perf_counter
begun = perf_counter()
import cv2, numba, numpy
imports = perf_counter() - begun
from tangible_core import Views
import tangible_depth.matching.chain, tangible_depth.search.pairs, tangible_depth.matching.scaling
from tangible_depth.semi_global import SemiGlobal
left, right = numpy.load(sys.argv[1])
class Ear(logging.Handler):
    heard = []
    def emit(self, record):
        self.heard.append(record.getMessage())
logging.getLogger().addHandler(Ear())
logging.getLogger().setLevel(logging.INFO)  # as the command line does
start = perf_counter()
SemiGlobal().estimate(Views(left, right))
end = perf_counter()
print(json.dumps([imports, end - begun, end - start, Ear.heard]))
"""


def figures(again: int = 5) -> list[Figure]:
    """One process that compiles, and some that do not."""
    with tempfile.TemporaryDirectory() as folder:
        pair = Path(folder) / "pair.npy"
        np.save(pair, stereo_motorcycle()[:2])
        (*_, first), said = first_disparity(pair, Path(folder))
        later = [first_disparity(pair, Path(folder)) for _ in range(again)]
    imports, whole, second = (statistics.median(each) for each in zip(*(seconds for seconds, _ in later), strict=True))
    told = _compiles(said) and not any(_compiles(heard) for _, heard in later)
    measured = (
        f"second process {second:.2f} s (median of {again}), first {first:.1f} s; "
        f"{'said by the first alone' if told else 'not said, or said by all'}"
    )
    return [
        Figure(
            "start: first disparity after imports, motorcycle",
            "second process <= 0.5 s; the first says that it compiles",
            measured,
            second <= 0.5 and told,
        ),
        Figure(
            "start: second process with all its imports up to that disparity",
            "<= 2.2 x of importing numpy, cv2 and numba",
            f"{whole / imports:.2f} x: {whole:.2f} s, of which these imports {imports:.2f} s (medians of {again})",
            whole <= 2.2 * imports,
        ),
    ]


def first_disparity(pair: Path, cache: Path) -> tuple[list[float], list[str]]:
    """Seconds of a new process: for importing numpy, cv2 and numba, up to a map, and for the map; and what it said."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, "-c", FIRST_DISPARITY, pair], capture_output=True, text=True, check=True, env=environment
    )
    *seconds, said = json.loads(done.stdout)
    return seconds, said


def _compiles(said: list[str]) -> bool:
    return any(each.startswith("compiling") for each in said)
