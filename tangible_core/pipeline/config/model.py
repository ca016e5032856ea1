"""The pipeline file: every key with its type, bounds, default and description, from which all else is derived."""

from collections.abc import Collection, Mapping
from dataclasses import replace
from io import StringIO
from pathlib import Path
from re import match
from typing import Annotated, Any, ClassVar, Literal, Self, cast, final

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from ruamel.yaml import YAML
from ruamel.yaml.representer import SafeRepresenter

from ...data.part_words import label_of_number
from ...data.products import Product
from ...errors import ConfigError, quoted
from ...files.paths import CONTROLS, without_folders
from ...files.yaml.source import Location, Source
from ...mapping import WorkspaceMapping, map_device
from ...parts import HeightChoice, PartChoice, SimplifyChoice
from ...plugins.interfaces import DepthEstimator, Exporter, ForceRenderer, HapticDevice, Segmenter
from ...relief import ReliefChoice
from ...scene.formats.height_maps import MeasuredSize
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ...scene.scene_source import scene_name
from ...scene.workspace import FeltSize, ReliefKind, Workspace, kind_of
from ...servo.guard.safety import Safety
from .keys import NULL_IS_DEFAULT, Block, MethodBlock, MethodList, PartsBlock, SceneBlock, Unchecked, Word
from .keys.key import find_keys
from .material_choice import MaterialChoice, check_material_names
from .methods import NamedMethod

Wrong = tuple[Location, str]  # a complaint: the keys that it is about, and a sentence
# The most characters of a title: what a person reads at a glance, and what fits a line of braille or two.
MAX_TITLE = 200
LANGUAGE_TAG = "^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*$"


def _check_title(title: str) -> str:
    if CONTROLS.search(title.strip()):
        raise ValueError("Input should be one line of text without control characters")
    return title


def _check_tag(language: str) -> str:
    if not match(LANGUAGE_TAG, language):
        raise ValueError("Input should be the tag of a language, such as en, de or pt-BR")
    return language


# Width of a line that no value reaches: a text that ruamel folds behind an escaped line break gets a space more.
UNFOLDED = 1 << 20


@final
class _Representer(SafeRepresenter):
    """A representer that escapes what cannot be printed; by itself, ruamel writes U+0085 as it is, a line break."""

    def represent_str(self, data: str) -> Any:
        return cast(Any, self).represent_scalar("tag:yaml.org,2002:str", data, None if data.isprintable() else '"')


_Representer.add_representer(str, _Representer.represent_str)  # pyright: ignore[reportUnknownMemberType]


class PipelineConfig(BaseModel):
    """A checked configuration. Its fields with a marker are the keys of the pipeline file, in their order there."""

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid")

    scene: Annotated[str | SceneFiles | Scene, SceneBlock()]
    """The pictures, or the heights, that the surface is made of."""
    title: Annotated[
        str,
        Field(max_length=MAX_TITLE, coerce_numbers_to_str=True),  # a title may be a year
        AfterValidator(_check_title),
        NULL_IS_DEFAULT,
        Word(),
    ] = ""
    """The name of the picture, in your own words; empty for the name of its file."""
    language: Annotated[
        str, Field(json_schema_extra={"pattern": LANGUAGE_TAG}), AfterValidator(_check_tag), NULL_IS_DEFAULT, Word()
    ] = "en"
    """The language of the title and of the names of parts, as a tag: `en`, `de`, `pt-BR`."""
    want: Annotated[Product, Word()] = "surface"
    """The product to make: by default the touch where there is a `render:`, else the surface."""
    parts: Annotated[
        Mapping[int, PartChoice] | None,
        PartsBlock("A word alone is a name (`{1: wall, 7: helmet}`), or ([more](../how-to/parts.md)):"),
    ] = None
    """The names, heights and materials of the connected parts of the segments, by number, from 1, in the
    order of their first pixels, row by row. With it, each part has one material."""
    heights: Annotated[HeightChoice | None, Block("A word alone is `by` (`heights: given`), or:", word="by")] = None
    """The relief is made of parts, each of one height, with rounded rims and a little of the picture's brightness, in
    place of depth or brightness alone; `null` switches it off."""
    simplify: Annotated[
        SimplifyChoice | None, Block("`simplify: {}` takes the usual rules ([more](../how-to/legibility.md)):")
    ] = None
    """Parts that are too narrow or too small for fingers are merged into their neighbours, before relief, materials and
    labels are made of the parts; the numbers stay."""
    workspace: Annotated[Workspace, Block()] = Workspace()
    """The size of the surface under the hand."""
    relief: Annotated[
        ReliefChoice, Block("A word alone is `by` (`relief: depth`), or ([more](../explanation/relief.md)):", word="by")
    ] = ReliefChoice()
    """How depth becomes height: which depths get most of it, how steep it may be, and what counts as noise."""
    mapping: Annotated[WorkspaceMapping, Block()] = WorkspaceMapping()
    """The place of the surface in the device's workspace, and how the hand moves over it."""
    materials: Annotated[
        MaterialChoice,
        Block("A map from segment to material (`{1: ice, 2: sand}`), or:", labels="by", check=check_material_names),
    ] = MaterialChoice()
    """The material of each segment; of each part, with `parts:` or `heights:`."""
    depth: Annotated[NamedMethod[DepthEstimator] | None, MethodBlock()] = None
    """The method that finds depth in a pair of views or in one picture."""
    texture: Annotated[NamedMethod[Segmenter] | None, MethodBlock()] = None
    """The method that finds segments of one texture each."""
    render: Annotated[NamedMethod[ForceRenderer] | None, MethodBlock()] = None
    """The force law."""
    device: Annotated[NamedMethod[HapticDevice] | None, MethodBlock()] = None
    """The haptic device."""
    export: Annotated[tuple[NamedMethod[Exporter], ...], MethodList("[More](../how-to/export.md).")] = ()
    """The files that `tangible export` writes: a list of names of exporters, `[stl, swell]`, or of blocks with options,
    `[{use: pins, display: monarch}]`."""
    safety: Annotated[Safety, Block("[Why](../explanation/safety.md).")] = Safety()
    """The guard between every force law and every device."""

    path: Annotated[Path | None, Unchecked()] = None
    """The file that the configuration stands in; None for a configuration that was made in Python."""
    felt_widths_m: Annotated[tuple[float, ...], Unchecked()] = ()
    """The widths of the whole picture for which parts are simplified, the least first; () for its own."""
    measured: Annotated[MeasuredSize | None, Unchecked()] = None
    """The size of the scene's heights according to their file."""
    source: Annotated[Source | None, Unchecked()] = Field(default=None, repr=False)
    """The file with the places of its keys."""

    def with_values(self, **values: Any) -> Self:
        """Return the same configuration with other values, which are not checked."""
        return self.model_copy(update=values)

    @property
    def by_parts(self) -> bool:
        """True where each part has a material, and labels of the surface are numbers of parts."""
        return self.parts is not None or self.heights is not None or self.felt_parts == "simplified"

    @property
    def felt_parts(self) -> Literal["parts", "simplified"]:
        """The product whose parts relief, materials and labels are made of, where anything is by parts."""
        return "parts" if self.simplify is None and not self.felt_widths_m else "simplified"

    @property
    def choices(self) -> dict[int, PartChoice]:
        """The configured parts by label, from 0; in `parts` they are by number, from 1."""
        return {label_of_number(number): part for number, part in (self.parts or {}).items()}

    @property
    def part_names(self) -> dict[int, str]:
        """The names of parts by label; parts without a name are left out."""
        return {label: name for label, part in self.choices.items() if (name := part.name.strip())}

    @property
    def given_heights_m(self) -> dict[int, float]:
        """The heights of parts by label, metres; parts without a height are left out."""
        return {label: part.height_m for label, part in self.choices.items() if part.height_m is not None}

    @property
    def top_m(self) -> float:
        """The greatest height that a part may have: that of the relief, less the bulge and the detail on top of it."""
        return self.size.relief_m - (self.heights.bulge_m + self.heights.detail_m if self.heights else 0)

    @property
    def folder(self) -> Path:
        """The folder that relative files are relative to."""
        return Path() if self.path is None else self.path.parent

    @property
    def size(self) -> FeltSize:
        """The workspace, with sizes that suit the scene or its parts where the file leaves them open."""
        size = self.workspace.size(self.relief_kind)
        if self.measured is None:
            return size
        if self.workspace.times is not None:
            return size._replace(width_m=self.measured.width_m / self.workspace.times)
        if self.measured.high_m is None:
            return size
        width_m = size.width_m if "width_m" in self.workspace.model_fields_set else self.measured.width_m
        relief_m = self.workspace.relief_m or self.measured.high_m or size.relief_m
        return size._replace(width_m=width_m, relief_m=relief_m)

    @property
    def relief_kind(self) -> ReliefKind:
        """What the relief is made of: of one picture, its brightness, or depth where the method finds it."""
        if self.heights:
            return "parts"
        kind = kind_of(self.scene)
        if self.relief.by in ("edges", "figure", "lines") and kind != "heights":
            return self.relief.by
        return "depth" if kind == "photograph" and self.depth and self.depth.method.finds_depth else kind

    @property
    def in_short(self) -> str:
        """The scene, the wanted product and the names of the methods, in a line."""
        scene = self.scene.name if isinstance(self.scene, Scene) else self.scene
        name = scene if isinstance(scene, str) else scene_name(scene)
        methods = {"depth": self.depth, "texture": self.texture, "render": self.render, "device": self.device}
        names = {"want": self.want, **{kind: method.name for kind, method in methods.items() if method}}
        return ", ".join([quoted(without_folders(name)), *(f"{key}={quoted(value)}" for key, value in names.items())])

    def __repr__(self) -> str:
        return f"PipelineConfig({self.in_short})"

    @property
    def felt_device(self) -> HapticDevice | None:
        """The device in the picture's frame, by the mapping; None without a configured device."""
        return None if self.device is None else map_device(self.device.method, self.mapping)

    def missing(self, kind: str) -> ConfigError:
        """Return the error for a missing method that is needed."""
        if self.path is None:
            return ConfigError(f"the pipeline has no {kind}; give it one: Pipeline(scene, {kind}=...)")
        return ConfigError(
            f"{self.path}: `{kind}:` is missing; name a method, such as `{kind}: {{use: ...}}` "
            "(`tangible plugins` lists them)"
        )

    def error_at(self, *wrong: Wrong) -> ConfigError:
        """Return the error with these complaints about keys, each at its place in the file."""
        source = replace(self.source or Source(Path(), {}), complaints=[])
        for location, text in wrong:
            source.complain(location, f"{'.'.join(map(str, location))}: {text}")
        return source.error if self.source is not None else without_places(source)

    def as_data(self) -> dict[str, Any]:
        """Return the configuration with every default filled in, as plain values.

        Raises: ConfigError for what no file can have: a scene of arrays, a method that is not installed.
        """
        size = {name: value for name, value in self.size._asdict().items() if name in Workspace.model_fields}
        workspace = self.workspace.model_copy(update=size)
        values = {name: getattr(self, name) for name in KEYS} | {"workspace": workspace}
        names = [name for name, value in values.items() if value not in (None, "", ())]
        if self.heights is None and self.given_heights_m:  # `heights: null`; without it, they would be a mistake
            names.append("heights")
        names.sort(key=lambda name: (KEYS[name].stands_last, list(KEYS).index(name)))
        return {name: KEYS[name].write(values[name]) for name in names}

    def as_yaml(self, leave_out: Collection[str] = ()) -> str:
        """Return the completed configuration as a pipeline file, without these keys. Raises: as `as_data`."""
        yaml, text = YAML(typ="safe"), StringIO()
        yaml.Representer = _Representer  # pyright: ignore[reportAttributeAccessIssue]
        yaml.default_flow_style = False
        yaml.width = UNFOLDED  # pyright: ignore[reportAttributeAccessIssue]
        yaml.sort_base_mapping_type_on_output = False  # pyright: ignore[reportAttributeAccessIssue]
        plain = {key: value for key, value in self.as_data().items() if key not in leave_out}
        yaml.dump(plain, text)  # pyright: ignore[reportUnknownMemberType]
        return text.getvalue()


def without_places(source: Source) -> ConfigError:
    """Return the complaints about a configuration that was made in Python, where nothing has a line."""
    complaints = [each._replace(line=None, column=None) for _, each in source.complaints]
    return ConfigError(*(complaint.text for complaint in complaints), complaints=complaints)


KEYS = find_keys(PipelineConfig)
STAGES = tuple(name for name, key in KEYS.items() if isinstance(key, MethodBlock))
"""The keys that name one method each."""
