"""The pipeline file: what it may say, and what it says once it was checked."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar, cast

from pydantic import BaseModel, Discriminator, Tag
from ruamel.yaml import YAML

from ..errors import ConfigError, MaterialError, TangibleError, did_you_mean, quoted
from ..files.source import Location, Source, parse_source, read_text
from ..mapping import WorkspaceMapping, mapped
from ..materials.assignment import NEUTRAL, find, load_library
from ..materials.rules import MaterialRule
from ..plugins.interfaces import DepthEstimator, ForceRenderer, HapticDevice, Method, Segmenter
from ..plugins.registry import Registry
from ..scene.scene import Scene
from ..scene.scene_files import BUILTINS, SceneFiles, unknown_scene
from ..scene.workspace import FeltSize, Section, Workspace, kind_of
from ..servo.guard.safety import Safety

M = TypeVar("M", bound=Method, covariant=True)

Product = Literal["disparity", "relief", "segments", "materials", "surface", "touch"]
PRODUCTS: tuple[Product, ...] = ("disparity", "relief", "segments", "materials", "surface", "touch")


class MaterialChoice(Section):
    """Which material each segment gets."""

    rules: tuple[MaterialRule, ...] = ()
    """Rules, which decide first; of several that fit a segment, the first one wins."""
    by: Annotated[
        Annotated[Literal["roughness", "rules"], Tag(":word")] | Annotated[dict[int, str], Tag(":labels")],
        Discriminator(lambda value: ":labels" if isinstance(value, dict) else ":word"),
    ] = "roughness"
    """How segments without a rule get a material. `roughness`: by rank, the roughest segment of the picture gets the
    roughest material. A map: from label to material. `rules`: not at all, they get `default`."""
    default: str = NEUTRAL
    """Material of the segments that are left."""
    library: Path | None = None
    """A YAML file with materials of your own, in addition to the built-in ones."""
    fit: Literal["device", "never"] = "device"
    """`device`: what the device cannot hold of a material's stiffness, texture or damping is taken off that material,
    and the outcome of the touch says so. `never`: materials stay as they are, and the guard softens the whole law."""


@dataclass(frozen=True)
class NamedMethod(Generic[M]):
    """A method as the configuration names it."""

    name: str
    origin: str
    method: M


@dataclass(frozen=True)
class PipelineConfig:
    """A configuration that was checked."""

    scene: str | SceneFiles | Scene
    path: Path | None = None
    """The file that it stands in; None for one that was made in Python."""
    want: Product = "surface"
    depth: NamedMethod[DepthEstimator] | None = None
    texture: NamedMethod[Segmenter] | None = None
    materials: MaterialChoice = field(default_factory=MaterialChoice)
    workspace: Workspace = field(default_factory=Workspace)
    mapping: WorkspaceMapping = field(default_factory=WorkspaceMapping)
    render: NamedMethod[ForceRenderer] | None = None
    device: NamedMethod[HapticDevice] | None = None
    safety: Safety = field(default_factory=Safety)

    @property
    def folder(self) -> Path:
        """What its relative files are relative to."""
        return Path() if self.path is None else self.path.parent

    def missing(self, kind: str) -> ConfigError:
        """What to say where a method is needed and none is named."""
        if self.path is None:
            return ConfigError(f"the pipeline has no {kind}; give it one: Pipeline(scene, {kind}=...)")
        return ConfigError(
            f"{self.path}: `{kind}:` is missing; name a method, such as `{kind}: {{use: ...}}` "
            "(`tangible plugins` lists them)"
        )

    @property
    def size(self) -> FeltSize:
        """The workspace, with what suits the scene where it says nothing."""
        return self.workspace.size(kind_of(self.scene))

    @property
    def felt_device(self) -> HapticDevice | None:
        """The device as the picture sees it, by the mapping; None where none is configured."""
        return None if self.device is None else mapped(self.device.method, self.mapping)

    def completed(self) -> dict[str, Any]:
        """The configuration with every default filled in, as plain values.

        Raises: ConfigError for what no file can say: a scene of arrays, a method that is not installed.
        """
        plain: dict[str, Any] = {
            "scene": self._scene_as_said(),
            "want": self.want,
            "workspace": self.size._asdict(),
            "mapping": self.mapping.model_dump(mode="json", exclude_none=True),
            "materials": self.materials.model_dump(mode="json", exclude_none=True),
            "safety": self.safety.model_dump(mode="json", exclude_none=True),
        }
        for kind in STAGES:
            if (chosen := getattr(self, kind)) is not None:
                if not chosen.origin:
                    raise ConfigError(
                        f"{kind}: {chosen.name} is no installed plugin, and a file names its methods; install it with "
                        f"an entry point tangible.{kind} (docs/write-a-plugin.md)"
                    )
                plain[kind] = {"use": chosen.name, **chosen.method.model_dump(mode="json")}
        return plain

    def as_yaml(self) -> str:
        """The completed configuration as a pipeline file. Raises: ConfigError as `completed`."""
        yaml, text = YAML(typ="safe"), StringIO()
        yaml.default_flow_style = False
        yaml.sort_base_mapping_type_on_output = False  # pyright: ignore[reportAttributeAccessIssue]
        yaml.dump(self.completed(), text)  # pyright: ignore[reportUnknownMemberType]
        return text.getvalue()

    def _scene_as_said(self) -> str | dict[str, Any]:
        said = self.scene.files if isinstance(self.scene, Scene) else self.scene
        if said is None:
            raise ConfigError(
                "scene: is made of arrays, and a file names files; save them, and make the scene of their paths"
            )
        return said if isinstance(said, str) else said.model_dump(mode="json", exclude_none=True)


STAGES = ("depth", "texture", "render", "device")
SECTIONS: dict[str, type[BaseModel]] = {
    "workspace": Workspace,
    "mapping": WorkspaceMapping,
    "materials": MaterialChoice,
    "safety": Safety,
}
KEYS = ("scene", "want", *STAGES, *SECTIONS)


def load_config(path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """Read and check a pipeline file.

    overrides: `key.key=value` each, the value in YAML, as `--set` takes them; another method (`depth.use=...`)
    starts with its own defaults.
    Raises: ConfigError with every complaint, one a line.
    """
    return parse_config(read_text(path), path, registry, overrides)


def parse_config(text: str, path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """`load_config` for a text; `path` is what complaints name and what relative files are relative to."""
    source = parse_source(text, path, "a configuration is a mapping that starts with `scene:`", overrides)
    source.check_keys(KEYS)
    values: dict[str, Any] = {"scene": _scene(source), "want": _want(source), **_sections(source)}
    for kind in STAGES:
        if kind in source.tree:
            values[kind] = choose(source, (kind,), kind, source.tree[kind], registry)
    source.settle()
    return PipelineConfig(path=path, **values)


def choose(source: Source, location: Location, kind: str, block: Any, registry: Registry) -> NamedMethod[Any] | None:
    """The method that a block names, with its options; None after a complaint."""
    if isinstance(block, str):
        block = {"use": block}
    if not isinstance(block, dict) or not isinstance(cast(Any, block).get("use"), str):
        known = ", ".join(registry.names(kind))
        return source.complain(location, f"{kind} needs the name of a method, {{use: ...}}; installed: {known}")
    options = dict(cast("dict[str, Any]", block))
    name = options.pop("use")
    try:
        listing, cls = registry.find(kind, name), registry.load(kind, name)
    except TangibleError as error:
        return source.complain((*location, "use"), str(error))
    method = source.model(location, cls, options)
    return None if method is None else NamedMethod(name, listing.origin, method)


def _scene(source: Source) -> Any:
    if "scene" not in source.tree:
        said = "`scene:` is missing; name a builtin (builtin/motorcycle) or files {left:, right:}"
        return source.complain((), said)
    block = source.tree["scene"]
    if not isinstance(block, str):
        return source.model(("scene",), SceneFiles, block)
    if block not in BUILTINS:
        source.complain(("scene",), unknown_scene(block))
    return block


def _want(source: Source) -> Any:
    want = source.tree.get("want", "surface")
    if want not in PRODUCTS:
        hint = did_you_mean(str(want), PRODUCTS)
        source.complain(("want",), f"nothing makes {quoted(want)}{hint}; a pipeline makes {', '.join(PRODUCTS)}")
    return want


def _sections(source: Source) -> dict[str, Any]:
    blocks = {key: source.tree[key] for key in SECTIONS if key in source.tree}
    labels = blocks.get("materials")
    if isinstance(labels, dict) and any(isinstance(key, int) for key in cast("dict[Any, Any]", labels)):
        blocks["materials"] = {"by": labels}
    found = {key: source.model((key,), SECTIONS[key], block) for key, block in blocks.items()}
    if found.get("materials") is not None:
        _check_names(source, found["materials"])
    return found


def _check_names(source: Source, choice: MaterialChoice) -> None:
    """Complain of materials that are not in the library; of one that cannot be read, whoever uses it complains."""
    try:
        library = load_library(choice.library)
    except ConfigError:
        return
    named: list[tuple[Location, str]] = [(("default",), choice.default)]
    named += [(("rules", number, "material"), rule.material) for number, rule in enumerate(choice.rules)]
    labels = ("by",) if "by" in source.tree["materials"] else ()
    named += [((*labels, label), name) for label, name in (choice.by.items() if isinstance(choice.by, dict) else ())]
    for place, name in named:
        try:
            find(name, library)
        except MaterialError as error:
            source.complain(("materials", *place), str(error))
