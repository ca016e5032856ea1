"""Photographs with the regions that several people drew in each, from the folder that REGIONS names."""

import os
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Int32, UInt8

# Environment variable: a folder of photographs, .jpg, each with an .npz of the same name: label maps (h, w).
REGIONS = "TANGIBLE_REGIONS"
# The end of the name of a folder beside it: photographs that networks were not trained on.
UNSEEN = "_unseen"


class Photograph(NamedTuple):
    """A photograph, and the label map of each person."""

    picture: UInt8[np.ndarray, "h w 3"]
    drawn: list[Int32[np.ndarray, "h w"]]


def photographs(end: str = "") -> dict[str, Photograph]:
    """Return the photographs by their names, in order; none without the variable. end: of the folder's name."""
    folder = os.environ.get(REGIONS)
    files = sorted(Path(folder.rstrip("/") + end).glob("*.jpg")) if folder else []
    return {file.stem: Photograph(_read(file), _labels(file.with_suffix(".npz"))) for file in files}


def _read(file: Path) -> UInt8[np.ndarray, "h w 3"]:
    picture = cv2.imread(str(file), cv2.IMREAD_COLOR_RGB)
    assert picture is not None, f"{file} is not a picture"
    return np.asarray(picture, np.uint8)


def _labels(file: Path) -> list[Int32[np.ndarray, "h w"]]:
    with np.load(file) as kept:
        return [kept[name].astype(np.int32) for name in kept.files]
