"""The names of parts, and the checks of the configured parts and scale that need no picture."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress

from ...data import Material
from ...data.part_words import label_of_number, name_part, shown_number
from ...errors import MAX_QUOTED, ConfigError, MaterialError, did_you_mean, quoted
from ...materials.assignment import find, load_library
from ...parts import PartChoice
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ...scene.workspace import MAX_WIDTH_M, MIN_WIDTH_M, kind_of
from .model import PipelineConfig, Wrong

# The tolerance of a sum of lengths, m: far less than can be felt, far more than a rounding error.
ROUNDING_M = 1e-9


def wrong_of_parts(config: PipelineConfig) -> Iterator[Wrong]:
    """Find contradictions among `parts:`, `heights:` and the rules for materials."""
    parts = config.parts or {}
    yield from _wrong_names(parts)
    with suppress(ConfigError):  # a library that cannot be read is its reader's complaint
        yield from _wrong_materials(parts, load_library(config.materials.library))
    yield from _wrong_rules((rule.part for rule in config.materials.rules), parts if config.by_parts else None)
    yield from _wrong_heights(config)


def _wrong_heights(config: PipelineConfig) -> Iterator[Wrong]:
    heights = config.heights
    if heights is None:
        switched_off = config.source is not None and "heights" in config.source.tree
        if not switched_off and (idle := next(iter(config.given_heights_m), None)) is not None:
            yield (
                ("parts", shown_number(idle), "height_m"),
                "without `heights:` no part has a height; write `heights: {by: given}`, or `heights: null` to leave "
                "the heights of parts aside",
            )
    elif kind_of(config.scene) == "heights":
        yield ("heights",), "the scene is a map of heights, which are felt as they are; leave `heights:` out"
    elif config.top_m < -ROUNDING_M:
        least_mm, relief_mm = (
            1e3 * length_m for length_m in (heights.bulge_m + heights.detail_m, config.size.relief_m)
        )
        yield (
            ("heights",),
            f"bulge_m and detail_m are {least_mm:g} mm together, and the whole relief is {relief_mm:g} mm high; make "
            f"them smaller, or workspace.relief_m larger",
        )


def _wrong_names(parts: Mapping[int, PartChoice]) -> Iterator[Wrong]:
    """Find names that cannot be spoken, and names of two parts."""
    first: dict[str, int] = {}
    for number, choice in parts.items():
        wrong = _wrong_name(choice.name)
        other = first.setdefault(choice.name.strip().casefold(), number) if choice.name.strip() else number
        if other != number:
            also = name_part(label_of_number(other))
            wrong = f"{quoted(choice.name)} is the name of {also} as well; give each part a name of its own"
        if wrong:
            yield ("parts", number, "name"), wrong


def _wrong_name(name: str) -> str:
    if name.strip().isdecimal():
        return f"{quoted(name)} would be taken for the number of a part; put a word before it"
    if not name.isprintable():
        return f"{quoted(name)} contains a control character; a name is one line of plain text"
    return f"{quoted(name)} is over {MAX_QUOTED} characters; use fewer" if len(name) > MAX_QUOTED else ""


def _wrong_materials(parts: Mapping[int, PartChoice], library: Mapping[str, Material]) -> Iterator[Wrong]:
    """Find materials of parts that are not in the library."""
    for number, choice in parts.items():
        try:
            if choice.material is not None:
                find(choice.material, library)
        except MaterialError as error:
            yield ("parts", number, "material"), str(error)


def _wrong_rules(rules: Iterable[int | str | None], parts: Mapping[int, PartChoice] | None) -> Iterator[Wrong]:
    """Find rules for parts that have no such name; `parts` is None where nothing is by parts."""
    names = part_numbers(parts or {})
    for number, part in enumerate(rules):
        place = ("materials", "rules", number, "part")
        if part is None:
            continue
        if parts is None:
            yield place, "nothing is by parts; name them under `parts:`, or write `segment:` for a whole segment"
        elif isinstance(part, str) and part.strip() not in names:
            there = f"named are {', '.join(names)}" if names else "`parts:` names none"
            yield place, f"no part is named {quoted(part)}{did_you_mean(part, names)}; {there}"


def part_numbers(parts: Mapping[int, PartChoice]) -> dict[str, int]:
    """Return the numbers of parts by name."""
    return {choice.name.strip(): number for number, choice in parts.items() if choice.name.strip()}


def all_part_names(config: PipelineConfig, count: int) -> tuple[str, ...]:
    """Return a name for each of `count` parts; empty for a part without one."""
    return tuple(config.part_names.get(label, "") for label in range(count))


def wrong_of_scale(config: PipelineConfig) -> Iterator[Wrong]:
    """Find a scale, or a range of heights, that the scene cannot have."""
    workspace, scene = config.workspace, config.scene
    keys = [name for name in ("scale", "low_m", "high_m") if getattr(workspace, name) is not None]
    if not keys:
        return
    place, files = ("workspace", keys[0]), scene.files if isinstance(scene, Scene) else scene
    if kind_of(scene) != "heights":
        yield place, "is for a map of heights, and the scene is not one; leave it out, or name the map with `height:`"
    elif isinstance(files, SceneFiles) and files.invert and keys != ["scale"]:
        yield (("workspace", keys[-1]), "is a height of the file, and `invert` turns these over; leave one of them out")
    elif workspace.times is None:
        return
    elif config.measured is None:
        yield (
            place,
            "the map does not state the size of its cells on the ground; write it under `scene:`, such as `cell_m: 30`",
        )
    elif isinstance(scene, SceneFiles | Scene) and scene.relief_m is not None:
        yield ("scene", "relief_m"), "`workspace: {scale: ...}` already gives the height of the relief; leave it out"
    elif not MIN_WIDTH_M <= config.size.width_m <= MAX_WIDTH_M:
        ground_m = config.measured.width_m
        yield (
            place,
            f"{ground_m:.4g} m on the ground are {config.size.width_m:.3g} m wide at this scale, and a surface is "
            f"{MIN_WIDTH_M:g} to {MAX_WIDTH_M:g} m wide; at 1:{ground_m / 0.1:.0f} it is 0.1 m",
        )
