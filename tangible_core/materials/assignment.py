"""The library of materials, and the assignment of materials to segments."""

from collections.abc import Collection, Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float64

from ..data import Material, MaterialMap, PartMap, SegmentMap
from ..data.part_words import label_of_number, missing_number, name_part, shown_number
from ..data.pictures import to_grey
from ..errors import MaterialError, did_you_mean, quoted
from ..runtime.opencv import cv2, plain_opencv
from .files import parse_materials, read_materials
from .rules import Choice, MaterialRule, apply_rules, map_noun, segment_parts

NEUTRAL = "plain"

LADDER = ("ice", "metal", "paper", "leather", "wood", "cloth", "sand", "stone", "brick")


def load_library(path: Path | None = None) -> Mapping[str, Material]:
    """Load materials by name: the shipped ones, and those of a YAML file, which changes some. Raises: ConfigError."""
    return library() if path is None else read_materials(path, library())


@cache
def library() -> Mapping[str, Material]:
    """Return the shipped materials by name."""
    text = files("tangible_core.materials").joinpath("materials.yaml").read_text(encoding="utf-8")
    return parse_materials(text, Path("materials.yaml"), {})


def find(name: str, library: Mapping[str, Material]) -> Material:
    """Return the material of this name. Raises: MaterialError with the known names."""
    if name not in library:
        raise MaterialError(
            f"no material is named {quoted(name)}{did_you_mean(str(name), library)}; there are {', '.join(library)}"
        )
    return library[name]


def assign(
    segments: SegmentMap | PartMap,
    picture: np.ndarray | None,
    by: Literal["roughness", "rules"] | Mapping[int, str],
    library: Mapping[str, Material],
    rules: Sequence[MaterialRule] = (),
    default: str = NEUTRAL,
    shape: tuple[int, int] | None = None,
    ground: Collection[int] = (),
    own: Mapping[int, str] | None = None,
) -> MaterialMap:
    """Assign a material, with a reason, to each segment or part; the default where nothing decides.

    `own` decides first, by label; then `rules`, the first that fits; then `by`: a map from a segment's number, from 1,
    or `roughness`, which ranks the rest by `relative_roughness` evenly over `LADDER`; equal ones share a rank.
    shape: see `apply_rules`. ground: transparent segments, which get the default. Raises: MaterialError, PictureError.
    """
    noun = map_noun(segments)
    picks = {label: (name, f"{name_part(label, noun=noun)}: its own -> {name}") for label, name in (own or {}).items()}
    picks = {**apply_rules(rules, segments, picture, shape), **picks}
    if isinstance(by, Mapping):
        picks = {**_by_name(segments, by, library), **picks}
    elif by == "roughness" and len(picks) < segments.count:
        roughness = {label: value for label, value in enumerate(_roughness(segments, picture)) if label not in ground}
        picks = {**_by_roughness(roughness, default, noun), **picks}
    for label in ground:
        picks.setdefault(label, (default, f"{name_part(label, noun=noun)}: transparent in the picture -> {default}"))
    rest = ((default, f"{name_part(label, noun=noun)}: not named -> {default}") for label in range(segments.count))
    names, reasons = zip(*(picks.get(label, choice) for label, choice in enumerate(rest)), strict=True)
    return MaterialMap(tuple(find(name, library) for name in names), reasons)


def _roughness(segments: SegmentMap | PartMap, picture: np.ndarray | None) -> Float64[np.ndarray, "n"]:
    if picture is None or picture.shape[:2] != segments.labels.shape:
        actual = "there is none" if picture is None else f"it is {picture.shape[:2]}"
        raise MaterialError(
            f"materials by roughness need the picture of the segments, {segments.labels.shape}, and {actual}; "
            "name the materials instead, such as {1: ice, 2: sand}"
        )
    return relative_roughness(segments, picture)


def relative_roughness(segments: SegmentMap | PartMap, picture: np.ndarray) -> Float64[np.ndarray, "n"]:
    """Measure how rough each segment looks within this picture; independent of brightness and contrast."""
    grey = to_grey(picture).astype(np.float64)
    spread = float(grey.std())
    if spread <= 1e-6 * float(np.abs(grey).max()):  # rounding errors of a single colour
        return np.zeros(segments.count)
    grey = (grey - grey.mean()) / spread
    side = max(3, min(grey.shape) // 64 | 1)
    local = np.sqrt(np.maximum(_local_mean(grey * grey, side) - _local_mean(grey, side) ** 2, 0))
    # The median of the local standard deviation of grey, as a share of that of the whole picture.
    order = np.argsort(segments.labels, axis=None, kind="stable")
    ends = np.cumsum(np.bincount(segments.labels.ravel(), minlength=segments.count))
    return np.round([np.median(part) if part.size else 0.0 for part in np.split(local.ravel()[order], ends[:-1])], 3)


def _local_mean(values: Float64[np.ndarray, "h w"], side: int) -> Float64[np.ndarray, "h w"]:
    with plain_opencv():
        mean: Any = cv2.blur(values, (side, side), borderType=cv2.BORDER_REFLECT)
    return mean


def _by_name(
    segments: SegmentMap | PartMap, names: Mapping[int, str], library: Mapping[str, Material]
) -> dict[int, Choice]:
    complaints: list[str] = []
    count = max(segments.segments) + 1 if isinstance(segments, PartMap) else segments.count
    names = {label_of_number(number): name for number, name in names.items()}
    for label, name in names.items():
        if label not in range(count):
            complaints.append(missing_number(shown_number(label), count, "segment"))
        try:
            find(name, library)
        except MaterialError as error:
            complaints.append(f"{name_part(label, noun='segment')}: {error}")
    if complaints:
        raise MaterialError(*complaints)
    if isinstance(segments, PartMap):
        return {
            part: (name, f"{name_part(part)}: {name_part(label, noun='segment')}, named {name}")
            for label, name in names.items()
            for part in segment_parts(label, segments)
        }
    return {label: (name, f"{name_part(label, noun='segment')}: named {name}") for label, name in names.items()}


def _by_roughness(roughness: Mapping[int, float], default: str, noun: str) -> dict[int, Choice]:
    levels, ranks = np.unique(list(roughness.values()), return_inverse=True)
    last = len(levels) - 1
    choices: dict[int, Choice] = {}
    for (label, value), rank in zip(roughness.items(), ranks, strict=True):
        name = LADDER[round(int(rank) * (len(LADDER) - 1) / last)] if last else default
        choices[label] = (
            name,
            f"{name_part(label, noun=noun)}: number {rank + 1} of {last + 1} from smooth to rough "
            f"({value:.3f}) -> {name}",
        )
    return choices
