"""Pipeline files and arguments in Python, read and checked into a configuration."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, cast

from ruamel.yaml.comments import CommentedSeq

from ...errors import ArgumentError, PictureError, did_you_mean, wrong_argument
from ...files.yaml.source import Location, Source, parse_override, parse_source, read_text
from ...plugins.registry import Registry
from ...scene.framing import measured_size
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from .keys import MethodList, Reading
from .keys.kinds import find_or_add
from .model import KEYS, PipelineConfig, without_places
from .part_checks import wrong_of_parts, wrong_of_scale

EXPECTED = "a configuration is a mapping that starts with `scene:`"


def load_config(path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """Read and check a pipeline file.

    overrides: `key.key=value` each, the value in YAML, as `--set` takes them; another method (`depth.use=...`)
    starts with its own defaults. `export.NAME.key=value` is of the exporter of that name, which is listed if it is not
    yet.
    Raises: ConfigError with every complaint, one a line.
    """
    return parse_config(read_text(path), path, registry, overrides)


def parse_config(text: str, path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """Read and check a text as `load_config` does; complaints name `path`, and relative files are relative to it."""
    source = parse_source(text, path, EXPECTED)
    for override in overrides:
        _override(source, override)
    source.check_keys(KEYS)
    reading, values = Reading(source, registry), dict[str, Any]()
    for name, key in KEYS.items():
        if name in source.tree:
            values[name] = key.read(reading, source.tree[name])
        elif key.missing:
            source.complain((), key.missing)
    values["measured"] = _size_of_heights(source, values.get("scene"))
    values = _with_want({name: value for name, value in values.items() if value is not None})
    if "scene" in values:
        config = PipelineConfig(path=path, source=source, **values)
        of_scale = () if source.complaints else wrong_of_scale(config)
        for location, wrong in (*wrong_of_parts(config), *of_scale):
            source.complain(location, f"{'.'.join(map(str, location))}: {wrong}")
    source.settle()
    return PipelineConfig(path=path, source=source, **values)


def make_config(
    scene: Scene | None, registry: Registry, /, before: PipelineConfig | None = None, **arguments: Any
) -> PipelineConfig:
    """Check arguments in Python, by the names of keys, into a configuration; `before` has the keys that stay."""
    if not (isinstance(scene, Scene) or (scene is None and before)):
        raise wrong_argument("scene", scene, "a Scene, such as Scene.photo(...) makes")
    source = Source(Path(), {})
    reading = Reading(source, registry)
    if unknown := next((name for name in arguments if name not in KEYS), None):
        raise ArgumentError(f"{unknown}: is not a key of the pipeline file{did_you_mean(unknown, KEYS)}")
    changes = {name: KEYS[name].take(reading, argument) for name, argument in arguments.items() if argument is not None}
    if source.complaints:
        raise without_places(source)
    scene_values = {} if scene is None else {"scene": scene, "measured": scene.measured}
    if before is None:
        config = PipelineConfig(**scene_values, **_with_want(changes))
    else:
        unset = {name: PipelineConfig.model_fields[name].get_default() for name in arguments if name not in changes}
        values = {"render": before.render, **unset, **changes, **scene_values}
        if _with_want({"render": before.render})["want"] == before.want:
            values = _with_want(values)
        config = before.with_values(**values, source=None)
    if wrong := [*wrong_of_parts(config), *wrong_of_scale(config)]:
        raise config.error_at(*wrong)
    return config


def _with_want(values: dict[str, Any]) -> dict[str, Any]:
    """Return the values of keys with the product that they ask for, where they do not name it."""
    return {"want": "surface" if values.get("render") is None else "touch", **values}


def shorthand(place: Location) -> str:
    """Return the option that a word alone stands for at this place of a file: a method's name, or a part's."""
    key = KEYS.get(place[0]) if place else None
    return key.word_option(len(place)) if key else ""


def _override(source: Source, text: str) -> None:
    """Apply `key.key=value`, in which the name of a listed method stands for its place in the list."""
    parts, _ = parse_override(text)
    place: Location = ()
    if isinstance(KEYS.get(parts[0]), MethodList) and len(parts) > 1:
        entries = source.tree.setdefault(parts[0], CommentedSeq())
        if isinstance(entries, list) and len(parts) > 2:
            before = len(cast("list[Any]", entries))
            index = find_or_add(cast("list[Any]", entries), parts[1])
            place = (parts[0], index, *parts[2:])
            if index == before:  # the override names a method that the file does not list
                source.overridden[parts[0], str(index)] = text
    source.override(text, shorthand, place)


def _size_of_heights(source: Source, scene: Any) -> Any:
    try:
        return measured_size(scene) if isinstance(scene, SceneFiles) else None
    except PictureError as error:
        return source.complain(("scene", "height"), str(error))
