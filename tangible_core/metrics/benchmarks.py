"""What the tables of stereo benchmarks show beside the measures of `disparity_errors`."""

import numpy as np
from jaxtyping import Bool, Float

from .disparity import absolute_error

QUANTILES = (50, 90, 95, 99)
KITTI_PX, KITTI_SHARE = 3.0, 0.05
"""An estimate is an outlier if it is off by more than 3 px and by more than 5 % of the true disparity."""


def benchmark_errors(
    disparity_px: Float[np.ndarray, "h w"],
    truth_px: Float[np.ndarray, "h w"],
    foreground: Bool[np.ndarray, "h w"] | None = None,
) -> dict[str, float]:
    """Measures of Middlebury's version 3 and of KITTI; what is not finite is unknown.

    Returns: `a50_px` to `a99_px`, the error that 50 to 99 % of the pixels with both do not exceed, in px; `invalid`,
    the share of the pixels with truth that have no estimate; `bad3`, KITTI 2012's share of outliers, over 3 px; `d1`,
    KITTI 2015's, over 3 px and 5 %; `d1_bg` and `d1_fg`, that of the pixels outside of the foreground and in it; all
    in percent. A missing estimate is bad. `pixels`, `pixels_bg`, `pixels_fg`: how many have truth. NaN where there is
    nothing to measure, or no foreground is given.
    Raises: PictureError if the two differ in size.
    Source: Scharstein et al., High-resolution stereo datasets with subpixel-accurate ground truth, GCPR 2014; Geiger,
    Lenz & Urtasun, Are we ready for autonomous driving?, CVPR 2012; Menze & Geiger, Object scene flow for autonomous
    vehicles, CVPR 2015.
    """
    error_px = absolute_error(disparity_px, truth_px)
    at = np.isfinite(truth_px)
    error, truth = error_px[at], np.abs(truth_px[at])
    known = error[np.isfinite(error)]
    outlier = ~((error <= KITTI_PX) | (error <= KITTI_SHARE * truth))
    quantiles = np.percentile(known, QUANTILES) if known.size else np.full(len(QUANTILES), np.nan)
    found = {f"a{share}_px": float(value) for share, value in zip(QUANTILES, quantiles, strict=True)}
    found |= {"invalid": _percent(~np.isfinite(error)), "bad3": _percent(~(error <= KITTI_PX)), "d1": _percent(outlier)}
    in_front = None if foreground is None else foreground[at]
    for name, part in (("_bg", None if in_front is None else ~in_front), ("_fg", in_front)):
        found[f"d1{name}"] = float("nan") if part is None else _percent(outlier[part])
        found[f"pixels{name}"] = 0.0 if part is None else float(np.count_nonzero(part))
    return found | {"pixels": float(error.size)}


def _percent(flags: np.ndarray) -> float:
    return 100 * float(flags.mean()) if flags.size else float("nan")
