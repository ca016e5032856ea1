"""A commented pipeline file for pictures, with values that suit these pictures."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from math import floor
from os import PathLike
from pathlib import Path
from string import Template
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float32

from ..data.part_words import shown_number
from ..data.pictures import to_grey
from ..drawing import PictureKind, kind_sentence
from ..errors import MAX_QUOTED, ConfigError
from ..files.paths import as_path, plain_line
from ..files.yaml.editing import on_one_line
from ..files.yaml.source import plain_tree
from ..parts import find_parts
from ..plugins.interfaces import DepthEstimator
from ..plugins.registry import Registry, default_registry
from ..runtime.opencv import cv2, plain_opencv
from ..scene.formats.height_maps import read_heights_metadata
from ..scene.formats.kinds import file_kind
from ..scene.formats.pairs import holds_two_views
from ..scene.formats.rigs import find_rig
from ..scene.scene import Scene
from ..scene.scene_files import SceneFiles
from .config.model import PipelineConfig
from .config.parsing import make_config, parse_config
from .engine.hooked import networks_identity
from .part_names import read_labels

SIDE_MM = 80
"""The longer side of the surface, mm: the reach of a small desktop device."""
TEXTURES: Mapping[bool, str] = {
    False: "texture: {use: hierarchy, segments: 12} # hierarchy: regions such as people would draw; segments: the "
    "most, or auto\nmaterials: {by: roughness}         # roughness: the rougher a part looks, the rougher it feels; or "
    "{1: ice, 2: sand, ...}",
    True: "texture: {use: flat}               # flat: each area of one colour\n"
    "materials: {by: rules}             # rules: one plain material; or {1: ice, 2: sand, ...}",
}
"""Lines for the segments of one picture and their materials, by whether it is a drawing."""
SMOOTH_MM: Mapping[str, float] = {"photo": 1.5, "heights": 0.0}
"""The smoothing of a relief of brightness, and of a map of heights, mm."""
PHOTOS: Mapping[str, str] = {
    "edges": "relief: edges                      # edges: raised lines, on low steps from dark to light; disparity: "
    "lighter is higher",
    "figure": "relief: figure                     # figure: what networks see stands out; edges: raised lines alone",
    "lines": "relief: lines                      # lines: raised, areas of one colour as steps below them; "
    "edges: raised edges",
    "depth": "relief: {slope: 1.1}               # slope: nowhere steeper; less is gentler, 0 keeps cliffs",
    "brightness": "  relief_m: $relief_mm mm            # from the lowest point to the highest; more is steeper\n"
    "  smooth_m: $smooth_mm mm            # less keeps finer detail, and makes steeper edges",
}
"""Lines for one picture: felt by its edges, what networks see, its depth or its brightness; each comment stays true
when values change."""
STEEPEST = 0.6
"""The slope that at most a twentieth of the relief exceeds: from 1 on, 45 degrees, the sideways force is larger than
the force down."""
MIN_MM = 2.0
# The greatest height of the relief by kind of scene, mm; less for photos, as their brightness is not a depth.
MAX_MM: Mapping[str, float] = {"photo": 8.0, "heights": 15.0}
READ = "as read in the picture; correct what is wrong"
CELLS = 400  # the cells along the longer side, at which slopes are measured

Kind = Literal["photo", "pair", "heights"]


def are_pictures(paths: Iterable[Path]) -> bool:
    """Return True for pictures, videos, maps and builtin scenes, which are not pipeline files."""
    return all(
        _is_builtin(path) or file_kind(path) is not None or read_heights_metadata(path) is not None for path in paths
    )


def not_pictures(paths: Iterable[Path]) -> ConfigError:
    """Return the error for files that a surface cannot be made of, such as a PDF."""
    names = ", ".join(map(str, paths))
    return ConfigError(
        f"{names}: name a picture (.png, .jpg, ...), left and right, a video, or a map of heights (.npy); "
        "save other documents as PDF or PNG first"
    )


class Starter(NamedTuple):
    """The text of a pipeline file, and its scene, which is read already."""

    text: str
    scene: Scene


def starter(pictures: Sequence[Path], file: Path) -> Starter:
    """Write a pipeline file for one picture, a pair, a map of heights, a video, or a builtin scene, to be at `file`."""
    if not 0 < len(pictures) <= 2:
        raise ConfigError(
            f"{len(pictures)} pictures: name one, or left and right; `tangible batch` takes many, each on its own"
        )
    parts = _parts(pictures)
    absolute = {part: path.absolute() for part, path in parts.items()}
    scene = Scene.read(SceneFiles.model_validate(absolute), Path()) if parts else Scene.builtin(str(pictures[0]))
    if "right" in parts and (rig := find_rig(absolute["left"], absolute["right"], scene.shape)):
        parts, absolute = {**parts, "rig": rig}, {**absolute, "rig": rig}
        scene = Scene.read(SceneFiles.model_validate(absolute), Path())
    block = ", ".join(f"{part}: {_path_in_yaml(path, file.parent)}" for part, path in parts.items())
    values = {
        "scene": f"{{{block}}}" if parts else scene.name,
        "name": " and ".join(plain_line(path.name) for path in pictures),
    }
    if scene.frames is not None:
        values["name"] += ", its first frame"
        values["scene"] += "   # with layout: side-by-side, if each frame holds the two views of a pair"
    return Starter(_text(scene, values), scene)


def _text(scene: Scene, values: Mapping[str, str]) -> str:
    """Return the text for a scene. values: those of the template that do not depend on what the scene shows."""
    kind: Kind = "heights" if scene.views is None else "pair" if scene.views.right is not None else "photo"
    template = "measured" if scene.own_size else kind
    text = files("tangible_core.pipeline").joinpath(f"starter_{template}.yaml").read_text(encoding="utf-8")
    return Template(text).substitute(values, **_size(scene, kind))


def _settings(text: str) -> dict[str, Any]:
    """Return the values of a pipeline file but its scene."""
    return {name: value for name, value in plain_tree(text, Path()).items() if name != "scene"}


def suited_config(pictures: Sequence[Any], registry: Registry, overrides: Sequence[str] = ()) -> PipelineConfig:
    """Make the configuration of a starter for files, arrays or one scene, without writing it."""
    if len(pictures) in (1, 2) and not all(isinstance(picture, str | PathLike) for picture in pictures):
        of_arrays = Scene.photo if len(pictures) == 1 else Scene.pair
        scene = pictures[0] if isinstance(pictures[0], Scene) else of_arrays(*pictures)
        text = _text(scene, {"scene": scene.name, "name": ""})
        return make_config(scene, registry, **_settings(text))
    files = [as_path(picture, "picture") for picture in pictures]
    file = files[0] if files else Path()
    text, scene = starter(files, file)
    try:
        config = parse_config(text, file, registry, overrides)
    except ConfigError as error:  # the text is not in the picture, which has no lines
        sentences = re.sub(rf"^{re.escape(str(file))}:\d+:\d+: ", f"{file}: ", str(error), flags=re.MULTILINE)
        raise ConfigError(*sentences.splitlines(), complaints=error.complaints) from error
    if not any(override.lstrip().startswith("scene") for override in overrides):
        config = config.with_values(scene=scene)  # it need not be read again
    return config


def _is_builtin(path: Path) -> bool:
    return path.parts[:1] == ("builtin",) and not path.suffix and not path.exists()


def _parts(pictures: Sequence[Path]) -> Mapping[str, Any]:
    """Return the pictures by their keys in `scene:`; none for a builtin scene. Raises: ConfigError."""
    if len(pictures) == 1:
        (path,) = pictures
        return {} if _is_builtin(path) else {scene_key(path): path}
    if odd := next((path for path in pictures if _is_builtin(path) or scene_key(path) != "photo"), None):
        raise ConfigError(f"{odd}: left and right are two pictures; name this one alone")
    return dict(zip(("left", "right"), pictures, strict=True))


def scene_key(path: Path) -> str:
    """Return the key in `scene:` of a file that is given alone."""
    suffix = path.suffix.lower()
    if suffix == ".jps" or (suffix == ".mpo" and holds_two_views(path)):
        return "stereo"
    kind = file_kind(path)
    if kind == "heights" or read_heights_metadata(path) is not None:
        return "height"
    return "video" if kind == "video" else "photo"


def _size(scene: Scene, kind: Kind) -> dict[str, object]:
    """Choose a size that fits the device, and a height at which few slopes are too steep; return them as texts."""
    shades = scene.height if scene.views is None else to_grey(scene.views.left)
    assert shades is not None
    rows, columns = shades.shape
    width, length = scene.measured[:2] if scene.measured else (columns, rows)
    longer = max(width, length)
    size: dict[str, object] = {"columns": columns, "rows": rows}
    size |= {"width_mm": f"{SIDE_MM * width / longer:.3g}", "length_mm": f"{SIDE_MM * length / longer:.3g}"}
    if kind == "pair":
        return size
    if scene.own_size:
        lengths_m = zip(("width_mm", "length_mm", "relief_mm"), scene.own_size, strict=True)
        return size | {name: f"{1e3 * length_m:.3g}" for name, length_m in lengths_m}
    slope = _slope(shades, SMOOTH_MM[kind])
    least, most = MIN_MM, MAX_MM[kind]
    relief_mm = max(least, min(most, floor(2 * STEEPEST / slope) / 2)) if slope > 0 else most
    size |= {"relief_mm": f"{relief_mm:g}", "smooth_mm": f"{SMOOTH_MM[kind]:g}"}
    if kind == "photo":
        size["texture"] = TEXTURES[_is_drawing(scene)]
        size["kind"] = f"   # {kind_sentence(scene.kind)}" if _is_drawing(scene) else ""
        size["named"] = _names_text(scene, f"{size['width_mm']} mm")
        size["relief"] = Template(PHOTOS[_choose_photo_relief(scene)]).substitute(size)
    return size


def _names_text(scene: Scene, width: str) -> str:
    """Return the lines with the title and the names of the parts, stated or read in the picture; "" without any."""
    title, lines = scene.title, ""
    if scene.segments is not None and any(scene.segment_names):
        parts = find_parts(scene.segments).segments
        names = {label: scene.segment_names[segment] for label, segment in enumerate(parts)}
        lines = _part_lines(names, "as the drawing names them")
    elif not scene.segment_names and _is_drawing(scene):
        registry = default_registry()
        config = make_config(scene, registry, texture="flat", workspace={"width_m": width})
        title_read, names = read_labels(config, registry)
        title, lines = title or title_read, _part_lines(names, READ)
    return (f"title: {on_one_line(plain_line(title))}\n" if title else "") + lines


def _part_lines(names: Mapping[int, str], comment: str) -> str:
    """Return the lines with the names of parts by label; "" without any.

    No two parts have one name: the second one of a name is followed by 2.
    """
    lines, numbers = list[str](), Counter[str]()
    for label, given in names.items():
        name = plain_line(given)[: MAX_QUOTED - 5].strip()
        if name and not name.isdecimal():  # a number would be taken for that of a part
            numbers[name.casefold()] += 1
            again = numbers[name.casefold()]
            text = on_one_line(f"{name} {again}" if again > 1 else name)
            lines.append(f"  {shown_number(label)}: {text}\n")
    return f"parts:                             # {comment}\n{''.join(lines)}" if lines else ""


def _is_drawing(scene: Scene) -> bool:
    return scene.kind.likely != PictureKind.photograph


def _choose_photo_relief(scene: Scene) -> str:
    """Return the key of PHOTOS for one picture: a drawing's lines, what networks find, or edges; light if it moves."""
    if _is_drawing(scene):
        return "lines"
    registry = default_registry()
    method = registry.load("depth", "auto")()
    if isinstance(method, DepthEstimator) and method.finds_depth:
        return "depth"
    if scene.frames is None and networks_identity(registry):
        return "figure"
    return "edges" if scene.frames is None else "brightness"


def _slope(values: Float32[np.ndarray, "h w"], smooth_mm: float) -> float:
    """Return the slope that the steepest twentieth of a relief of 1 mm exceeds."""
    longer = max(values.shape)
    scale = min(1.0, CELLS / longer)
    rows, columns = (max(1, round(side * scale)) for side in values.shape)
    finite = np.isfinite(values)
    if not finite.any():
        return 0.0
    heights = np.where(finite, values, values[finite].min())
    with plain_opencv():
        small = cv2.resize(heights, (columns, rows), interpolation=cv2.INTER_AREA).astype(np.float64)
        if sigma := smooth_mm / SIDE_MM * longer * scale:
            small = cv2.GaussianBlur(small, (0, 0), sigma)
    span = np.ptp(heights)
    if min(small.shape) < 2 or not span > 0:
        return 0.0
    steep = np.hypot(*np.gradient(small / span)) * longer * scale / SIDE_MM
    return float(np.percentile(steep, 95))


def _path_in_yaml(path: Path, folder: Path) -> str:
    """Write a path relative to this folder if it is inside, in quotes where YAML needs them."""
    here = path.absolute()
    text = here.relative_to(folder.absolute()).as_posix() if here.is_relative_to(folder.absolute()) else here.as_posix()
    return on_one_line(text)
