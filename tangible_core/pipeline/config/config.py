"""The pipeline file: what it may say, and what it says once it was checked."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from io import StringIO
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar, cast, get_args

from pydantic import BaseModel, Discriminator, Tag
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from ...errors import BrokenMethod, ConfigError, MaterialError, PictureError, TangibleError, did_you_mean, quoted
from ...files.source import Location, Source, parse_override, parse_source, read_text
from ...legibility.choice import SimplifyChoice
from ...mapping import WorkspaceMapping, mapped
from ...materials.assignment import NEUTRAL, find, load_library
from ...materials.rules import MaterialRule
from ...parts import HeightChoice, PartChoice
from ...plugins.interfaces import DepthEstimator, Exporter, ForceRenderer, HapticDevice, Method, Segmenter
from ...plugins.registry import Registry
from ...scene.framing import measured
from ...scene.height_files import Measured
from ...scene.scene import Scene
from ...scene.scene_files import BUILTINS, SceneFiles, unknown_scene
from ...scene.scene_reader import SceneReader
from ...scene.workspace import FeltSize, Section, Workspace, kind_of
from ...servo.guard.safety import Safety
from .parts_said import (
    Inscription,
    Said,
    read_heights,
    read_inscription,
    read_parts,
    read_simplify,
    wrong_of_materials,
    wrong_of_names,
    wrong_of_rules,
)
from .scene_readers import scene_reader_of

M = TypeVar("M", bound=Method, covariant=True)

Product = Literal["disparity", "relief", "segments", "parts", "simplified", "materials", "surface", "touch"]
PRODUCTS: tuple[Product, ...] = get_args(Product)


class MaterialChoice(Section):
    """Which material each segment gets; each part, where `parts:` or `heights:` is."""

    rules: tuple[MaterialRule, ...] = ()
    """Rules, which decide first; of several that fit a segment or a part, the first one wins. Before them goes what
    `parts:` says of a part itself."""
    by: Annotated[
        Annotated[Literal["roughness", "rules"], Tag(":word")] | Annotated[dict[int, str], Tag(":labels")],
        Discriminator(lambda value: ":labels" if isinstance(value, dict) else ":word"),
    ] = "roughness"
    """How segments without a rule get a material. `roughness`: by rank, the roughest segment of the picture gets the
    roughest material. A map: from label to material, for all parts of that segment. `rules`: not at all, they get
    `default`."""
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
    parts: Mapping[int, PartChoice] | None = None
    """What is said of each part, by its number; None where nothing is."""
    heights: HeightChoice | None = None
    """How the relief is made of parts; None where it is made of depth."""
    simplify: SimplifyChoice | None = None
    """How parts are made legible before anything is made of them; None where they stay as they are."""
    export: tuple[NamedMethod[Exporter], ...] = ()
    """What writes files of it for others."""
    measured: Measured | None = None
    """The size that the scene's heights have by their own account."""
    title: str = ""
    language: str = "en"
    source: Source | None = field(default=None, repr=False, compare=False)
    """The file with the places of its keys."""

    @property
    def by_parts(self) -> bool:
        """Whether materials are one a part, and labels of the surface the numbers of parts."""
        return self.parts is not None or self.heights is not None or self.simplify is not None

    @property
    def felt_parts(self) -> Literal["parts", "simplified"]:
        """The product of whose parts relief, materials and labels are made, where anything is by parts."""
        return "parts" if self.simplify is None else "simplified"

    @property
    def part_names(self) -> dict[int, str]:
        """Of the parts that have one, by number."""
        return {number: name for number, each in (self.parts or {}).items() if (name := each.name.strip())}

    @property
    def given_heights_m(self) -> dict[int, float]:
        """Of the parts that have one, by number."""
        return {number: each.height_m for number, each in (self.parts or {}).items() if each.height_m is not None}

    @property
    def top_m(self) -> float:
        """The greatest height that a part may have: that of the relief, less the bulge and the detail on top of it."""
        return self.size.relief_m - (self.heights.bulge_m + self.heights.detail_m if self.heights else 0)

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

    def complained(self, *said: Said) -> ConfigError:
        """What is wrong with what these keys say, each at its place in the file."""
        source = self.source or Source(Path(), {})
        source = replace(source, complaints=[])
        for location, text in said:
            source.complain(location, f"{'.'.join(map(str, location))}: {text}")
        if self.source is not None:
            return source.error
        complaints = [each._replace(line=None, column=None) for _, each in source.complaints]
        return ConfigError(*(each.text for each in complaints), complaints=complaints)

    @property
    def size(self) -> FeltSize:
        """The workspace, with what suits the scene, or its parts, where it says nothing."""
        size = self.workspace.size("parts" if self.heights else kind_of(self.scene))
        if self.measured is None:
            return size
        width_m = size.width_m if "width_m" in self.workspace.model_fields_set else self.measured.width_m
        relief_m = self.workspace.relief_m or self.measured.high_m or size.relief_m
        return size._replace(width_m=width_m, relief_m=relief_m)

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
            **({"title": self.title} if self.title else {}),
            "language": self.language,
            "want": self.want,
            **self._parts_as_said(),
            "workspace": self.size._asdict(),
            "mapping": self.mapping.model_dump(mode="json", exclude_none=True),
            "materials": self.materials.model_dump(mode="json", exclude_none=True),
            "safety": self.safety.model_dump(mode="json", exclude_none=True),
        }
        for kind in STAGES:
            if (chosen := getattr(self, kind)) is not None:
                plain[kind] = _as_said(kind, chosen)
        if self.export:
            plain["export"] = [_as_said("export", each) for each in self.export]
        return plain

    def as_yaml(self, leave_out: Collection[str] = ()) -> str:
        """The completed configuration as a pipeline file, without these keys. Raises: ConfigError as `completed`."""
        yaml, text = YAML(typ="safe"), StringIO()
        yaml.default_flow_style = False
        yaml.sort_base_mapping_type_on_output = False  # pyright: ignore[reportAttributeAccessIssue]
        said = {key: value for key, value in self.completed().items() if key not in leave_out}
        yaml.dump(said, text)  # pyright: ignore[reportUnknownMemberType]
        return text.getvalue()

    def _parts_as_said(self) -> dict[str, Any]:
        said: dict[str, Any] = {}
        if self.parts is not None:
            plain = {number: each.model_dump(mode="json", exclude_defaults=True) for number, each in self.parts.items()}
            said["parts"] = plain
        if self.heights is not None or self.given_heights_m:  # which nothing is made of, if so it is said
            said["heights"] = self.heights and self.heights.model_dump(mode="json")
        if self.simplify is not None:
            said["simplify"] = self.simplify.model_dump(mode="json")
        return said

    def _scene_as_said(self) -> str | dict[str, Any]:
        said = self.scene.files if isinstance(self.scene, Scene) else self.scene
        if said is None:
            raise ConfigError(
                "scene: is made of arrays, and a file names files; save them, and make the scene of their paths"
            )
        return said if isinstance(said, str) else said.model_dump(mode="json", exclude_none=True)


def _as_said(kind: str, chosen: NamedMethod[Any]) -> dict[str, Any]:
    """A method as a file says it. Raises: ConfigError for one that no file can name."""
    if not chosen.origin:
        raise ConfigError(
            f"{kind}: {chosen.name} is no installed plugin, and a file names its methods; install it with "
            f"an entry point tangible.{kind} (docs/write-a-plugin.md)"
        )
    return {"use": chosen.name, **chosen.method.model_dump(mode="json")}


STAGES = ("depth", "texture", "render", "device")
"""Of which a pipeline has one method each; of exporters it has a list."""
SECTIONS: dict[str, type[BaseModel]] = {
    "workspace": Workspace,
    "mapping": WorkspaceMapping,
    "materials": MaterialChoice,
    "safety": Safety,
}
KEYS = ("scene", *Inscription.model_fields, "want", "parts", "heights", "simplify", *STAGES, "export", *SECTIONS)


def shorthand(place: Location) -> str:
    """The option that a word alone stands for in a pipeline file: a method's name, or a part's."""
    if len(place) == 1 and place[0] in STAGES:
        return "use"
    return {("parts", 2): "name", ("heights", 1): "by", ("export", 2): "use"}.get((place[0], len(place)), "")


def load_config(path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """Read and check a pipeline file.

    overrides: `key.key=value` each, the value in YAML, as `--set` takes them; another method (`depth.use=...`)
    starts with its own defaults. `export.NAME.key=value` is of the exporter of that name, which is listed if it is not
    yet.
    Raises: ConfigError with every complaint, one a line.
    """
    return parse_config(read_text(path), path, registry, overrides)


def parse_config(text: str, path: Path, registry: Registry, overrides: Iterable[str] = ()) -> PipelineConfig:
    """`load_config` for a text; `path` is what complaints name and what relative files are relative to."""
    what = "a configuration is a mapping that starts with `scene:`"
    source = parse_source(text, path, what)
    for override in overrides:
        _override(source, override)
    source.check_keys(KEYS)
    values: dict[str, Any] = {"scene": _scene(source), "want": _want(source), **_sections(source), **_parts(source)}
    values |= {"export": _exporters(source, registry), "measured": _measured(source, values["scene"])}
    for kind in STAGES:
        if kind in source.tree:
            values[kind] = choose(source, (kind,), kind, source.tree[kind], registry)
    if values["scene"] is not None:
        right = {key: each for key, each in values.items() if each is not None}
        for location, wrong in wrong_of_parts(PipelineConfig(path=path, source=source, **right)):
            source.complain(location, f"{'.'.join(map(str, location))}: {wrong}")
    source.settle()
    return PipelineConfig(path=path, source=source, **values)


def wrong_of_parts(config: PipelineConfig) -> Iterator[Said]:
    """What is said of parts and makes no sense together, as far as that can be told without their picture."""
    parts, heights = config.parts or {}, config.heights
    yield from wrong_of_names(parts)
    with suppress(ConfigError):  # of a library that cannot be read, whoever uses it complains
        yield from wrong_of_materials(parts, load_library(config.materials.library))
    yield from wrong_of_rules((rule.part for rule in config.materials.rules), parts if config.by_parts else None)
    if heights is None:
        said_off = config.source is not None and "heights" in config.source.tree
        if not said_off and (idle := next(iter(config.given_heights_m), None)) is not None:
            yield (
                ("parts", idle, "height_m"),
                "without `heights:` no part has a height; write `heights: {by: given}`, or `heights: null` to leave "
                "the heights of parts aside",
            )
    elif kind_of(config.scene) == "heights":
        yield ("heights",), "the scene is a map of heights, which are felt as they are; leave `heights:` out"
    elif config.top_m < -ROUNDING_M:
        least_mm, relief_mm = (1e3 * each for each in (heights.bulge_m + heights.detail_m, config.size.relief_m))
        yield (
            ("heights",),
            f"bulge_m and detail_m are {least_mm:g} mm together, and the whole relief is {relief_mm:g} mm high; make "
            f"them smaller, or workspace.relief_m larger",
        )


ROUNDING_M = 1e-9
"""What sums of lengths may be off by."""


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


def _override(source: Source, text: str) -> None:
    """Apply `key.key=value`, in which an exporter's name stands for its place in the list."""
    parts, _ = parse_override(text)
    place: Location = ()
    if parts[0] == "export" and len(parts) > 1:
        listed = source.tree.setdefault("export", CommentedSeq())
        if isinstance(listed, list) and len(parts) > 2:
            before = len(cast("list[Any]", listed))
            index = exporter_at(cast("list[Any]", listed), parts[1])
            place = ("export", index, *parts[2:])
            if index == before:  # it says the name, too
                source.overridden["export", str(index)] = text
    source.override(text, shorthand, place)


def exporter_at(listed: list[Any], name: str) -> int:
    """Where in a list an exporter is, by its name, or its number from 0; one that is not there is added.

    >>> exporter_at(["stl", {"use": "swell"}], "swell")
    1
    """
    if name.isdecimal() and int(name) < len(listed):
        return int(name)
    for index, each in enumerate(listed):
        if name == (cast("dict[Any, Any]", each).get("use") if isinstance(each, dict) else each):
            return index
    listed.append(CommentedMap(use=name))
    return len(listed) - 1


def _exporters(source: Source, registry: Registry) -> tuple[NamedMethod[Exporter], ...]:
    """What the file's `export:` lists; complains of what is no list."""
    block = source.tree.get("export")
    if block is None:
        return ()
    if not isinstance(block, list):
        known = ", ".join(registry.names("export"))
        said = f"export: takes a list of exporters, such as [{{use: ...}}], not {quoted(block)}; installed: {known}"
        return source.complain(("export",), said) or ()
    listed = enumerate(cast("list[Any]", block))
    found = [choose(source, ("export", index), "export", each, registry) for index, each in listed]
    return tuple(each for each in found if each is not None)


def _scene(source: Source) -> Any:
    if "scene" not in source.tree:
        said = "`scene:` is missing; name a builtin (builtin/motorcycle) or files {left:, right:}"
        return source.complain((), said)
    block = source.tree["scene"]
    try:
        reader = scene_reader_of(block)
    except BrokenMethod as error:
        return source.complain(("scene",), f"scene: {error}")
    if reader is not None:
        return _files_of(source, reader, block)
    if not isinstance(block, str):
        return source.model(("scene",), SceneFiles, block)
    return block if block in BUILTINS else source.complain(("scene",), unknown_scene(block))


def _measured(source: Source, scene: Any) -> Measured | None:
    try:
        return measured(scene) if isinstance(scene, SceneFiles) else None
    except PictureError as error:
        return source.complain(("scene", "height"), str(error))


def _files_of(source: Source, reader: type[SceneReader], block: Any) -> SceneFiles | None:
    """Return the files that a block of a scene reader stands for; None after a complaint."""
    chosen = source.model(("scene",), reader, block)
    try:
        return chosen and chosen.files()
    except TangibleError as error:
        return source.complain(("scene",), f"scene: {error}")


def _parts(source: Source) -> dict[str, Any]:
    inscription = read_inscription(source) or Inscription()
    said = {"parts": read_parts(source), "heights": read_heights(source), "simplify": read_simplify(source)}
    return {**said, **inscription.model_dump()}


def _want(source: Source) -> Any:
    want = source.tree.get("want", "surface")
    if want in PRODUCTS:
        return want
    hint = did_you_mean(str(want), PRODUCTS)
    return source.complain(("want",), f"nothing makes {quoted(want)}{hint}; a pipeline makes {', '.join(PRODUCTS)}")


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
