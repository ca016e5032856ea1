"""The parts that the texts of a drawing name: around them, beside them, or at the end of their leader lines."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float64, Int32

from ..data import PictureText
from ..runtime.opencv import cv2, plain_opencv
from .marks import Marks

STEP_PX, WIDE_DEG = 3.0, 18.0  # the step along a leader line, px, and the greatest turn at a step, degrees
SHORT, LONG = 2.5, 6.0
"""The least length of a leader line, and the greatest distance from its end to its text, by the text's height."""
BESIDE = 1.0  # the same distance for a text that lies in a part
AROUND = 0.6  # the space around a text at which a leader line points, by the text's height
AHEAD = 4  # the steps that a way is on the line by which it is chosen
ALONG = 5  # the steps from the end of a line that give its direction
NEXT = 2.5  # the greatest distance to the part beside a text, by the text's height
NEARER = 1.25  # the least ratio of the distances to the next part but one and to the next
INSIDE = 0.5  # the least share of a text that lies in the part that it names
PAPER = 0.5  # the least share of the picture's rim that the paper of a drawing has


def texts_in(marks: Marks) -> tuple[PictureText, ...]:
    """Return the places of the texts in a picture; nobody has read them yet."""
    return tuple(PictureText("", text[:4], text.direction_deg) for text in marks.texts.boxes)


def tie_texts(
    centre: Bool[np.ndarray, "r c"], texts: Sequence[PictureText], parts: Int32[np.ndarray, "h w"]
) -> tuple[int | None, ...]:
    """Return for each text the number of the part that it names; None for a text on the paper far from parts.

    A part without a text in it or a leader line to it is named by the text beside it, unless that is a number.
    centre: the centre lines of a drawing, one pixel wide, on any grid.
    """
    # A leader line ends near the text, points at it, and runs on without a sharp turn across whatever lies between.
    rows, columns = parts.shape
    paper = _paper(parts)
    boxes = np.array([text.box for text in texts], np.float64).reshape(-1, 4)
    on_parts, named_parts = boxes * np.array([columns, rows, columns, rows]), list[int | None]()
    for left, top, right, bottom in on_parts:
        inside = parts[int(top) : max(int(top) + 1, round(bottom)), int(left) : max(int(left) + 1, round(right))]
        numbers, counts = np.unique(inside, return_counts=True)
        most = int(counts.argmax())
        names = counts[most] >= INSIDE * inside.size and numbers[most] != paper
        named_parts.append(int(numbers[most]) if names else None)
    shape = centre.shape
    on_lines = boxes * np.tile(np.array(shape[::-1]), 2)
    nearest = np.array([np.inf if place is None else BESIDE for place in named_parts])
    for path in _paths(centre):
        ends = [(*_pointed_at(way, on_lines), way) for way in (path, path[::-1])]
        number, distance, path = min(ends, key=lambda end: end[1])
        if number is None or distance >= nearest[number]:
            continue
        ahead = path[-1] + 2 * (path[-1] - path[-2])  # an end on an outline touches the part behind it
        for column, row in (path[-1], ahead) if parts[_at(path[-1], shape, parts)] == paper else (path[-1],):
            part = int(parts[_at(np.array([column, row]), shape, parts)])
            if part != paper:
                nearest[number], named_parts[number] = distance, part
    untied = [number for number, part in enumerate(named_parts) if part is None]
    title, beside = title_among([texts[number] for number in untied]), dict[int, list[tuple[float, int]]]()
    for number in untied:
        is_name = texts[number].is_level and texts[number].content != title and not _has_digit(texts[number])
        for part, distance in _beside(parts, on_parts[number], paper) if is_name else ():
            if part not in named_parts:
                beside.setdefault(part, []).append((distance, number))
    for part, candidates in beside.items():
        (distance, number), *others = sorted(candidates)
        if not others or others[0][0] >= NEARER * distance:
            named_parts[number] = part
    return tuple(named_parts)


def _has_digit(text: PictureText) -> bool:
    return any(letter.isdigit() for letter in text.content)


def _beside(
    parts: Int32[np.ndarray, "h w"], box: Float64[np.ndarray, "4"], paper: int | None
) -> Iterator[tuple[int, float]]:
    """Yield the part that is clearly the nearest to a text, if one is, and its distance, px."""
    left, top, right, bottom = box
    y, x = (np.asarray(np.arange(side) + 0.5, np.float64) for side in parts.shape)
    across = np.maximum(np.maximum(left - x, x - right), 0)
    down = np.maximum(np.maximum(top - y, y - bottom), 0)
    reach = NEXT * max(bottom - top, 1.0)
    rows, columns = np.flatnonzero(down <= NEARER * reach), np.flatnonzero(across <= NEARER * reach)
    near, away = parts[np.ix_(rows, columns)], np.hypot(down[rows, None], across[columns])
    by_distance = sorted((float(away[near == part].min()), int(part)) for part in np.unique(near) if part != paper)
    distances = [distance for distance, _ in by_distance] + [np.inf, np.inf]
    if distances[0] <= min(reach, distances[1] / NEARER):
        yield by_distance[0][1], distances[0]


def title_among(texts: Sequence[PictureText]) -> str:
    """Return the text that stands where titles do: the uppermost, if it is in the middle above, and no small print."""
    if not (texts := [text for text in texts if text.is_level]):
        return ""
    tallest = max(text.box[3] - text.box[1] for text in texts)
    first = min(texts, key=lambda text: text.middle[1])
    (across, down), tall = first.middle, first.box[3] - first.box[1]
    return first.content if abs(across - 0.5) < 0.1 and down < 0.15 and tall > 0.8 * tallest else ""


def _at(place: Float64[np.ndarray, "2"], shape: tuple[int, ...], parts: np.ndarray) -> tuple[int, int]:
    """Return the row and the column of a place on the ink in the map of parts."""
    column, row = (place[::-1] + 0.5) / shape * parts.shape
    return int(np.clip(column, 0, parts.shape[0] - 1)), int(np.clip(row, 0, parts.shape[1] - 1))


def _paper(parts: Int32[np.ndarray, "h w"]) -> int | None:
    """Return the part that has most of the rim; None without one."""
    numbers, counts = np.unique(np.concatenate([parts[0], parts[-1], parts[:, 0], parts[:, -1]]), return_counts=True)
    return int(numbers[counts.argmax()]) if counts.max() >= PAPER * counts.sum() else None


def _pointed_at(path: Float64[np.ndarray, "n 2"], boxes: Float64[np.ndarray, "m 4"]) -> tuple[int | None, float]:
    """Return the text at which the beginning of a path points, and its distance by its height."""
    away = path[0] - path[min(ALONG, len(path) - 1)]
    away /= max(float(np.hypot(*away)), 1e-9)
    best: tuple[int | None, float] = None, np.inf
    length = STEP_PX * (len(path) - 1)
    for number, (left, top, right, bottom) in enumerate(boxes):
        high = max(bottom - top, 1.0)
        if length < SHORT * high:
            continue
        reach = path[0] + away * np.arange(0, LONG * high, 1.0)[:, None]
        near = AROUND * high
        hit = (
            (reach[:, 0] >= left - near)
            & (reach[:, 0] <= right + near)
            & (reach[:, 1] >= top - near)
            & (reach[:, 1] <= bottom + near)
        )
        if hit.any() and (distance := float(hit.argmax()) / high) < best[1]:
            best = number, distance
    return best


def _paths(centre: Bool[np.ndarray, "r c"]) -> Iterator[Float64[np.ndarray, "n 2"]]:
    """Yield the ways from loose ends of lines on, as long as no turn is sharp; column and row."""
    with plain_opencv():
        near = np.asarray(cv2.dilate(centre.astype(np.uint8), np.ones((3, 3), np.uint8))) > 0
        count = np.asarray(cv2.filter2D(centre.astype(np.uint8), -1, np.ones((3, 3)), borderType=0))
    for row, column in np.argwhere(centre & (count == 2)):
        path = _follow(near, np.array([column, row], np.float64))
        if len(path) > 1:
            yield path  # its other end may be loose without looking so, a pixel thick


def _follow(near: Bool[np.ndarray, "r c"], start: np.ndarray) -> np.ndarray:
    """Return the places on the way from a loose end, STEP_PX apart."""
    rows, columns = near.shape
    turns = np.radians(np.array(sorted(np.linspace(-WIDE_DEG, WIDE_DEG, 13), key=abs)))
    path, heading, all_round = [start], 0.0, np.linspace(-np.pi, np.pi, 48, endpoint=False)
    while len(path) < rows + columns:
        ways = heading + turns if len(path) > 1 else all_round
        steps = STEP_PX * np.stack([np.cos(ways), np.sin(ways)], axis=1)
        ends = path[-1] + steps[:, None] * np.arange(1, AHEAD + 1)[:, None]
        at = np.rint(ends).astype(np.int64)
        inside = (at >= 0).all(axis=2) & (at[..., 0] < columns) & (at[..., 1] < rows)
        at = np.where(inside[..., None], at, 0)
        on = np.asarray(np.cumprod(inside & near[at[..., 1], at[..., 0]], axis=1), np.int64).sum(axis=1)
        if not on.any():
            break
        path.append(ends[int(on.argmax()), 0])
        back = path[max(0, len(path) - 1 - ALONG)]
        heading = float(np.arctan2(*(path[-1] - back)[::-1]))
    return np.array(path)
