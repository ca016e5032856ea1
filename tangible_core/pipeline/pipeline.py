"""The pipeline: a scene, its methods, and everything that can be done with them, from Python or from a file."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from threading import Event
from typing import Any, Literal, Self, Unpack, final

import numpy as np

from ..data import DisparityMap, HapticSurface, MaterialMap, Outcomes, Plan, Relief, SegmentMap
from ..data.arguments import named_options
from ..data.products import Product
from ..files.paths import as_path
from ..files.writing import write_text
from ..mapping import WorkspaceMapping
from ..parts import HeightChoice, PartChoice, SimplifyChoice
from ..plugins.interfaces import DepthEstimator, Exporter, ForceRenderer, HapticDevice, Segmenter, Touch
from ..plugins.registry import Registry, default_registry
from ..preflight import Hand, Loop, Preflight
from ..scene.scene import Scene
from ..scene.workspace import Workspace
from ..servo import Safety
from ..session import Recording
from .config.material_choice import MaterialChoice
from .config.model import PipelineConfig
from .config.parsing import load_config, make_config
from .engine.cache import Cache
from .engine.engine import Engine
from .engine.stage import Progress
from .engine.warm_up import warm_up
from .feel_options import FeelOptions
from .feeling import Feeling
from .output.export_result import Export
from .output.exporting import chosen_exporters, export
from .output.runs import Run, Sheet, make_run
from .starter import suited_config

# The name of an installed method, or the block of a file with its options: `{"use": "proxy", ...}`.
Named = Mapping[str, Any] | str
# The key `materials:`: a rule's name, a map from label to material, or a block of options.
Materials = MaterialChoice | Mapping[Any, Any] | str
# The key `parts:`: by number, the name of a part, or a block of options.
Parts = Mapping[int, PartChoice | Mapping[str, Any] | str]
Heights = HeightChoice | Mapping[str, Any] | Literal["depth", "given", "guess"]
"""The key `heights:`: the source of the heights of parts, or a block of options."""


@final
class Pipeline:
    """A scene, its methods, and the products that were made of them so far.

    A product is made at its first request, with the products that it needs and no others. It is None where this scene
    does not need it, and `outcomes` has the reason. The cache has the results of earlier runs with equal inputs.

    >>> import numpy as np
    >>> pipeline = Pipeline(Scene.heights(np.eye(8)), workspace=Workspace(width_m=0.04), cached=False)
    >>> pipeline.surface.extent_m
    (0.04, 0.04)
    """

    def __init__(
        self,
        scene: Scene,
        *,
        depth: DepthEstimator | Named | None = None,
        texture: Segmenter | Named | None = None,
        materials: Materials | None = None,
        workspace: Workspace | Mapping[str, Any] | None = None,
        mapping: WorkspaceMapping | Mapping[str, Any] | None = None,
        render: ForceRenderer | Named | None = None,
        device: HapticDevice | Named | None = None,
        safety: Safety | Mapping[str, Any] | None = None,
        parts: Parts | None = None,
        heights: Heights | None = None,
        simplify: SimplifyChoice | Mapping[str, Any] | None = None,
        export: Sequence[Exporter | Named] = (),
        title: str = "",
        language: str = "en",
        cached: bool = True,
        threads: int | None = None,
        **others: Any,
    ) -> None:
        """Make a pipeline of methods: names as in a file, or objects, custom ones too; blocks may be mappings.

        parts: names, heights and materials of the parts of the segments, by number.
        heights: makes the relief of these parts. simplify: makes the parts legible first; `{}` by the usual rules.
        export: the exporters of `export`. title, language: of the whole. cached: False neither reads nor writes the
        user's cache. threads: the most threads at once; None for one a processor, or for `TANGIBLE_THREADS`.
        others: other keys of the pipeline file.
        Raises: ConfigError with every complaint about these; ArgumentError for an unknown key.
        """
        registry = default_registry()
        config = make_config(
            scene, registry, depth=depth, texture=texture, materials=materials, workspace=workspace, mapping=mapping,
            render=render, device=device, safety=safety, parts=parts, heights=heights, simplify=simplify, export=export,
            title=title, language=language, **others,
        )  # fmt: skip
        self.engine: Engine = Engine(config, registry, Cache() if cached else None, threads)

    @classmethod
    def from_yaml(
        cls,
        path: str | PathLike[str],
        overrides: Iterable[str] = (),
        registry: Registry | None = None,
        cache: Cache | None = None,
    ) -> Self:
        """Read a pipeline from a YAML file; nothing runs yet.

        overrides: `key.key=value` each. cache: keeps results between runs; the user's cache by default.
        Raises: ConfigError with every complaint, each with file:line:column.
        """
        registry = registry or default_registry()
        return cls.from_config(load_config(as_path(path), registry, overrides), registry, cache or Cache())

    @classmethod
    def from_config(
        cls,
        config: PipelineConfig,
        registry: Registry | None = None,
        cache: Cache | None = None,
        *,
        like: "Pipeline | None" = None,
    ) -> Self:
        """Make a pipeline of a checked configuration.

        cache: keeps results between runs; None keeps none. like: another pipeline, whose registry, cache and equal
        products this one shares.
        """
        pipeline = cls.__new__(cls)
        if like is None:
            pipeline.engine = Engine(config, registry or default_registry(), cache)
        else:
            pipeline.engine = like.engine.with_config(config)
        return pipeline

    @classmethod
    def suited(cls, *pictures: Scene | str | PathLike[str] | np.ndarray, cached: bool = True) -> Self:
        """Make the pipeline that the command line makes without a file: methods and sizes suit the pictures.

        pictures: a scene, or files or arrays: one picture, or left and right. cached: as in `Pipeline`.
        Raises: ConfigError for other pictures; PictureError for one that cannot be read.
        """
        registry = default_registry()
        return cls.from_config(suited_config(pictures, registry), registry, Cache() if cached else None)

    def with_(self, **changes: Any) -> Self:
        """Return another pipeline with these arguments of `Pipeline` changed; equal products are not made again.

        >>> Pipeline(Scene.heights([[0, 1]]), title="one").with_(title="two")
        Pipeline('arrays', want='surface')

        Raises: as `Pipeline`.
        """
        config = make_config(changes.pop("scene", None), self.engine.registry, self.config, **changes)
        return self.from_config(config, like=self)

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "engine":
            raise AttributeError(f"a pipeline does not change; `pipeline.with_({name}=...)` returns another one")
        super().__setattr__(name, value)

    def to_yaml(self, path: str | PathLike[str]) -> None:
        """Write an equal pipeline file, with all defaults filled in and absolute paths.

        Raises: ConfigError for a scene of arrays or a method that is not an installed plugin; OutputError.
        """
        write_text(as_path(path), self.config.as_yaml())

    @property
    def config(self) -> PipelineConfig:
        """The checked configuration."""
        return self.engine.config

    @property
    def scene(self) -> Scene:
        """The scene, read from its files at the first use. Raises: PictureError."""
        return self.engine.scene

    @property
    def outcomes(self) -> Outcomes:
        """The outcome of each product with its reason, in the order of making; last those that nothing needed."""
        return self.engine.outcomes

    def plan(self, want: Product | None = None) -> Plan:
        """Foresee the outcomes of making a product, by default the configured one, as a table. Raises: as `make`."""
        return self.engine.plan(want)

    def make(self, want: str | None = None, progress: Progress | None = None, stop: Event | None = None) -> Any:
        """Make a product from what it needs and no more; None if this scene does not need it.

        progress: called at the start and the end of every stage. stop: ends the work when another thread sets it.
        Raises: TangibleError for mistakes of the user, Stopped after `stop`, and whatever a plugin raises.
        """
        compiling = warm_up(self.engine, want or self.config.want)
        with self.engine.watching(progress, stop), compiling as self.engine.compiler:
            return self.engine.make(want)

    @property
    def disparity(self) -> DisparityMap | None:
        """The disparity of the left view, or the relative nearness of a photo."""
        return self.make("disparity")

    @property
    def relief(self) -> Relief:
        """The heights in metres."""
        return self.make("relief")

    @property
    def segments(self) -> SegmentMap | None:
        """The texture segment of each pixel."""
        return self.make("segments")

    @property
    def materials(self) -> MaterialMap | None:
        """The material of each segment, or of each part where anything is by parts, with the reason of the choice."""
        return self.make("materials")

    @property
    def surface(self) -> HapticSurface:
        """The surface: heights, and materials where the force law uses them."""
        return self.make("surface")

    @property
    def touch(self) -> Touch:
        """The force law on this surface."""
        return self.make("touch")

    @named_options
    def run(
        self,
        out: str | PathLike[str],
        want: Product | None = None,
        seconds: float = 8.0,
        progress: Progress | None = None,
        stop: Event | None = None,
        sheet: Sheet = "png",
    ) -> Run:
        """Make the wanted product, and write products, figures and a sheet into a folder.

        A touch is run for these seconds of a simulated device's time; a real device is never moved by it.
        progress, stop: as `make`. sheet: png, or svg or pdf, which can be enlarged.
        Raises: OutputError if the folder cannot be written; TangibleError as `make`.
        """
        with self.engine.watching(progress, stop):
            return make_run(self.engine, as_path(out, "out"), want or self.config.want, seconds, sheet)

    @named_options
    def export(
        self,
        out: str | PathLike[str],
        to: Sequence[str | Exporter] | None = None,
        progress: Progress | None = None,
        stop: Event | None = None,
        *,
        force: bool = False,
        cut_out: bool = False,
    ) -> Export:
        """Write files for other devices and programs: a printer, swell paper, a pin display, a reader.

        to: names of exporters, with the options that the pipeline's `export` lists, or objects of them; all that
        `export` lists by default. Only the products that they need are made, at the width of each exporter. An exporter
        that fails does not stop the others: see `Export.outcomes`.
        progress, stop: as `make`. force: overwrites files that are not an earlier export of this pipeline, too.
        cut_out: leaves the ground of a photograph away, where a network sees what stands out from it.
        Raises: ConfigError without exporters; UnknownMethod, BrokenMethod; OutputError if the folder cannot be written;
        Stopped after `stop`.
        """
        exporters = chosen_exporters(self.config, to, self.engine.registry)
        return export(self.engine, as_path(out, "out"), exporters, progress, stop, force=force, cut=cut_out)

    def feel(
        self, device: HapticDevice | str | None = None, seconds: float | None = 8.0, **options: Unpack[FeelOptions]
    ) -> Recording:
        """Run a session on a device, by default the configured one, and return its recording.

        See `Feeling.run` and `FeelOptions`. A `Feeling` also replays recordings, makes the film of a video, and reports
        how long each part was touched.
        """
        return Feeling(self, device).run(seconds, **options)

    def preflight(
        self, device: HapticDevice | str | None = None, hand: Hand | None = None, loop: Loop | None = None
    ) -> Preflight:
        """Judge the safety and the quality of the surface on a device, by default the configured one; none is opened.

        The result is a tuple of verdicts, shown as one sentence with the cure of each problem.
        Raises: ConfigError without a device or force law; TangibleError as `make`.
        """
        return Feeling(self, device).preflight(hand, loop)

    def __repr__(self) -> str:
        return f"Pipeline({self.config.in_short})"

    def _repr_html_(self) -> str:
        return self.plan()._repr_html_()  # pyright: ignore[reportPrivateUsage] - the name is the notebook's


def load_pipeline(path: str | PathLike[str], *others: Any, **named: Any) -> Pipeline:
    """Read a pipeline from a YAML file, as `Pipeline.from_yaml`. Raises: ConfigError with every complaint."""
    return Pipeline.from_yaml(path, *others, **named)
