"""The verdicts on what is left of a drawing on a medium: its lines, its parts and its texts."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from collections.abc import Iterator, Sequence

import numpy as np

from tangible_core.data import PartMap, border_pixels
from tangible_core.drawing import DrawnPicture, Lines, PictureKind, find_marks
from tangible_core.preflight import Verdict, check_bound

from .rules import GRAPHICS, OURS, Profile
from .words.places import describe_part, describe_place, join_texts

MAX_LOST = 0.1  # share of the lines' length that may be lost before the picture is
MAX_CLOSE = 0.3  # share of the lines' length that may lie too near to another line
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
    marks = find_marks(drawing.picture)
    texts = marks.texts
    yield from _judge_lines(drawing, marks.lines, profile, parts, width_m)
    if drawing.whole is not None and parts is not None:
        yield from _judge_parts(drawing.whole, parts, names)
    middles = [((box.left + box.right) / 2, (box.top + box.bottom) / 2) for box in texts.boxes]
    places = list(dict.fromkeys(describe_place(*middle) for middle in middles))
    yield check_bound(
        *("texts", "the letters", float(len(middles)), "<=", 0.0, "parts", OURS),
        says=f"texts are left out ({len(middles)}: {join_texts(places)})" if places else "",
        cure="write them as names of parts, or in the description",
    )  # fmt: skip


def _judge_lines(
    drawing: DrawnPicture, lines: Lines, profile: Profile, parts: PartMap | None, width_m: float
) -> Iterator[Verdict]:
    gap = profile.rules.get("gap")
    gap_m = 0.0032 if gap is None else gap.bound
    pitch_m = width_m / lines.centre.shape[1]
    if drawing.lines:
        close = lines.share_near(gap_m / pitch_m)
        yield check_bound(
            *("close lines", "the lines", close, "<=", MAX_CLOSE, "share", f"{OURS}; for the distance {GRAPHICS}"),
            says="many lines run so close to each other that a finger takes them for one", worse="illegible",
            cure="make the picture larger, or have fewer lines",
        )  # fmt: skip
    elif lines.centre.any():
        share = 1.0 if parts is None else _share_away(lines, parts, gap_m / pitch_m)
        yield check_bound(
            *("kept lines", "the lines", share, "<=", MAX_LOST, "share", OURS),
            says=f"{100 * share:.0f} % of the length of the drawing's lines is left out", worse="illegible",
            cure="`relief: lines` raises them, and a page for swell paper has them",
        )  # fmt: skip


def _share_away(lines: Lines, parts: PartMap, reach: float) -> float:
    """Return the share of the lines' length that is farther than this from a border of parts, in cells of the lines."""
    from scipy.ndimage import distance_transform_edt

    labels, rows = parts.labels, np.nonzero(lines.centre)
    at = [n * new // old for n, new, old in zip(rows, labels.shape, lines.centre.shape, strict=True)]
    border = border_pixels(labels)
    if not border.any():
        return 1.0
    away = np.asarray(distance_transform_edt(~border))[at[0], at[1]]
    return float((away > reach * labels.shape[1] / lines.centre.shape[1]).mean())


def _judge_parts(whole: PartMap, parts: PartMap, names: Sequence[str]) -> Iterator[Verdict]:
    before, after = (np.bincount(part_map.labels.reshape(-1), minlength=whole.count) for part_map in (whole, parts))
    share = before / before.sum()
    absent = np.flatnonzero((share >= NOTICED) & (after[: whole.count] == 0))
    absent = absent[np.argsort(-share[absent])]
    area = float(share[absent].sum())
    texts = [describe_part(number, names) for number in absent.tolist()]
    yield check_bound(
        *("kept parts", "the parts", float(absent.size), "<=", 0.0, "parts", OURS),
        says=f"parts are left out ({join_texts(texts)}; {100 * area:.1f} % of the picture)" if texts else "",
        cure="make the picture larger, or have fewer parts", worse="illegible" if area >= IMPORTANT else "warn",
    )  # fmt: skip
