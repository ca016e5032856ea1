"""Drawings made by code, for tests: a house in lines, a map of three countries, a page of text."""

import cv2
import numpy as np

COLOURS = {1: (200, 60, 60), 2: (70, 160, 80), 3: (60, 90, 200)}


def house(ink: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Return a line drawing of 360 x 480 pixels, its lines 3 px wide, and the mask of these."""
    mask = np.zeros((360 * 4, 480 * 4), np.uint8)
    wall, roof = [(120, 160), (120, 320), (300, 320), (300, 160)], [(110, 160), (210, 70), (310, 160)]
    for corners in (wall, roof, [(20, 320), (460, 320)]):
        cv2.polylines(mask, [np.array(corners) * 4], len(corners) == 4, 255, 12)
    cv2.circle(mask, (400 * 4, 80 * 4), 100, 255, 12)
    share = cv2.resize(mask, (480, 360), interpolation=cv2.INTER_AREA) / 255
    picture = np.rint(255 - (255 - ink) * share)[..., None].repeat(3, 2).astype(np.uint8)
    return picture, share > 0.5


def countries() -> tuple[np.ndarray, np.ndarray]:
    """Return a map of 360 x 480 pixels with smooth edges, and the number of each pixel's country, 0 for paper."""
    labels = np.zeros((360 * 4, 480 * 4), np.uint8)
    cv2.fillPoly(labels, [np.array([(60, 60), (250, 40), (230, 300), (70, 290)]) * 4], 1)
    cv2.fillPoly(labels, [np.array([(250, 40), (420, 80), (400, 200), (238, 190)]) * 4], 2)
    cv2.circle(labels, (330 * 4, 260 * 4), 40 * 4, 3, -1)
    palette = np.array([(255, 255, 255), *COLOURS.values()], np.uint8)
    return cv2.resize(palette[labels], (480, 360), interpolation=cv2.INTER_AREA), labels[2::4, 2::4].astype(np.int32)


def page(lines: int = 9) -> np.ndarray:
    """Return a page of text of 360 x 480 pixels."""
    picture = np.full((360, 480, 3), 255, np.uint8)
    for line in range(lines):
        words = f"some words of a page {'abcdefghi'[line]}"
        cv2.putText(picture, words, (20, 40 + 34 * line), 0, 0.7, (0, 0, 0), 1, cv2.LINE_AA)
    return picture


def scanned(picture: np.ndarray, noise: float = 4, shadow: float = 0.4, quality: int = 0) -> np.ndarray:
    """Return the picture with noise, a shadow from the left, and as JPEG of a quality other than 0."""
    light = 1 - shadow * np.linspace(1, 0, picture.shape[1])[None, :, None]
    copy = picture * light + np.random.default_rng(0).normal(0, noise, picture.shape)
    copy = np.clip(copy, 0, 255).astype(np.uint8)
    return cv2.imdecode(cv2.imencode(".jpg", copy, [cv2.IMWRITE_JPEG_QUALITY, quality])[1], 1) if quality else copy
