"""The pipeline: one scene, its methods, and all that can be done with them. Files are one way to say it."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from threading import Event
from typing import Any, Literal, Self, TypeVar, cast, final, get_args, overload

import numpy as np

from ..data import (
    TICK_COLUMNS,
    DisparityMap,
    HapticSurface,
    MaterialMap,
    Outcomes,
    PartMap,
    Plan,
    Relief,
    SegmentMap,
    ServoReport,
    Views,
)
from ..data.products import Product
from ..errors import ConfigError, did_you_mean, quoted, wrong_argument
from ..files.paths import as_path
from ..files.writing import write_text
from ..legibility import Legibility, SimplifyChoice
from ..mapping import WorkspaceMapping
from ..parts import HeightChoice, PartChoice, PartHeights
from ..plugins import hooks
from ..plugins.interfaces import (
    DepthEstimator,
    Exporter,
    Film,
    ForceRenderer,
    HapticDevice,
    Medium,
    Reshaping,
    Segmenter,
    Touch,
)
from ..plugins.registry import Registry, default_registry
from ..preflight import Flight, Hand, Loop, Preflight, judge, survey
from ..runtime.threads import check_threads, limited_threads
from ..scene.scene import Scene
from ..scene.workspace import Workspace
from ..servo import OVER, Beacon, Safety, Servo, beacon_to
from ..session import (
    About,
    Followed,
    PartFelt,
    Recording,
    Turn,
    check_record_path,
    keeping,
    parts_felt,
    replay,
    run_in_turn,
    run_simulated,
    telling_parts,
)
from ..session.film import ByClock, Reliefs
from .config.material_choice import MaterialChoice
from .config.methods import check_kind, named_method
from .config.model import PipelineConfig
from .config.parsing import config_of, load_config
from .engine.cache import Cache
from .engine.engine import Engine, Progress
from .engine.film import film_of, reliefs_of
from .engine.stages.touch import fit_to_device
from .engine.warm_up import rehearsal
from .output.exporting import Export, chosen_exporters, export
from .output.following import felt_device, how_followed
from .output.legible import legible, of_width
from .output.parts_text import part_heights, to_correct
from .output.runs import Run, Sheet, about, make_run

T = TypeVar("T")
NO_ROWS = np.empty((0, len(TICK_COLUMNS)))
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
    >>> pipeline = Pipeline(Scene.of(height=np.eye(8)), workspace=Workspace(width_m=0.04), cached=False)
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
            raise wrong_argument("scene", scene, "a Scene, such as Scene.of(photo=...) makes")
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
        self.engine = Engine(config, registry, Cache() if cached else None)
        self.threads = threads

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
        return cls.of(load_config(as_path(path), registry, overrides), registry, cache or Cache())

    @classmethod
    def of(cls, config: PipelineConfig, registry: Registry, cache: Cache | None) -> Self:
        """A pipeline from a configuration that was checked."""
        made = cls.__new__(cls)
        made.engine = Engine(config, registry, cache)
        return made

    def changed(self, config: PipelineConfig) -> Self:
        """The same with another configuration; what that makes alike is not made again."""
        made = type(self).__new__(type(self))
        made.engine = self.engine.changed(config)
        return made

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
    def cache(self) -> Cache | None:
        """Where results are kept between runs; None keeps none."""
        return self.engine.cache

    @cache.setter
    def cache(self, cache: Cache | None) -> None:
        self.engine.cache = cache

    @property
    def threads(self) -> int | None:
        """The most threads that work at once, of kernels, OpenCV and torch; None for one a processor, or what the
        environment variable `TANGIBLE_THREADS` says. No result depends on it.
        """
        return self.engine.threads

    @threads.setter
    def threads(self, most: int | None) -> None:
        check_threads(most)
        self.engine.threads = most

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

    @overload
    def make(
        self, want: Literal["disparity"], progress: Progress | None = None, stop: Event | None = None
    ) -> DisparityMap | None: ...
    @overload
    def make(self, want: Literal["relief"], progress: Progress | None = None, stop: Event | None = None) -> Relief: ...
    @overload
    def make(
        self, want: Literal["segments"], progress: Progress | None = None, stop: Event | None = None
    ) -> SegmentMap | None: ...
    @overload
    def make(
        self, want: Literal["parts"], progress: Progress | None = None, stop: Event | None = None
    ) -> PartMap | None: ...
    @overload
    def make(
        self, want: Literal["simplified"], progress: Progress | None = None, stop: Event | None = None
    ) -> PartMap | None: ...
    @overload
    def make(
        self, want: Literal["materials"], progress: Progress | None = None, stop: Event | None = None
    ) -> MaterialMap | None: ...
    @overload
    def make(
        self, want: Literal["surface"], progress: Progress | None = None, stop: Event | None = None
    ) -> HapticSurface: ...
    @overload
    def make(self, want: Literal["touch"], progress: Progress | None = None, stop: Event | None = None) -> Touch: ...
    @overload
    def make(self, want: str | None = None, progress: Progress | None = None, stop: Event | None = None) -> Any: ...
    def make(self, want: str | None = None, progress: Progress | None = None, stop: Event | None = None) -> Any:
        """A product, made from what it needs and no more; None if this scene does not need it.

        progress: hears of every stage as it begins and ends. stop: set from another thread, it ends the work.
        Raises: TangibleError for what a user can put right, Stopped after `stop`, and whatever a plugin raises.
        """
        watched, beside = self.engine.watched(progress, stop), rehearsal(self.engine, want or self.config.want)
        with watched, beside as self.engine.beside:
            return self.engine.make(want)

    @property
    def views(self) -> Views | None:
        """The pictures; None for a scene of heights."""
        return self.scene.views

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
    def parts(self) -> PartMap | None:
        """The connected parts of the segments, numbered by their first pixels."""
        return self.make("parts")

    @property
    def simplified(self) -> PartMap | None:
        """The parts as fingers can read them, on a grid of their own, with the numbers of `parts`."""
        return self.make("simplified")

    @property
    def part_heights(self) -> PartHeights | None:
        """The height of each part, and why; None where `heights` does not make the relief of parts."""
        return part_heights(self.engine)

    def parts_to_correct(self) -> str:
        """A pipeline file in which each part has the height that was found, to correct; it runs as it stands.

        Raises: ConfigError where the relief is not made of parts; TangibleError as `make`.
        """
        return to_correct(self.engine)

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

    @property
    def reliefs(self) -> Reliefs:
        """The frames of a scene that is a video, as reliefs; not open yet.

        `with pipeline.reliefs as reliefs: for number, time_s, relief in reliefs:` makes one after the other, steady in
        time and of one scale; without end where the video repeats. `reliefs.frames.at` skips to what is due, and
        `reliefs.made` makes the relief of that.
        Raises: ConfigError for a scene that does not move, or a relief that is made of parts.
        """
        return reliefs_of(self.config, self.scene)

    def film(self, device: HapticDevice | None = None, period_s: float = 0.001) -> Film:
        """The law on the surface of the video's first frame, as a film that goes on from there.

        It is given to a `Servo` or to `session.run_simulated` like a touch, and shown the `reliefs`; `feel` does both.
        device: whose materials fit, as for `feel`. period_s: of the loop that feels it.
        Raises: ConfigError for a scene that does not move, or a law that feels none that does; TangibleError as `make`.
        """
        return film_of(self.engine, self.config.felt_device if device is None else self._device(device), period_s)

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
        with self.engine.watched(progress, stop):
            return make_run(self.engine, as_path(out, "out"), want or self.config.want, seconds, self._tell, sheet)

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
        self,
        device: HapticDevice | None = None,
        seconds: float | None = 8.0,
        *,
        in_real_time: bool = True,
        record: str | PathLike[str] | None = None,
        keep: Callable[[np.ndarray], None] | None = None,
        on_report: Callable[[ServoReport], None] | None = None,
        on_start: Callable[[Servo], None] | None = None,
        stop: Event | None = None,
        then: "Sequence[Pipeline]" = (),
        each_s: float = 60.0,
        on_wait: Callable[[str], None] | None = None,
        beacon: str | int | None = None,
    ) -> Recording:
        """Feel the surface on a device, this or the configured one, and return what was felt.

        Ctrl-C, `stop` set from another thread, and a device that fails end it: the force is zero, and the recording
        says why. In real time the force loop runs in a process of its own.
        seconds: None goes on until something ends it; in real time alone. in_real_time: False goes by the clock of the
        device, for simulated ones. record: a file (.nc, .npz, .csv) that keeps every tick while it is felt. keep: given
        all ticks, as rows of `TICK_COLUMNS`; the recording that is returned is then empty, and a session may be
        as long as the disk has room. on_report: called ten times a second, and at the end. on_start: called once a loop
        in real time runs. then: what is felt after this, each for each_s, and then this again. on_wait: waits for a
        device that is not there or goes, and is told so in words (`session.run_in_turn`); both in real time alone.
        beacon: the name or the number of a part to which the hand is pulled gently, with 1 N at most, until a button of
        the device releases it; of every scene of `then`, too.
        A scene that is a video plays while it is felt, by the clock of the device where that is simulated; its parts
        and materials stay those of the first frame. `ServoReport.film` says how it plays.
        Raises: ConfigError if there is no device or law, or no such part, or others of `then` have another device;
        DeviceError if it cannot be opened; OutputError for the file.
        """
        file = None if record is None else as_path(record, "record")
        if file is not None:
            check_record_path(file, seconds is None)
        felt, said = self._device(device), self._about(device)
        tell = _both(self._tell, on_report)
        if not in_real_time and (then or on_wait):
            raise ConfigError("then, on_wait: are for a session in real time; leave them out, or in_real_time=False")
        if not in_real_time:
            tell, until_s = telling_parts(self.surface, tell), math.inf if seconds is None else seconds
            touch, how = self._felt(device), (self.config.safety, stop, self._beacon(beacon))
            if isinstance(touch, Film):
                with self.reliefs as reliefs, limited_threads(self.threads):
                    frames = ByClock(reliefs, touch)
                    found = run_simulated(touch, felt, until_s, frames.told(tell), *how, frames=frames)
            else:
                found = run_simulated(touch, felt, until_s, tell, *how)
            found = replace(found, about=said.stamped())
            if file is not None:
                found.save(file)
            return found

        first = self._turn(self, device, beacon)
        turns = [first, *(each._turn(self, device, beacon) for each in then)]
        each_s = each_s if then else math.inf
        said = _in_turn(said, [each._about(None) for each in (self, *then)])

        def run(rows: Callable[[np.ndarray], None]) -> str:
            report = run_in_turn(
                turns, felt, seconds, each_s, on_report=tell, keep=rows, on_start=on_start, on_wait=on_wait, stop=stop,
                threads=self.threads,
            )  # fmt: skip
            return "" if report.stopped == OVER else report.stopped

        if file is not None:
            with keeping(file, said) as writer:
                stopped = run(_both(writer.append, keep))
                writer.close(stopped)
            return Recording.load(file) if keep is None else Recording(NO_ROWS, stopped, said.stamped())
        rows = [NO_ROWS]
        stopped = run(keep or rows.append)
        return Recording(np.concatenate(rows), stopped, said.stamped())

    def replay(self, recording: Recording | str | PathLike[str], device: HapticDevice | None = None) -> Recording:
        """What this pipeline's law gives for each recorded state: forces of its own, which nothing limits.

        recording: or the file of one. device: which one the materials fit, as for `feel`; the configured one by
        default. `session.compared` says how far they are from those that were recorded.
        Raises: as `make`, and OutputError for a file that cannot be read.
        """
        recording = recording if isinstance(recording, Recording) else Recording.load(recording)
        touch = self._touch(device)
        said = replace(self._about(None), device=f"replay of {recording.about.device or 'a recording'}")
        return replace(replay(touch, recording), about=said.stamped())

    def followed(self, seen: Recording, device: HapticDevice | None = None) -> Followed:
        """How the hand followed its path on this or the configured device, where the device knows that.

        seen: what was felt, one tick of `session.EVERY`. Raises: as `feel`.
        """
        return how_followed(self.engine, self._device(device), seen)

    def preflight(
        self, device: HapticDevice | None = None, hand: Hand | None = None, loop: Loop | None = None
    ) -> Preflight:
        """What is safe and what will be felt on a device, this or the configured one; no device is opened.

        It shows itself as one sentence, and the cure of all that is wrong; it is a tuple of verdicts.

        Raises: ConfigError if there is no device or law; TangibleError as `make`.
        """
        return judge(self.flight(device, hand, loop))

    def legible(self, medium: Medium, width_m: float | None = None) -> Legibility:
        """Whether fingers can read its parts: on swell paper, as a print, on pins, or on a force device.

        width_m: of the whole picture; that of the workspace where nothing is said. The parts are those that `simplify`
        makes legible, where the pipeline has them made so.
        Raises: ConfigError for what is no medium or no width; TangibleError as `make`.
        """
        if medium not in (media := get_args(Medium)):
            raise ConfigError(
                f"medium: is {quoted(medium)}{did_you_mean(str(medium), media)}; it is {', '.join(media)}"
            )
        return legible(of_width(self.engine, width_m), medium)

    def flight(self, device: HapticDevice | None = None, hand: Hand | None = None, loop: Loop | None = None) -> Flight:
        """What the checks of `preflight` know. Raises: as `preflight`."""
        felt, law = self._device(device), self.config.render
        if law is None:
            raise self.config.missing("render")
        touch, surface = self._touch(device), fit_to_device(self.surface, self.config, felt)[0]
        return survey(
            law.method.felt(surface) if isinstance(law.method, Reshaping) else surface,
            touch,
            law.method,
            felt,
            size=self.config.size,
            safety=self.config.safety,
            scene_relief_m=self.scene.relief_m,
            of_parts=self.config.heights is not None,
            smoothed=self.scene.height is None,
            law_name=law.name,
            fitted=self.config.materials.fit == "device",
            hand=hand,
            loop=loop,
        )

    def _repr_html_(self) -> str:
        return self.plan()._repr_html_()  # pyright: ignore[reportPrivateUsage] - the name is the notebook's

    def _device(self, device: HapticDevice | None) -> HapticDevice:
        """The device as the picture sees it, by the mapping. Raises: ConfigError if there is none."""
        if device is not None:
            check_kind("device", device)
        felt = felt_device(self.engine, device)
        if felt is None:
            raise self.config.missing("device")
        return felt

    def _beacon(self, part: str | int | None) -> Beacon | None:
        """To a part of the surface, by its name or number. Raises: ConfigError if there is none such."""
        return None if part is None else beacon_to(self.surface, part)

    def _turn(self, first: "Pipeline", device: HapticDevice | None, beacon: str | int | None = None) -> Turn:
        """This one, felt on the device of a first one. Raises: ConfigError if that is another than its own."""
        ours, theirs = self.config, first.config
        own = device is None and ours.device is not None
        if ours.mapping != theirs.mapping or (own and ours.felt_device != theirs.felt_device):
            here, before = (each.config.path or each.scene.name for each in (self, first))
            raise ConfigError(
                f"{here}: has another `device:` or `mapping:` than {before}, which is felt before it; give both the "
                "same, or leave `device:` out of all but the first"
            )
        if device is None and ours.device is None and theirs.device is not None:
            device = theirs.device.method
        reliefs = None if self.scene.video is None else lambda: self.reliefs
        return Turn(self._felt(device), ours.safety, self.surface, self._beacon(beacon), reliefs)

    def _felt(self, device: HapticDevice | None) -> Touch | Film:
        """What a loop feels: of a video, a film."""
        return self._touch(device) if self.scene.video is None else self.film(device)

    def _touch(self, device: HapticDevice | None) -> Touch:
        """The law on the surface, whose materials fit this device, or the configured one."""
        return self.touch if device is None else self.engine.touch_on(device)

    def parts_felt(self, seen: Recording) -> tuple[PartFelt, ...]:
        """How long and how hard each part of the surface was touched, the longest touched first; none without parts.

        seen: what was felt, or one tick of `session.EVERY` of it. Raises: as `make`.
        """
        return parts_felt(seen, self.surface)

    def _about(self, device: HapticDevice | None) -> About:
        said = about(self.engine)
        if device is None:
            return said
        return replace(said, device=named_method("device", device, self.engine.registry).name)

    def _tell(self, report: ServoReport) -> None:
        hooks.tell(self.engine.registry.plugins, "tangible_servo_report", report=report)


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


def _in_turn(said: About, each: Sequence[About]) -> About:
    """What is said of scenes that are felt in turn."""
    configuration = "---\n".join(one.configuration for one in each)
    names = (tuple(getattr(one, which) for one in each) for which in ("parts", "materials"))
    parts, materials = ("\n".join(lines) if any(lines) else "" for lines in names)
    return replace(said, configuration=configuration, parts=parts, materials=materials)


def _both(one: Callable[[T], None], other: Callable[[T], None] | None) -> Callable[[T], None]:
    def tell(heard: T) -> None:
        one(heard)
        if other is not None:
            other(heard)

    return tell
