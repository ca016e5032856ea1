"""Photographs without depth: felt steps against the borders that people drew, by brightness, by edges and by lines."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from statistics import fmean
from typing import Any

import cv2
import numpy as np
from scipy.ndimage import distance_transform_edt

from tangible_core import Pipeline, Scene
from tangible_core.data import Relief
from tangible_core.data.views import border_pixels
from tangible_core.scene.workspace import Workspace
from tangible_depth import Luminance
from tangible_legibility.border_steps import WITHIN_M, felt_steps
from tangible_texture import Hierarchy

from .figures import mean_and_error, table
from .regions_drawn import Photograph, photographs
from .tests_path import drawn_parts

DRAWN = "astronaut", "coffee", "motorcycle", "chelsea", "rocket", "camera"


def lines() -> list[str]:
    """Felt steps of photographs against the borders that people drew."""
    made = {
        "brightness": lambda picture, width_m: _photograph(picture, width_m, depth=Luminance()),
        "edges": lambda picture, width_m: _photograph(picture, width_m, relief="edges"),
        "lines of `hierarchy`": lambda picture, width_m: _photograph(
            picture, width_m, relief="edges", texture=Hierarchy()
        ),
    }
    pictures = {
        name: Photograph(drawn.picture, [drawn.parts.labels]) for name in DRAWN for drawn in [drawn_parts.drawn(name)]
    }
    regions = photographs()
    groups = {name: {name: each} for name, each in pictures.items()}
    if regions:
        unseen = dict(list(regions.items())[1::2])  # the others are for choosing
        groups[f"mean of {len(unseen)} photographs"] = unseen
    rows: list[tuple[str, ...]] = []
    for group, chosen in groups.items():
        for width_m in (0.08, 0.16):
            for what, make in made.items():
                shares = [_drawn_steps(make(picture, width_m), borders) for picture, borders in chosen.values()]
                rows.append(
                    (
                        group,
                        f"{1000 * width_m:.0f} mm",
                        what,
                        *(mean_and_error(list(each)) for each in zip(*shares, strict=True)),
                    )
                )
    said = (
        "One photograph, by brightness, by edges, and by lines where `hierarchy` expects people to draw a border: the "
        "share of the felt steps within 2 mm of a border that somebody drew, and the share of the drawn borders with a "
        "felt step. The weights of `hierarchy` were fitted to these photographs, not to the named pictures."
    )
    return [said, "", *table(("picture", "wide", "relief", "at a drawn border", "found"), rows)]


def _photograph(picture: np.ndarray, width_m: float, **how: Any) -> Relief:
    return Pipeline(Scene.photo(picture), workspace=Workspace(width_m=width_m), cached=False, **how).relief


def _drawn_steps(relief: Relief, drawn: list[np.ndarray]) -> tuple[float, float]:
    """Return the share of felt steps at a border that anybody drew, and the mean share of each one's borders found."""
    steps = felt_steps(relief)
    each = [border_pixels(cv2.resize(labels, steps.shape[::-1], interpolation=cv2.INTER_NEAREST)) for labels in drawn]
    near = np.asarray(distance_transform_edt(~np.any(each, axis=0))) * relief.pitch_m[0] <= WITHIN_M
    return float(np.mean(near[steps])) if steps.any() else 0.0, fmean(float(np.mean(steps[lines])) for lines in each)
