"""The pipeline: one scene, its methods, and all that can be done with them. Files are one way to say it."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from threading import Event
from typing import TYPE_CHECKING, Any, Literal, Self, Unpack, cast, final

from ..data import (
    DisparityMap,
    HapticSurface,
    MaterialMap,
    Outcomes,
    Plan,
    Relief,
    SegmentMap,
    ServoReport,
)
from ..data.products import Product
from ..errors import wrong_argument
from ..files.paths import as_path
from ..files.writing import write_text
from ..legibility import SimplifyChoice
from ..mapping import WorkspaceMapping
from ..parts import HeightChoice, PartChoice
from ..plugins import hooks
from ..plugins.interfaces import (
    DepthEstimator,
    Exporter,
    ForceRenderer,
    HapticDevice,
    Segmenter,
    Touch,
)
from ..plugins.registry import Registry, default_registry
from ..preflight import Hand, Loop, Preflight
from ..scene.scene import Scene
from ..scene.workspace import Workspace
from ..servo import Safety
from ..session import (
    Recording,
)
from .config.material_choice import MaterialChoice
from .config.model import PipelineConfig
from .config.parsing import config_of, load_config
from .engine.cache import Cache
from .engine.engine import Engine
from .engine.stage import Progress
from .engine.warm_up import warm_up
from .feeling import Feeling, FeelOptions
from .output.exporting import Export, chosen_exporters, export
from .output.runs import Run, Sheet, make_run

Materials = MaterialChoice | Mapping[Any, Any] | str
"""As in YAML: a rule's name, a map from label to material, or a block of options."""
Parts = Mapping[int, PartChoice | Mapping[str, Any] | str]
"""As in YAML: by number, the name of a part, or a block of what is said of it."""
Heights = HeightChoice | Mapping[str, Any] | Literal["depth", "given", "guess"]
"""As in YAML: where the heights of parts come from, or a block of options."""


@final
class Pipeline:
    """A scene, its methods, and what was made of them so far.

    A product is made when it is first asked for, with what it needs and no more; it is None where this scene does not
    need it, and `outcomes` says why. What was made before, with the same methods and inputs, comes from the cache.

    >>> import numpy as np
    >>> pipeline = Pipeline(Scene.heights(np.eye(8)), workspace=Workspace(width_m=0.04), cached=False)
    >>> pipeline.surface.extent_m
    (0.04, 0.04)
    """

    def __init__(
        self,
        scene: Scene,
        *,
        depth: DepthEstimator | None = None,
        texture: Segmenter | None = None,
        materials: Materials | None = None,
        workspace: Workspace | Mapping[str, Any] | None = None,
        mapping: WorkspaceMapping | Mapping[str, Any] | None = None,
        render: ForceRenderer | None = None,
        device: HapticDevice | None = None,
        safety: Safety | Mapping[str, Any] | None = None,
        parts: Parts | None = None,
        heights: Heights | None = None,
        simplify: SimplifyChoice | Mapping[str, Any] | None = None,
        export: Sequence[Exporter] = (),
        title: str = "",
        language: str = "en",
        cached: bool = True,
        threads: int | None = None,
        **others: Any,
    ) -> None:
        """Methods are objects, of installed plugins or of classes of one's own; blocks may be mappings, as in YAML.

        parts: what the parts of the segments are called, how high they stand and what they are of, by number.
        heights: makes the relief of these parts. simplify: makes the parts legible first; `{}` by the usual rules.
        export: what `export` writes. title, language: of the whole. cached: False neither reads nor writes the user's
        cache. threads: the most that work at once; see the property.
        others: other keys of the pipeline file.
        Raises: ConfigError with every complaint about these; ArgumentError for what is not a key.
        """
        if not isinstance(scene, cast(Any, Scene)):
            raise wrong_argument("scene", scene, "a Scene, such as Scene.photo(...) makes")
        registry = default_registry()
        config = config_of(
            scene,
            registry,
            want="surface" if render is None else "touch",
            depth=depth,
            texture=texture,
            materials=materials,
            workspace=workspace,
            mapping=mapping,
            render=render,
            device=device,
            safety=safety,
            parts=parts,
            heights=heights,
            simplify=simplify,
            export=export,
            title=title,
            language=language,
            **others,
        )
        self.engine = Engine(config, registry, Cache() if cached else None, threads)

    @classmethod
    def from_yaml(
        cls,
        path: str | PathLike[str],
        overrides: Iterable[str] = (),
        registry: Registry | None = None,
        cache: Cache | None = None,
    ) -> Self:
        """A pipeline from a YAML file; nothing runs yet.

        overrides: `key.key=value` each. cache: where results are kept between runs; the user's own by default.
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
        """Make a pipeline of a configuration that was checked.

        cache: where results are kept between runs; None keeps none. like: another pipeline, whose registry and cache
        this one shares; what the configuration makes alike is not made again.
        """
        pipeline = cls.__new__(cls)
        if like is None:
            pipeline.engine = Engine(config, registry or default_registry(), cache)
        else:
            pipeline.engine = like.engine.with_config(config)
        return pipeline

    def to_yaml(self, path: str | PathLike[str]) -> None:
        """Write it as a pipeline file, every default filled in, paths absolute; `from_yaml` makes the same of it.

        Raises: ConfigError for what no file can say: a scene of arrays, a method of no installed plugin; OutputError.
        """
        write_text(as_path(path), self.config.as_yaml())

    @property
    def config(self) -> PipelineConfig:
        """What it is made of."""
        return self.engine.config

    @property
    def scene(self) -> Scene:
        """The scene; read from its files when first asked for. Raises: PictureError."""
        return self.engine.scene

    @property
    def outcomes(self) -> Outcomes:
        """What became of each product, and why, in the order of making; last those that nothing needed."""
        return self.engine.outcomes

    def plan(self, want: Product | None = None) -> Plan:
        """What making a product (the farthest that has a method) would do, as a table; nothing runs.

        Raises: TangibleError for a scene that cannot be read; UnknownMethod for a product that nothing makes.
        """
        return self.engine.plan(want)

    def make(self, want: str | None = None, progress: Progress | None = None, stop: Event | None = None) -> Any:
        """A product, made from what it needs and no more; None if this scene does not need it.

        progress: hears of every stage as it begins and ends. stop: set from another thread, it ends the work.
        Raises: TangibleError for what a user can put right, Stopped after `stop`, and whatever a plugin raises.
        """
        watched, beside = self.engine.watching(progress, stop), warm_up(self.engine, want or self.config.want)
        with watched, beside as self.engine.beside:
            return self.engine.make(want)

    @property
    def disparity(self) -> DisparityMap | None:
        """Disparity of the left view, or relative nearness of a photo."""
        return self.make("disparity")

    @property
    def relief(self) -> Relief:
        """Heights in metres."""
        return self.make("relief")

    @property
    def segments(self) -> SegmentMap | None:
        """Which texture segment each pixel belongs to."""
        return self.make("segments")

    @property
    def materials(self) -> MaterialMap | None:
        """One material a segment, or a part where anything is by parts, and why each was chosen."""
        return self.make("materials")

    @property
    def surface(self) -> HapticSurface:
        """What is touched: heights, and materials where the law uses them."""
        return self.make("surface")

    @property
    def touch(self) -> Touch:
        """The law on this surface."""
        return self.make("touch")

    def run(
        self,
        out: str | PathLike[str],
        want: Product | None = None,
        seconds: float = 8.0,
        progress: Progress | None = None,
        stop: Event | None = None,
        sheet: Sheet = "png",
    ) -> Run:
        """Make what is wanted, and write products, figures and a sheet into a folder.

        A touch is felt for so many seconds of a simulated device's own time; a real device is never moved by it.
        progress, stop: as `make`. sheet: png, or svg or pdf, which can be enlarged.
        Raises: OutputError if the folder cannot be written; TangibleError as `make`.
        """
        with self.engine.watching(progress, stop):
            return make_run(self.engine, as_path(out, "out"), want or self.config.want, seconds, self._report, sheet)

    def export(
        self,
        out: str | PathLike[str],
        to: Sequence[str | Exporter] | None = None,
        progress: Progress | None = None,
        stop: Event | None = None,
        *,
        force: bool = False,
    ) -> Export:
        """Write it as files for others: a printer, swell paper, a pin display, a reader.

        to: names of exporters, or objects of them; what the pipeline's `export` lists where nothing is said. A name
        that is listed there has the options that it has there. Only what they need is made, of the width that each
        writes. One that fails does not keep the others from being written: see `Export.outcomes`.
        progress, stop: as `make`. force: over files that are no earlier export of this pipeline, too.
        Raises: ConfigError if nothing is named; UnknownMethod, BrokenMethod; OutputError if the folder cannot be
        written; Stopped after `stop`.
        """
        chosen = chosen_exporters(self.config, to, self.engine.registry)
        return export(self.engine, as_path(out, "out"), chosen, progress, stop, force=force)

    def feel(
        self, device: HapticDevice | None = None, seconds: float | None = 8.0, **options: Unpack[FeelOptions]
    ) -> Recording:
        """Feel the surface on a device, this or the configured one, and return the recording.

        See `Feeling.run`, which also says the options. A `Feeling` replays a recording, too, makes the film of a video,
        and tells how long each part was touched.
        """
        return Feeling(self, device).run(seconds, **options)

    def preflight(
        self, device: HapticDevice | None = None, hand: Hand | None = None, loop: Loop | None = None
    ) -> Preflight:
        """Judge what is safe and what will be felt on a device, this or the configured one; no device is opened.

        It shows itself as one sentence, and the cure of all that is wrong; it is a tuple of verdicts.
        Raises: ConfigError if there is no device or force law; TangibleError as `make`.
        """
        return Feeling(self, device).preflight(hand, loop)

    def _report(self, report: ServoReport) -> None:
        hooks.tell(self.engine.registry.plugins, "tangible_servo_report", report=report)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Find an old name, which stays for one release."""
            from .old_names import OLD_NAMES

            if name not in OLD_NAMES or "engine" not in vars(self):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            return OLD_NAMES[name](self)

    def _repr_html_(self) -> str:
        return self.plan()._repr_html_()  # pyright: ignore[reportPrivateUsage] - the name is the notebook's


def load_pipeline(
    path: str | PathLike[str],
    overrides: Iterable[str] = (),
    registry: Registry | None = None,
    cache: Cache | None = None,
) -> Pipeline:
    """`Pipeline.from_yaml`: a pipeline from a YAML file; nothing runs yet.

    Raises: ConfigError with every complaint, each with file:line:column.
    """
    return Pipeline.from_yaml(path, overrides, registry, cache)
