"""Segments of a picture by colour alone: they fall into thousands of parts, as those of photographs do."""

import cv2
import numpy as np

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts


def by_colour(picture: np.ndarray, count: int = 6) -> PartMap:
    """The parts of so many colours, by k-means in CIELAB."""
    lab = cv2.cvtColor(picture.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2LAB).reshape(-1, 3)
    cv2.setRNGSeed(0)
    first = np.zeros((len(lab), 1), np.int32)
    _, labels, _ = cv2.kmeans(lab, count, first, (3, 30, 0.5), 2, cv2.KMEANS_PP_CENTERS)
    return find_parts(SegmentMap(labels.reshape(picture.shape[:2]).astype(np.int32)))
