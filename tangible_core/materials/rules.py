"""Rules that assign materials to segments or parts: a list, of which the first that fits wins."""

import logging
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Literal, Self, get_args

import numpy as np
from jaxtyping import Float, UInt8
from pydantic import AfterValidator, Field, WithJsonSchema, model_validator

from ..data import PartMap, SegmentMap
from ..data.part_words import check_number, label_of_number, missing_number, name_part, shown_number
from ..data.pictures import to_rgb8
from ..data.quantities import Quantities
from ..errors import MaterialError, quoted
from ..runtime.opencv import cv2, plain_opencv

log: logging.Logger = logging.getLogger(__name__)

Colour = Literal["black", "grey", "white", "red", "orange", "brown", "yellow", "green", "blue", "purple", "pink"]
COLOURS: tuple[Colour, ...] = get_args(Colour)

# Bounds in CIELAB (D65): duller colours are grey; darker greys are black and lighter ones white.
GREY_CHROMA, BLACK_L, WHITE_L = 10.0, 20.0, 85.0
HUES: tuple[tuple[float, Colour], ...] = (
    (20, "pink"), (48, "red"), (85, "orange"), (118, "yellow"), (195, "green"), (308, "blue"), (335, "purple"),
    (360, "pink"),
)  # fmt: skip
"""Upper angle of each name, in degrees of CIELAB's hue, between the answers of the XKCD colour survey (2010)."""
BROWN_CHROMA = 52.0
_BITS = 5  # of each channel, by which colours are looked up


def segment_colours(segments: SegmentMap | PartMap, picture: np.ndarray) -> list[tuple[Colour, float]]:
    """Return, for each segment or part, the most frequent of COLOURS and its share. Raises: PictureError."""
    red, green, blue = np.moveaxis(to_rgb8(picture) >> (8 - _BITS), -1, 0).astype(np.uint16)
    names = _names()[(red << 2 * _BITS) | (green << _BITS) | blue]
    pairs = segments.labels.astype(np.intp) * len(COLOURS) + names
    counts = np.bincount(pairs.ravel(), minlength=segments.count * len(COLOURS)).reshape(-1, len(COLOURS))
    best = counts.argmax(axis=1)
    shares = counts[np.arange(len(counts)), best] / np.maximum(counts.sum(axis=1), 1)
    return [(COLOURS[name], float(share)) for name, share in zip(best, shares, strict=True)]


def colour_names(lab: Float[np.ndarray, "n 3"]) -> UInt8[np.ndarray, " n"]:
    """Name colours in CIELAB, by their indices in COLOURS.

    >>> [COLOURS[name] for name in colour_names(np.array([[32.3, 79.2, -107.9], [40.0, 15.0, 30.0]]))]
    ['blue', 'brown']
    """
    lightness, a, b = lab.T
    chroma, hue = np.hypot(a, b), np.degrees(np.arctan2(b, a)) % 360
    ends, by_hue = zip(*HUES, strict=True)
    names = np.array([COLOURS.index(name) for name in by_hue], np.uint8)[np.searchsorted(ends, hue)]
    names[(names == COLOURS.index("orange")) & (chroma < BROWN_CHROMA)] = COLOURS.index("brown")
    dull = chroma < GREY_CHROMA
    names[dull] = COLOURS.index("grey")
    names[dull & (lightness < BLACK_L)] = COLOURS.index("black")
    names[dull & (lightness > WHITE_L)] = COLOURS.index("white")
    return names


@cache
def _names() -> UInt8[np.ndarray, " n"]:
    """Return the name of each cell of the RGB cube, from its middle."""
    steps = (np.arange(1 << _BITS, dtype=np.float32) + 0.5) / (1 << _BITS)
    cube = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(1, -1, 3)
    with plain_opencv():
        return colour_names(cv2.cvtColor(cube, cv2.COLOR_RGB2LAB)[0])


Place = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Number = Annotated[int, AfterValidator(check_number), WithJsonSchema({"type": "integer", "minimum": 1})]
"""The number of a segment or part in a file, from 1."""
Choice = tuple[str, str]


class MaterialRule(Quantities):
    """A material, and the segments or parts that get it, by one of `segment`, `part`, `at` and `colour`."""

    segment: Number | None = None
    """The segment with this number, from 1; all of its parts, if there are parts."""
    part: Number | str | None = None
    """The part with this number, from 1, or of this name under `parts:`."""
    at: tuple[Place, Place] | None = None
    """The segment or part at this pixel of the left picture: [x, y], counted from the upper left corner."""
    colour: Colour | None = None
    """The most frequent colour of a segment or part, by hue, chroma and lightness in CIELAB; all such ones get it."""
    material: str
    """Name of the material for these segments or parts."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        keys = [name for name in ("segment", "part", "at", "colour") if getattr(self, name) is not None]
        if len(keys) != 1:
            raise ValueError(
                f"a rule takes one of segment, part, at and colour; this one has {' and '.join(keys) or 'none'}"
            )
        return self


def map_noun(segments: SegmentMap | PartMap) -> str:
    """Return the noun for one of them."""
    return "part" if isinstance(segments, PartMap) else "segment"


def apply_rules(
    rules: Sequence[MaterialRule],
    segments: SegmentMap | PartMap,
    picture: np.ndarray | None,
    shape: tuple[int, int] | None = None,
) -> Mapping[int, Choice]:
    """Return the choices of the rules for segments or parts; log a rule that fits none. Raises: MaterialError."""
    choices: dict[int, Choice] = {}
    complaints: list[str] = []
    noun = map_noun(segments)
    for number, rule in enumerate(rules, 1):
        try:
            fits = _fits(rule, segments, picture, shape or segments.labels.shape)
        except MaterialError as error:
            complaints.append(f"materials: rule {number}: {error}")
            continue
        if not fits:
            log.warning("materials: rule %d: no %s is %s", number, noun, rule.colour)
        for label, why in fits.items():
            choices.setdefault(
                label, (rule.material, f"{name_part(label, noun=noun)}: rule {number}, {why} -> {rule.material}")
            )
    if complaints:
        raise MaterialError(*complaints)
    return choices


def _fits(
    rule: MaterialRule, segments: SegmentMap | PartMap, picture: np.ndarray | None, shape: tuple[int, ...]
) -> dict[int, str]:
    if rule.segment is not None:
        return _of_segment(label_of_number(rule.segment), segments)
    if rule.part is not None:
        return _part(rule.part, segments)
    if rule.at is not None:
        return {_label_at(*rule.at, segments, shape): f"at [{rule.at[0]:g}, {rule.at[1]:g}]"}
    if picture is None or picture.shape[:2] != segments.labels.shape:
        raise MaterialError("a rule by colour needs the segmented picture, but there is none of that size")
    colours = enumerate(segment_colours(segments, picture))
    return {label: f"{100 * share:.0f} % of it {name}" for label, (name, share) in colours if name == rule.colour}


def segment_parts(segment: int, parts: PartMap) -> list[int]:
    """Return the parts of a segment. Raises: MaterialError if there is no such segment."""
    numbers = [number for number, other in enumerate(parts.segments) if other == segment]
    if not numbers:
        raise MaterialError(missing_number(shown_number(segment), max(parts.segments) + 1, "segment"))
    return numbers


def _of_segment(segment: int, segments: SegmentMap | PartMap) -> dict[int, str]:
    if isinstance(segments, PartMap):
        return dict.fromkeys(segment_parts(segment, segments), f"of {name_part(segment, noun='segment')}")
    if segment >= segments.count:
        raise MaterialError(missing_number(shown_number(segment), segments.count, "segment"))
    return {segment: "named"}


def _part(part: int | str, segments: SegmentMap | PartMap) -> dict[int, str]:
    if not isinstance(segments, PartMap):
        raise MaterialError("a rule by part needs parts, and these are segments; name the segment instead")
    if isinstance(part, str) or part > segments.count:
        raise MaterialError(missing_number(quoted(part), segments.count))
    return {label_of_number(part): "named"}


def _label_at(x: float, y: float, segments: SegmentMap | PartMap, shape: tuple[int, ...]) -> int:
    rows, columns = shape
    row, column = round(y), round(x)
    if row >= rows or column >= columns:
        raise MaterialError(f"[{x:g}, {y:g}] lies outside the picture of {columns} x {rows} pixels")
    inner = segments.labels.shape
    return int(segments.labels[row * inner[0] // rows, column * inner[1] // columns])
