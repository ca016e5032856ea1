"""The verdicts on what is left of a drawing on a medium: its lines, its parts and its texts."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool

from tangible_core.data import PartMap, border_pixels
from tangible_core.drawing import DrawnPicture, Lines, PictureKind, find_marks
from tangible_core.preflight import Verdict, check_bound
from tangible_core.runtime import cv2, plain_opencv

from .rules import GRAPHICS, OURS, Profile
from .words.places import describe_part, describe_place, join_texts, millimetres

MAX_LOST = 0.1  # share of the lines' length that may be lost before the picture is
MAX_CLOSE = 0.3  # share of the lines' length that may lie too near to another line
MAX_SILENT = 0.5  # share of the texts that may be lost before the picture is
NOTICED_M = 0.006  # the least length of a lost line that is named, as of a stroke that outlines stand for
# The least shares of the picture of a part that is named when it is lost, and without which the picture is lost.
NOTICED, IMPORTANT = 0.001, 0.02


def judge_drawing(
    drawing: DrawnPicture, profile: Profile, parts: PartMap | None, width_m: float, names: Sequence[str]
) -> Iterator[Verdict]:
    """Yield the verdicts on what is left. parts: as they are drawn; None if only lines are."""
    if drawing.kind == PictureKind.text:
        yield check_bound(
            *("page of text", "the picture", 1.0, "<=", 0.0, "share", OURS),
            says="this is a page of text, which fingers cannot read as a picture", worse="illegible",
            cure="write it in braille, or have it read aloud; `scene: {kind: drawing}` if it is another picture",
        )  # fmt: skip
        return
    yield from _judge_lines(drawing, find_marks(drawing.picture).lines, profile, parts, width_m)
    if drawing.whole is not None and parts is not None:
        yield from _judge_parts(drawing.whole, parts, names)
    lost = drawing.lost_texts
    places = list(dict.fromkeys(_with_place(text.content, *text.middle) for text in lost))
    verdict = check_bound(
        *("texts", "the letters", float(len(lost)), "<=", 0.0, "parts", OURS),
        says=f"texts are left out ({len(lost)}: {join_texts(places)})" if lost else "",
        cure="write them as names of parts, or in the description",
        worse="illegible" if len(lost) > MAX_SILENT * drawing.text_count else "warn",
    )  # fmt: skip
    yield replace(verdict, at=tuple(text.middle for text in lost))


def _with_place(name: str, x: float, y: float) -> str:
    return " ".join(filter(None, (name, describe_place(x, y)))) or "in the middle"


def _judge_lines(
    drawing: DrawnPicture, lines: Lines, profile: Profile, parts: PartMap | None, width_m: float
) -> Iterator[Verdict]:
    gap = profile.rules.get("gap")
    gap_m = 0.0032 if gap is None else gap.bound
    pitch_m = width_m / lines.centre.shape[1]
    if drawing.lines:
        own = lines
        if parts is not None:  # outlines stand for the lines along them
            away = _away(lines.centre.shape, parts, gap_m / pitch_m)
            own = lines._replace(mask=lines.mask & away, centre=lines.centre & away)
        close = own.share_near(gap_m / pitch_m) * own.centre.sum() / max(lines.centre.sum(), 1)
        yield check_bound(
            *("close lines", "the lines", close, "<=", MAX_CLOSE, "share", f"{OURS}; for the distance {GRAPHICS}"),
            says="many lines run so close to each other that a finger takes them for one", worse="illegible",
            cure="make the picture larger, or have fewer lines",
        )  # fmt: skip
    elif lines.centre.any():
        away = True if parts is None else _away(lines.centre.shape, parts, gap_m / pitch_m)
        lost = lines.centre & away
        share = float(lost.sum() / lines.centre.sum())
        pieces = [piece for piece in _pieces(lost) if piece[0] * pitch_m >= NOTICED_M]
        texts = [
            f"a line of {millimetres(length * pitch_m)} {describe_place(*at) or 'in the middle'}"
            for length, at in pieces
        ]
        says = f"{100 * share:.0f} % of the length of the drawing's lines is left out"
        verdict = check_bound(
            *("kept lines", "the lines", share, "<=", 0.0 if pieces else MAX_LOST, "share", OURS),
            says=f"{says}: {join_texts(texts)}" if texts else says,
            cure="`relief: lines` raises them, and a page for swell paper has them",
            worse="illegible" if share > MAX_LOST else "warn",
        )  # fmt: skip
        yield replace(verdict, at=tuple(at for _, at in pieces))


def _pieces(centre: Bool[np.ndarray, "r c"]) -> list[tuple[float, tuple[float, float]]]:
    """Return the length of each piece of centre lines, px, and its place as shares of the picture; longest first."""
    from scipy.ndimage import find_objects

    with plain_opencv():
        numbers = np.asarray(cv2.connectedComponents(centre.astype(np.uint8), connectivity=8)[1], np.int32)
    pieces = list[tuple[float, tuple[float, float]]]()
    for number, box in enumerate(find_objects(numbers), 1):
        piece = numbers[box] == number
        straight = (piece[1:] & piece[:-1]).sum() + (piece[:, 1:] & piece[:, :-1]).sum()
        pixels = np.argwhere(piece) + [side.start for side in box]
        row, column = pixels[np.hypot(*(pixels - pixels.mean(axis=0)).T).argmin()] + 0.5
        length = straight + np.sqrt(2) * max(0, len(pixels) - 1 - straight)  # n pixels have n - 1 steps
        pieces.append((float(length), (float(column / centre.shape[1]), float(row / centre.shape[0]))))
    return sorted(pieces, reverse=True)


def _away(shape: tuple[int, ...], parts: PartMap, reach: float) -> Bool[np.ndarray, "r c"]:
    """Return the cells of a grid of this shape that are farther than this from a border of parts, in its cells."""
    from scipy.ndimage import distance_transform_edt

    rows, columns = (np.arange(new) * old // new for new, old in zip(shape, parts.labels.shape, strict=True))
    border = border_pixels(parts.labels)
    if not border.any():
        return np.ones(shape, np.bool_)
    far = np.asarray(distance_transform_edt(~border)) > reach * parts.labels.shape[1] / shape[1]
    return far[np.ix_(rows, columns)]


def _judge_parts(whole: PartMap, parts: PartMap, names: Sequence[str]) -> Iterator[Verdict]:
    before, after = (np.bincount(part_map.labels.reshape(-1), minlength=whole.count) for part_map in (whole, parts))
    share = before / before.sum()
    absent = np.flatnonzero((share >= NOTICED) & (after[: whole.count] == 0))
    absent = absent[np.argsort(-share[absent])]
    area = float(share[absent].sum())
    spans = [np.argwhere(whole.labels == number).mean(axis=0) / whole.labels.shape for number in absent]
    middles = [(float(x), float(y)) for y, x in spans]
    texts = [
        _with_place(describe_part(number, names), *at) for number, at in zip(absent.tolist(), middles, strict=True)
    ]
    verdict = check_bound(
        *("kept parts", "the parts", float(absent.size), "<=", 0.0, "parts", OURS),
        says=f"parts are left out ({join_texts(texts)}; {100 * area:.1f} % of the picture)" if texts else "",
        cure="make the picture larger, or have fewer parts", worse="illegible" if area >= IMPORTANT else "warn",
    )  # fmt: skip
    yield replace(verdict, at=tuple(middles))
