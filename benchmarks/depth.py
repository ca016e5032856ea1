"""Depth: every promise with its bound, and what stands behind the figures.

TANGIBLE_STEREO names a folder of further photographs with truth (left.png, right.png, disparity.npz in sub-folders),
such as Middlebury's; the extra `peers` installs what else is measured against.
"""

import os
from itertools import chain

from . import (
    depth_accuracy,
    depth_confidence,
    depth_growth,
    depth_pairs,
    depth_pandora,
    depth_range,
    depth_raw,
    depth_robustness,
)
from .figures import judged, part

PROTOCOL = (
    "Times are ratios to OpenCV's StereoSGBM 3WAY, called without our wrapper on views in grey, padded on the left, "
    "told the true range (the next multiple of 16), its holes filled from the background in their row, in the same "
    "process in turn, median of the rounds. `semi-global`, its preview and `zncc` find the range themselves, in the "
    "time given. Errors are those of `tangible compare`: bad2 is the share of the pixels with truth that are over "
    "2 px off or missing, noc that of the pixels that both views show; OpenCV's holes are filled in the same way. The "
    "mean counts each photograph once, and the mean of the synthetic scenes once."
)


def section() -> str:
    """Return the section as Markdown."""
    accuracy = part("errors and times", depth_accuracy.figures)
    robustness, by_damage = part("damaged pairs", depth_robustness.measured)
    growth, sizes = part("growth", depth_growth.measured)
    single = (depth_confidence, depth_pandora, depth_range, depth_raw)
    others = [part(each.__name__.removeprefix("benchmarks."), each.figures) for each in single]
    figures = [*accuracy, *robustness, *chain.from_iterable(others), *growth]
    return "\n".join(
        [
            *_conditions(),
            "",
            *judged(figures),
            "",
            "By scene: bad2 over all pixels with truth, and time against 3WAY.",
            "",
            *part("scenes", depth_accuracy.scene_rows),
            "",
            "`tangible compare configs/compare-depth.yaml`, mean of all scenes, views in colour where they have it; "
            "here the baseline is our wrapper round OpenCV.",
            "",
            *depth_accuracy.comparison_rows(),
            "",
            "How often a value of `semi-global` is within 2 px, by the probability of it that its confidence states; "
            "each scene counts alike.",
            "",
            *part("confidence", depth_confidence.rows),
            "",
            "Damaged pairs: bad2 in percent, mean of all scenes.",
            "",
            *by_damage,
            "",
            f"The builtin pair in tiles, {depth_growth.DISPARITIES} disparities told to both.",
            "",
            *sizes,
        ]
    )


def _conditions() -> list[str]:
    scenes = ", ".join(depth_pairs.real_specs())
    given = (
        ""
        if os.environ.get(depth_pairs.FOLDER)
        else f" {depth_pairs.FOLDER} was not set: no other photographs were measured."
    )
    return [f"Photographs: {scenes}; synthetic: planes, steps, spheres, bars of 480 x 360.{given}", "", PROTOCOL]
