"""Checks of the configured parts against the parts of the picture."""

import logging
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...data import HapticSurface, MaterialMap, PartMap, SegmentMap
from ...data.part_words import missing_number, name_part, shown_number
from ...errors import PictureError
from ...materials.rules import MaterialRule
from ...parts import find_parts, part_sizes
from ...plugins.notes import note
from ..config.model import PipelineConfig, Wrong
from ..config.part_checks import ROUNDING_M, all_part_names, part_numbers

log: logging.Logger = logging.getLogger(__name__)

# The most parts, as many as a label picture may have labels: more are the grain of a photograph.
MAX_PARTS = 4096
# The least size of a part, in pixels and as a share of the picture: smaller ones are slips of the brush.
FEW_PIXELS, FEW_SHARE = 9, 1e-5
MAX_SLIPS = 3  # the most small parts whose places a warning has


@lru_cache(maxsize=1)
def divide_segments(segments: SegmentMap) -> PartMap:
    """Find the parts of segments; the last result is remembered. Raises: PictureError for more than MAX_PARTS."""
    parts = find_parts(segments)
    if parts.count > MAX_PARTS:
        raise PictureError(
            f"the segments fall into {parts.count} parts, and at most {MAX_PARTS} can be felt; paint each part in one "
            "flat colour and save the picture losslessly, as PNG, or choose fewer and smoother segments"
        )
    return parts


def warn_small_parts(parts: PartMap) -> None:
    """Warn about parts of a few pixels. They stay parts, as the numbers of all others would change."""
    sizes = part_sizes(parts)
    small = np.flatnonzero(sizes < max(FEW_PIXELS, FEW_SHARE * parts.labels.size)).tolist()
    if not small:
        return
    texts = [
        f"{name_part(part)} at {place_text(parts, part)} ({_pixels(int(sizes[part]))})" for part in small[:MAX_SLIPS]
    ]
    more = f", and {len(small) - MAX_SLIPS} more" if len(small) > MAX_SLIPS else ""
    few = "one part has few pixels" if len(small) == 1 else f"{len(small)} parts have few pixels"
    cure = "paint over them, or choose smoother segments; the numbers of the parts after them then change"
    note(log, f"{few}: {', '.join(texts)}{more}; {cure}", logging.WARNING)


def _pixels(count: int) -> str:
    return f"{count} pixel{'s' * (count != 1)}"


def place_text(parts: PartMap, number: int, scale: float = 1.0) -> str:
    """Return a pixel in a part, in the middle of its middle row, as text: [x, y]."""
    rows, columns = np.nonzero(parts.labels == number)
    if not rows.size:
        return "no pixel"
    row = rows[rows.size // 2]
    there = columns[rows == row]
    x, y = (int((pixel + 0.5) * scale) for pixel in (there[there.size // 2], row))
    return f"[{x}, {y}]"


def check_parts(config: PipelineConfig, parts: PartMap, columns: int) -> None:
    """Refuse numbers of parts that do not exist, and heights over the workspace."""
    if wrong := [*_wrong_numbers(config, parts.count), *_wrong_heights(config, parts, columns)]:
        raise config.error_at(*wrong)


def check_numbers(config: PipelineConfig, count: int) -> None:
    """Refuse numbers of parts from `count` on. Raises: ConfigError with every complaint."""
    if wrong := list(_wrong_numbers(config, count)):
        raise config.error_at(*wrong)


def _wrong_numbers(config: PipelineConfig, count: int) -> Iterator[Wrong]:
    draws = "(`tangible parts` draws the parts with their numbers)"
    for number in config.parts or {}:
        if number > count:
            yield ("parts", number), f"{missing_number(number, count)} {draws}"
    for index, rule in enumerate(config.materials.rules):
        if isinstance(rule.part, int) and rule.part > count:
            yield ("materials", "rules", index, "part"), f"{missing_number(rule.part, count)} {draws}"


def _wrong_heights(config: PipelineConfig, parts: PartMap, columns: int) -> Iterator[Wrong]:
    if config.heights is None:
        return
    top_m, size, names = config.top_m, config.size, config.part_names
    for label, height_m in config.given_heights_m.items():
        if label < parts.count and height_m > top_m + ROUNDING_M:
            above_m = config.heights.bulge_m + config.heights.detail_m
            place = place_text(parts, label, columns / parts.labels.shape[1])
            yield (
                ("parts", shown_number(label), "height_m"),
                f"{name_part(label, names.get(label, ''))}, at {place} of the picture, is {_mm(height_m)} high, "
                f"and the highest can be {_mm(top_m)}: workspace.relief_m, {_mm(size.relief_m)}, less bulge_m and "
                f"detail_m, {_mm(above_m)}; make it lower, or workspace.relief_m {_mm(height_m + above_m)}",
            )


def _mm(length_m: float) -> str:
    return f"{float(f'{1e3 * length_m:.6g}'):g} mm"


def number_rules(config: PipelineConfig) -> tuple[MaterialRule, ...]:
    """Return the rules for materials with the numbers of parts in place of their names."""
    numbers = part_numbers(config.parts or {})
    return tuple(
        rule.model_copy(update={"part": numbers[rule.part.strip()]}) if isinstance(rule.part, str) else rule
        for rule in config.materials.rules
    )


def own_materials(config: PipelineConfig) -> dict[int, str]:
    """Return the materials of the parts that name one, by label."""
    return {label: part.material for label, part in config.choices.items() if part.material is not None}


def add_names_to_reasons(config: PipelineConfig, materials: MaterialMap) -> MaterialMap:
    """Add the names of parts to the reasons."""
    reasons = list(materials.reasons)
    for number, name in config.part_names.items():
        if number < len(reasons):
            reasons[number] = name_part(number, name) + reasons[number].removeprefix(name_part(number))
    return replace(materials, reasons=tuple(reasons))


def add_names_to_surface(config: PipelineConfig, surface: HapticSurface) -> HapticSurface:
    """Add the names of its parts. Raises: ConfigError for parts that do not exist."""
    count = len(surface.names or ())
    check_numbers(config, count)
    return replace(surface, names=all_part_names(config, count))
