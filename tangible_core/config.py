"""YAML in, a checked configuration out; every complaint at once, each with file:line:column."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar, cast

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from .errors import ConfigError, TangibleError, did_you_mean
from .interfaces import DepthEstimator, ForceRenderer, HapticDevice, Method, Segmenter
from .registry import Registry
from .scene import BUILTINS, SceneFiles, unknown_scene

M = TypeVar("M", bound=Method, covariant=True)

Product = Literal["disparity", "relief", "segments", "materials", "surface", "touch"]
Tree = dict[Any, Any]
"""The parser's own mapping: a dict that knows where its parts stand."""

PRODUCTS: tuple[Product, ...] = ("disparity", "relief", "segments", "materials", "surface", "touch")


class Section(BaseModel):
    """Base of the configuration's own blocks."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class Workspace(Section):
    """The size of what is felt."""

    width_m: Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)] = 0.08
    """Width of the picture under the hand."""
    relief_m: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.02
    """Height of the nearest point above the farthest."""
    smooth_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0
    """Standard deviation of a Gaussian that rounds an estimated relief; a finger feels matching noise as grit."""
    holes: Literal["fill", "cut"] = "fill"
    """Where the depth is unknown: `fill` from the background beside it, or `cut` down to the base plane."""


class MaterialChoice(Section):
    """Which material each segment gets."""

    by: Annotated[
        Annotated[Literal["roughness"], Tag(":word")] | Annotated[dict[int, str], Tag(":labels")],
        Discriminator(lambda value: ":labels" if isinstance(value, dict) else ":word"),
    ] = "roughness"
    """`roughness`: the rougher a segment within this picture, the rougher its material. Or a map from label to name."""
    library: Path | None = None
    """A YAML file of materials of your own, added to those that are shipped."""


@dataclass(frozen=True)
class Chosen(Generic[M]):
    """A method as the configuration names it."""

    name: str
    origin: str
    method: M


@dataclass(frozen=True)
class PipelineConfig:
    """A configuration that was checked."""

    path: Path
    scene: str | SceneFiles
    want: Product = "surface"
    depth: Chosen[DepthEstimator] | None = None
    texture: Chosen[Segmenter] | None = None
    materials: MaterialChoice = field(default_factory=MaterialChoice)
    workspace: Workspace = field(default_factory=Workspace)
    render: Chosen[ForceRenderer] | None = None
    device: Chosen[HapticDevice] | None = None

    def completed(self) -> dict[str, Any]:
        """The configuration with every default filled in, as plain values."""
        plain: dict[str, Any] = {
            "scene": self.scene
            if isinstance(self.scene, str)
            else self.scene.model_dump(mode="json", exclude_none=True),
            "want": self.want,
            "workspace": self.workspace.model_dump(mode="json"),
            "materials": self.materials.model_dump(mode="json", exclude_none=True),
        }
        for kind in STAGES:
            if (chosen := getattr(self, kind)) is not None:
                plain[kind] = {"use": chosen.name, **chosen.method.model_dump(mode="json")}
        return plain


STAGES = ("depth", "texture", "render", "device")
SECTIONS: dict[str, type[BaseModel]] = {"workspace": Workspace, "materials": MaterialChoice}
KEYS = ("scene", "want", *STAGES, *SECTIONS)


def load_config(path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """Read and check a pipeline file.

    overrides: `key.key=value` each, the value in YAML, as `--set` takes them; another method (`depth.use=...`)
    starts with its own defaults.
    Raises: ConfigError with every complaint, one a line.
    """
    return parse_config(_read_text(path), path, registry, overrides)


def parse_config(text: str, path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """`load_config` for a text; `path` is what complaints name and what relative files are relative to."""
    source = Source(path, _parse(text, path))
    for override in overrides:
        source.override(override)
    values = source.check(registry)
    if source.complaints:
        raise ConfigError("\n".join(source.complaints))
    return PipelineConfig(path=path, **values)


def _read_text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        near = did_you_mean(path.name, (each.name for each in path.parent.glob("*.y*ml")))
        raise ConfigError(f"{path}: there is no such file{near}") from error
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read as text: {error}") from error


def _parse(text: str, path: Path) -> Tree:
    try:
        tree = _load(text)
    except MarkedYAMLError as error:
        mark: Any = cast(Any, error).problem_mark or cast(Any, error).context_mark
        place = f"{path}:{mark.line + 1}:{mark.column + 1}" if mark else f"{path}"
        problem = str(cast(Any, error).problem or cast(Any, error).context).strip().splitlines()[0]
        cure = "; indent with spaces, not tabs" if "\\t" in problem else ""
        raise ConfigError(f"{place}: {problem}{cure}") from error
    except YAMLError as error:
        raise ConfigError(f"{path}: {str(error).splitlines()[0]}") from error
    if not isinstance(tree, dict):
        raise ConfigError(f"{path}:1:1: a configuration is a mapping that starts with `scene:`")
    return cast(Tree, tree)


@dataclass
class Source:
    """A parsed file while it is being checked: it knows where everything stands, and collects complaints."""

    path: Path
    tree: Tree
    complaints: list[str] = field(default_factory=list[str])
    overridden: dict[tuple[str, ...], str] = field(default_factory=dict[tuple[str, ...], str])

    def override(self, text: str) -> None:
        """Apply `key.key=value`."""
        keys, equals, value = text.partition("=")
        parts = tuple(keys.strip().split("."))
        if not equals or not all(parts):
            raise ConfigError(f"--set {text}: write key.key=value, such as render.stiffness_n_per_m=500")
        node: Any = self.tree
        for part in parts[:-1]:
            if not isinstance(node.get(part), dict):
                node[part] = CommentedMap()
            node = node[part]
        try:
            loaded = _load(value)
        except YAMLError as error:
            raise ConfigError(f"--set {text}: {value!r} is no YAML value") from error
        if parts[-1] == "use" and node.get("use") != loaded:
            node.clear()  # another method has other options
        node[_key(parts[-1], node)] = loaded
        self.overridden[parts] = text

    def place(self, location: tuple[Any, ...]) -> str:
        """file:line:column of the deepest part of the location that the file has."""
        for end in range(len(location), 0, -1):
            if text := self.overridden.get(tuple(str(part) for part in location[:end])):
                return f"--set {text}"
        node: Any = self.tree
        line, column = 0, 0
        for part in location:
            if not isinstance(node, dict | list) or not _has(node, part):
                continue
            marks = cast(Any, node).lc
            if marks.data and part in marks.data:
                line, column = marks.key(part) if isinstance(node, dict) else marks.item(part)
            node = cast(Any, node)[part]
        return f"{self.path}:{line + 1}:{column + 1}"

    def complain(self, location: tuple[Any, ...], text: str) -> None:
        """Note a complaint with its place."""
        self.complaints.append(f"{self.place(location)}: {text}")

    def check(self, registry: Registry) -> dict[str, Any]:
        """Fields of PipelineConfig, as far as they are right; the rest is in `complaints`."""
        for key in self.tree:
            if key not in KEYS:
                self.complain((key,), f"unknown key {key!r}{did_you_mean(str(key), KEYS)}; known: {', '.join(KEYS)}")
        values: dict[str, Any] = {"scene": self._scene(), "want": self._want()}
        for key, model in SECTIONS.items():
            if key in self.tree:
                block = self.tree[key]
                by_label = key == "materials" and isinstance(block, dict) and _has_label(cast(Any, block))
                values[key] = self._model((key,), model, {"by": block} if by_label else block)
        for kind in STAGES:
            if kind in self.tree:
                values[kind] = self._stage(kind, registry)
        return values

    def _scene(self) -> Any:
        if "scene" not in self.tree:
            return self.complain(
                (), "`scene:` is missing; name a builtin (builtin/motorcycle) or files {left:, right:}"
            )
        block = self.tree["scene"]
        if not isinstance(block, str):
            return self._model(("scene",), SceneFiles, block)
        if block not in BUILTINS:
            self.complain(("scene",), unknown_scene(block))
        return block

    def _want(self) -> Any:
        want = self.tree.get("want", "surface")
        if want not in PRODUCTS:
            hint = did_you_mean(str(want), PRODUCTS)
            self.complain(("want",), f"nothing makes {want!r}{hint}; a pipeline makes {', '.join(PRODUCTS)}")
        return want

    def _stage(self, kind: str, registry: Registry) -> Chosen[Any] | None:
        block = self.tree[kind]
        if isinstance(block, str):
            block = {"use": block}
        if not isinstance(block, dict) or not isinstance(cast(Any, block).get("use"), str):
            known = ", ".join(registry.names(kind))
            return self.complain((kind,), f"{kind} needs the name of a method, {{use: ...}}; installed: {known}")
        options = dict(cast("dict[str, Any]", block))
        name = options.pop("use")
        try:
            listing, cls = registry.find(kind, name), registry.load(kind, name)
        except TangibleError as error:
            return self.complain((kind, "use"), str(error))
        method = self._model((kind,), cls, options)
        return None if method is None else Chosen(name, listing.origin, method)

    def _model(self, location: tuple[Any, ...], model: type[BaseModel], block: Any) -> Any:
        try:
            return _relative_to(self.path.parent, model.model_validate(_plain(block)))
        except ValidationError as error:
            for each in error.errors():
                self._complain_of(location, model, cast(Any, each))
            return None

    def _complain_of(self, location: tuple[Any, ...], model: type[BaseModel], error: Mapping[str, Any]) -> None:
        where = (*location, *(part for part in error["loc"] if part != "[key]" and not str(part).startswith(":")))
        shown = ".".join(str(part) for part in where)
        if error["type"] == "extra_forbidden":
            options = list(model.model_fields)
            known = f"; known: {', '.join(options)}" if options else "; there are no options"
            self.complain(where, f"{shown}: unknown option{did_you_mean(str(where[-1]), options)}{known}")
        else:
            given = "" if isinstance(error["input"], dict) else f", not {error['input']!r}"
            self.complain(where, f"{shown}: {error['msg'].removeprefix('Value error, ')}{given}")


def _load(text: str) -> Any:
    return cast(Any, YAML(typ="rt")).load(text)


def _key(text: str, node: Mapping[Any, Any]) -> Any:
    """Keys are words; labels of a material map are whole numbers."""
    return int(text) if text.isdigit() and text not in node else text


def _relative_to(folder: Path, model: BaseModel) -> BaseModel:
    """Files that a block names are relative to the file that names them."""
    paths = {name: value for name, value in model if isinstance(value, Path) and not value.is_absolute()}
    return (
        model.model_copy(update={name: (folder / value).absolute() for name, value in paths.items()})
        if paths
        else model
    )


def _has(node: Any, part: Any) -> bool:
    return part in node if isinstance(node, dict) else isinstance(part, int) and part < len(node)


def _has_label(block: Mapping[Any, Any]) -> bool:
    return any(isinstance(key, int) for key in block)


def _plain(node: Any) -> Any:
    """Plain Python values for pydantic, without the parser's own types."""
    if isinstance(node, dict):
        return {key: _plain(value) for key, value in cast("dict[Any, Any]", node).items()}
    if isinstance(node, list):
        return [_plain(value) for value in cast("list[Any]", node)]
    for kind in (bool, int, float, str):
        if isinstance(node, kind):
            return kind(node)
    return node
