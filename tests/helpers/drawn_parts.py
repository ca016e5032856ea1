"""Pictures of scikit-image with parts that were drawn over them by hand."""

from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
from ruamel.yaml import YAML
from scipy.ndimage import distance_transform_edt
from skimage import data

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts, part_sizes


class Drawn(NamedTuple):
    """A picture with its parts."""

    picture: np.ndarray
    parts: PartMap
    names: tuple[str, ...]
    heights_m: tuple[float, ...]


@cache
def drawings() -> dict[str, Any]:
    """What `drawn_parts.yaml` says, by picture."""
    return YAML(typ="safe").load(Path(__file__).with_suffix(".yaml"))


@cache
def drawn(name: str) -> Drawn:
    """A picture of `drawings`. A thing that another divides is several parts of one name and height."""
    picture = getattr(data, name)() if name != "motorcycle" else data.stereo_motorcycle()[0]
    labels, things = np.zeros(picture.shape[:2], np.int32), drawings()[name]
    for label, thing in enumerate(things[1:], 1):
        cv2.fillPoly(labels, [np.array(thing["outline"], np.int32)], label)
    parts = find_parts(SegmentMap(_without_slits(labels)))
    of = [things[label] for label in parts.segments]
    return Drawn(picture, parts, tuple(each["name"] for each in of), tuple(float(each["height_m"]) for each in of))


def _without_slits(labels: np.ndarray) -> np.ndarray:
    """What is left between two outlines that were meant to be one goes to the nearest thing."""
    parts = find_parts(SegmentMap(labels))
    slit = (part_sizes(parts) < 200)[parts.labels]
    row, column = distance_transform_edt(slit, return_distances=False, return_indices=True)
    return labels[row, column]
