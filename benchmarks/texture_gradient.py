"""`gradient` on piecewise-smooth scenes, beside scikit-image's Sobel and watershed; a torn region counts as several."""

from functools import partial

import numpy as np
from skimage.filters import gaussian, sobel
from skimage.measure import label
from skimage.morphology import remove_small_objects
from skimage.segmentation import watershed

from tangible_bench.metrics.segments import segment_errors
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.texture_scenes import KnownSegments

from .figures import Figure
from .texture_scenes import smooth
from .turns import in_turns

RECIPE = (
    "`sobel` of the picture under a Gaussian of 2 px, `watershed` from the connected parts of 200 px or more in the "
    "flattest 60 %; a region that is torn into pieces counts as several"
)
SIGMA_PX, FLAT_SHARE, SMALLEST_PX = 2.0, 0.6, 200
TIMED, ROUNDS = 4, 7
PEER = "scikit-image"


def recipe(picture: np.ndarray) -> np.ndarray:
    """scikit-image's labels, int32 (h, w)."""
    steep = sobel(gaussian(picture, SIGMA_PX))
    flat = remove_small_objects(steep < np.quantile(steep, FLAT_SHARE), max_size=SMALLEST_PX - 1)
    return watershed(steep, label(flat))


def pieces(scene: KnownSegments) -> np.ndarray:
    """Return the true regions, int32 (h, w), each in one piece."""
    return np.asarray(label(scene.labels, background=-1, connectivity=1), np.int32) - 1


def figures() -> list[Figure]:
    """Return the promises about smooth scenes."""
    method = load_method("texture", "gradient")()
    calls = {
        name: {
            PEER: partial(recipe, scene.picture),
            "gradient": lambda picture=scene.picture: method.segment(picture).labels,
        }
        for name, scene in smooth().items()
    }
    errors = {
        name: {who: segment_errors(call(), pieces(smooth()[name])) for who, call in each.items()}
        for name, each in calls.items()
    }
    ours, theirs = ({name: error[who]["ari"] for name, error in errors.items()} for who in ("gradient", PEER))
    boundary_px = np.mean([error["gradient"]["boundary_px"] for error in errors.values()])
    times = [in_turns(each, ROUNDS)["gradient"] for each in list(calls.values())[:TIMED]]
    share = float(np.median([time.ratio for time in times]))
    worst = min(ours, key=ours.__getitem__)
    below = sum(ari < 0.99 for ari in ours.values())
    return [
        Figure(
            f"`gradient`, {len(ours)} piecewise-smooth scenes, number of segments not told",
            "ARI >= .99 on every one, at <= 1/5 of scikit-image's Sobel and watershed",
            f"mean {np.mean(list(ours.values())):.4f}, worst {ours[worst]:.3f} ({worst}; {below} below), "
            f"boundary {boundary_px:.2f} px, {1e3 * np.median([time.seconds for time in times]):.1f} ms, at "
            f"1/{1 / share:.1f} (scikit-image: {np.mean(list(theirs.values())):.4f}, {min(theirs.values()):.3f})",
            below == 0 and share <= 1 / 5,
        )
    ]
