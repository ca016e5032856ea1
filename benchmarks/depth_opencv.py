"""OpenCV's own matcher, called without our wrapper: what times are compared with."""

import cv2
import numpy as np

from tangible_core.scene.geometry import fill_rows

from .depth_pairs import KnownScene

PEERS = {"3WAY": ("3way", 5), "HH4": ("hh4", 3), "SGBM": ("sgbm", 5), "HH": ("hh", 3)}
"""Modes of OpenCV and the side of the blocks each does best with."""
MODES = {"sgbm": 0, "hh": 1, "3way": 2, "hh4": 3}


def raw(known: KnownScene, name: str = "3WAY") -> np.ndarray:
    """Disparity in sixteenths of a pixel, of views padded on the left so that every column has an answer."""
    mode, block = PEERS[name]
    count = known.disparities
    matcher = cv2.StereoSGBM.create(0, count, block, 8 * block**2, 32 * block**2, 1, 63, 10, 100, 2, MODES[mode])
    padded = (cv2.copyMakeBorder(view, 0, 0, count, 0, cv2.BORDER_REPLICATE) for view in known.grey)
    return matcher.compute(*padded)[:, count:]


def filled(known: KnownScene) -> np.ndarray:
    """3WAY's disparity in pixels with its holes filled as its errors are: a map as whole as ours."""
    found = raw(known)
    return fill_rows(np.where(found >= 0, found / np.float32(16), np.float32(np.nan)))
