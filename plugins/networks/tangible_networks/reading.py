"""What texts in a picture say, by a network that reads one row of letters at a time."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from tangible_core.data import PictureText, to_rgb
from tangible_core.runtime import cv2, plain_opencv

from .fitting import Colours, fit_size, tensor
from .onnx_file import read_metadata
from .runtimes import run
from .store import networks_here

ROW_PX = 48  # the height of rows that the network was trained with
MARGIN = 0.3  # around a text, as a share of its height
LEAST = 0.3  # height of a row in a tilted box, as a share of the box's
SURE = 0.5  # mean sureness of the letters of a text that counts as read
MAX_WIDE = 40  # width of a row by its height; a longer one is seen narrower


def read_texts(picture: np.ndarray, texts: Sequence[PictureText]) -> tuple[PictureText, ...]:
    """Return the texts of a picture (`to_rgb`) with what they say; "" where that is not sure, or without a network."""
    # Li et al., PP-OCRv3, 2022; letters by the best class of each step, Graves et al., CTC, 2006.
    networks = networks_here("text")
    if not texts or not networks:
        return tuple(texts)
    network, colours = networks[0], to_rgb(np.nan_to_num(picture))
    card, letters = network.card, _letters(network.path, network.path.stat().st_mtime_ns)
    classes = list[np.ndarray]()
    for text in texts:
        row = _upright_row(colours, text)
        values = tensor(row, card.input, fit_size((row.shape[0], row.shape[1]), card.input, row.size))
        steps = run(network.path, card.runtime or "opencv", {card.input.left: values}, [card.output.name])[0]
        classes.append(steps.reshape(-1, steps.shape[-1]))
    results = [replace(text, content=_content(steps, letters)) for text, steps in zip(texts, classes, strict=True)]
    digits = [letters.index(digit) for digit in "0123456789" if digit in letters]
    for place in _among_numbers(results, colours.shape[:2]) if digits else ():
        digit = letters[digits[int(classes[place][:, digits].max(axis=0).argmax())]]
        results[place] = replace(results[place], content=digit)
    return tuple(results)


def _among_numbers(texts: Sequence[PictureText], shape: tuple[int, ...]) -> list[int]:
    """Return the single letters that stand in a row or column of numbers, as on an axis: O is 0 there."""
    # A letter alone has no neighbour by which the network could tell its size.
    boxes = np.array([text.box for text in texts]).reshape(-1, 4) * np.tile(shape[::-1], 2)
    (wide, high), middles = (boxes[:, 2:] - boxes[:, :2]).T, (boxes[:, 2:] + boxes[:, :2]) / 2
    is_number = np.array([text.content.replace(".", "", 1).isdecimal() for text in texts])
    places = list[int]()
    for place in np.flatnonzero(wide < high):
        level, upright = (np.abs(middles - middles[place]) < high[place] / 2).T[::-1]
        upright |= np.abs(boxes[:, 2] - boxes[place, 2]) < high[place] / 2
        aligned = (level | upright) & (np.abs(high - high[place]) < high[place] / 2)
        aligned[place] = False
        if is_number[aligned].sum() > max(1, aligned.sum() / 2):
            places.append(int(place))
    return places


@lru_cache(maxsize=2)
def _letters(path: Path, changed_ns: int) -> tuple[str, ...]:
    """Return the letter of each class: none, those that the file lists, a line each, and the space."""
    return ("", *read_metadata(path).get("character", "").split("\n"), " ")


def _upright_row(colours: Colours, text: PictureText) -> Float32[np.ndarray, "48 columns 3"]:
    """Return a text turned so that it is read from left to right, in the height that the network takes."""
    rows, columns = colours.shape[:2]
    left, top, right, bottom = text.box * np.array([columns, rows, columns, rows])
    turn = np.radians(text.direction_deg)
    wide, high = max(right - left, 1), max(bottom - top, 1)
    tilt = turn
    if not text.is_level:
        wide, high, tilt = high, wide, turn - np.pi / 2
    high = max((high - wide * abs(np.sin(tilt))) / np.cos(tilt), LEAST * high)
    scale = high * (1 + 2 * MARGIN) / ROW_PX
    count = round(min((wide + 2 * MARGIN * high) / scale, MAX_WIDE * ROW_PX))
    across = (wide + 2 * MARGIN * high) / max(count, 1)
    turned = np.array([[across * np.cos(turn), scale * np.sin(turn)], [-across * np.sin(turn), scale * np.cos(turn)]])
    corner = np.array([left + right - 1, top + bottom - 1]) / 2 - turned @ [(count - 1) / 2, (ROW_PX - 1) / 2]
    low = np.maximum(np.array([left, top], np.int64) - int(2 * high), 0)
    colours, corner = colours[low[1] : int(bottom + 2 * high), low[0] : int(right + 2 * high)], corner - low
    with plain_opencv():
        if scale > 1:  # averaging first: no pixel of a large text is left out
            colours = np.asarray(cv2.GaussianBlur(colours, (0, 0), scale / 2))
        size, flags = (count, ROW_PX), cv2.WARP_INVERSE_MAP | cv2.INTER_CUBIC
        row = cv2.warpAffine(
            colours, np.column_stack([turned, corner]), size, flags=flags, borderMode=cv2.BORDER_REPLICATE
        )
    return np.clip(np.asarray(row, np.float32), 0, 1)


def _content(steps: Float32[np.ndarray, "steps classes"], letters: tuple[str, ...]) -> str:
    """Return the best letter of each step, once where it lasts, without the class of none; "" where it is not sure."""
    best = steps.argmax(axis=1)
    new = (best > 0) & (best < len(letters)) & np.concatenate([[True], best[1:] != best[:-1]])
    if not new.any() or steps.max(axis=1)[new].mean() < SURE:
        return ""
    return "".join(letters[place] for place in best[new]).strip()
