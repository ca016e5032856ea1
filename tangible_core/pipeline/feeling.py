"""A session with a device: the surface of a pipeline checked before it is felt, felt, replayed, and looked at after."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from os import PathLike
from threading import Event
from typing import Any, Protocol, TypedDict, TypeVar, final, get_args, runtime_checkable

import numpy as np

from ..data import TICK_COLUMNS, ServoReport
from ..errors import ConfigError, did_you_mean, quoted
from ..files.paths import as_path
from ..legibility import Legibility
from ..plugins import hooks
from ..plugins.interfaces import Film, HapticDevice, Medium, Reshaping, Touch
from ..preflight import Flight, Hand, Loop, Preflight, judge, survey
from ..runtime.threads import limited_threads
from ..servo import OVER, Beacon, Servo, beacon_to
from ..session import (
    About,
    PartFelt,
    Recording,
    Slot,
    TrackingError,
    check_record_path,
    keeping,
    parts_felt,
    replay,
    run_kiosk,
    run_simulated,
    with_parts,
)
from ..session.film import ByClock, Reliefs
from .config.methods import check_kind, named_method
from .engine.engine import Engine
from .engine.film import film_of, reliefs_of
from .engine.stages.touch import fit_to_device
from .output.legible import legible, of_width
from .output.runs import about, felt_device, how_followed

T = TypeVar("T")
NO_ROWS = np.empty((0, len(TICK_COLUMNS)))
"""The rows of a recording without ticks."""


@runtime_checkable
class Felt(Protocol):
    """A pipeline, as far as a session needs it."""

    engine: Engine

    def make(self, want: str | None = None) -> Any:
        """Make a product."""
        ...


class FeelOptions(TypedDict, total=False):
    """Options of `Feeling.run` next to its seconds."""

    in_real_time: bool
    """False goes by the clock of the device, for simulated ones; True by default, in a process of its own."""
    record: str | PathLike[str] | None
    """A file (.nc, .npz, .csv) that keeps every tick while it is felt."""
    keep: Callable[[np.ndarray], None] | None
    """Called with all ticks, as rows of `TICK_COLUMNS`; the recording that is returned is then empty, and a session may
    be as long as the disk has room."""
    on_report: Callable[[ServoReport], None] | None
    """Called ten times a second, and at the end."""
    on_start: Callable[[Servo], None] | None
    """Called once a loop in real time runs."""
    stop: Event | None
    """Ends the session when it is set from another thread."""
    then: Sequence[Felt]
    """The pipelines that are felt after this one, each for `each_s`, and then this one again; in real time alone."""
    each_s: float
    """Seconds for each pipeline of `then`; 60 by default."""
    on_wait: Callable[[str], None] | None
    """Waits for a device that is missing or goes away, and is called with a sentence (`session.run_kiosk`); in real
    time alone."""
    beacon: str | int | None
    """The name or the number of a part to which the hand is pulled gently, with 1 N at most, until a button of the
    device releases it; of every scene of `then`, too."""


@final
class Feeling:
    """The surface of a pipeline on a device, the given or the configured one."""

    def __init__(self, pipeline: Felt, device: HapticDevice | None = None) -> None:
        """Nothing runs, and no device is opened yet. Raises: ArgumentError for what is not a device."""
        if device is not None:
            check_kind("device", device)
        self.pipeline = pipeline
        self.engine = pipeline.engine
        self.given = device

    @property
    def device(self) -> HapticDevice:
        """The device as the picture sees it, by the mapping. Raises: ConfigError if there is none."""
        device = felt_device(self.engine, self.given)
        if device is None:
            raise self.engine.config.missing("device")
        return device

    @property
    def touch(self) -> Touch:
        """The force law on the surface, whose materials fit the device. Raises: TangibleError as `Pipeline.make`."""
        return self.pipeline.make("touch") if self.given is None else self.engine.touch_on(self.given)

    @property
    def reliefs(self) -> Reliefs:
        """The frames of a scene that is a video, as reliefs; not open yet.

        `with feeling.reliefs as reliefs: for number, time_s, relief in reliefs:` makes one after the other, steady in
        time and of one scale; without end where the video repeats. `reliefs.frames.at` skips to the frame that is due,
        and `reliefs.made` makes its relief.
        Raises: ConfigError for a scene that does not move, or a relief that is made of parts.
        """
        return reliefs_of(self.engine.config, self.engine.scene)

    def film(self, period_s: float = 0.001) -> Film:
        """Make the touch of the video's first frame, as a film that goes on from there.

        It is given to a `Servo` or to `session.run_simulated` like a touch, and shown the `reliefs`; `run` does both.
        period_s: of the loop that feels it.
        Raises: ConfigError for a scene that does not move, or a force law without films; TangibleError as `make`.
        """
        config = self.engine.config
        return film_of(self.engine, config.felt_device if self.given is None else self.device, period_s)

    def run(
        self,
        seconds: float | None = 8.0,
        *,
        in_real_time: bool = True,
        record: str | PathLike[str] | None = None,
        keep: Callable[[np.ndarray], None] | None = None,
        on_report: Callable[[ServoReport], None] | None = None,
        on_start: Callable[[Servo], None] | None = None,
        stop: Event | None = None,
        then: Sequence[Felt] = (),
        each_s: float = 60.0,
        on_wait: Callable[[str], None] | None = None,
        beacon: str | int | None = None,
    ) -> Recording:
        """Feel the surface, and return the recording.

        Ctrl-C, `stop` set from another thread, and a device that fails end it: the force is zero, and the recording
        says why. A scene that is a video plays while it is felt, by the clock of the device where that is simulated;
        its parts and materials stay those of the first frame. `ServoReport.film` says how it plays.
        seconds: None goes on until something ends it; in real time alone. The others: see `FeelOptions`.
        Raises: ConfigError if there is no device or force law, or no such part, or others of `then` have another
        device; DeviceError if it cannot be opened; OutputError for the file.
        """
        file = None if record is None else as_path(record, "record")
        if file is not None:
            check_record_path(file, seconds is None)
        device, said = self.device, self._about()
        tell = _both(self._report, on_report)
        if not in_real_time:
            if then or on_wait:
                raise ConfigError(
                    "then, on_wait: are for a session in real time; leave them out, or in_real_time=False"
                )
            simulated = self._run_simulated(device, math.inf if seconds is None else seconds, tell, stop, beacon)
            simulated = replace(simulated, about=said.with_versions())
            if file is not None:
                simulated.save(file)
            return simulated

        turns = [self._turn(self, beacon), *(Feeling(each, self.given)._turn(self, beacon) for each in then)]
        said = _in_turn(said, [Feeling(each)._about() for each in (self.pipeline, *then)])

        def run(rows: Callable[[np.ndarray], None]) -> str:
            report = run_kiosk(
                turns, device, seconds, each_s if then else math.inf, on_report=tell, keep=rows, on_start=on_start,
                on_wait=on_wait, stop=stop, threads=self.engine.threads,
            )  # fmt: skip
            return "" if report.stopped == OVER else report.stopped

        if file is not None:
            with keeping(file, said) as writer:
                stopped = run(_both(writer.append, keep))
                writer.close(stopped)
            return Recording.load(file) if keep is None else Recording(NO_ROWS, stopped, said.with_versions())
        rows = [NO_ROWS]
        stopped = run(keep or rows.append)
        return Recording(np.concatenate(rows), stopped, said.with_versions())

    def _run_simulated(
        self,
        device: HapticDevice,
        seconds: float,
        tell: Callable[[ServoReport], None],
        stop: Event | None,
        beacon: str | int | None,
    ) -> Recording:
        """Feel by the clock of a simulated device."""
        tell = with_parts(self.pipeline.make("surface"), tell)
        touch, how = self._touch_or_film(), (self.engine.config.safety, stop, self._beacon(beacon))
        if not isinstance(touch, Film):
            return run_simulated(touch, device, seconds, tell, *how)
        with self.reliefs as reliefs, limited_threads(self.engine.threads):
            frames = ByClock(reliefs, touch)
            return run_simulated(touch, device, seconds, frames.with_counts(tell), *how, frames=frames)

    def replay(self, recording: Recording | str | PathLike[str]) -> Recording:
        """Return the forces of this pipeline's law for each recorded state; nothing limits them.

        recording: or the file of one. `session.compared` says how far the forces are from the recorded ones.
        Raises: as `Pipeline.make`, and OutputError for a file that cannot be read.
        """
        recording = recording if isinstance(recording, Recording) else Recording.load(recording)
        said = replace(about(self.engine), device=f"replay of {recording.about.device or 'a recording'}")
        return replace(replay(self.touch, recording), about=said.with_versions())

    def track(self, seen: Recording) -> TrackingError:
        """Return how the hand followed its path on the device, where the device knows that.

        seen: the ticks, one of `session.EVERY`. Raises: as `run`.
        """
        return how_followed(self.engine, self.device, seen)

    def parts_felt(self, seen: Recording) -> tuple[PartFelt, ...]:
        """Return how long and how hard each part was touched, the longest touched first; none without parts.

        seen: the ticks, or one of `session.EVERY`. Raises: as `Pipeline.make`.
        """
        return parts_felt(seen, self.pipeline.make("surface"))

    def legible(self, medium: Medium, width_m: float | None = None) -> Legibility:
        """Check whether fingers can read the parts: on swell paper, as a print, on pins, or on a force device.

        width_m: of the whole picture; that of the workspace by default. The parts are those that `simplify` makes
        legible, where the pipeline has them made so.
        Raises: ConfigError for an unknown medium or width; TangibleError as `Pipeline.make`.
        """
        if medium not in (media := get_args(Medium)):
            raise ConfigError(
                f"medium: is {quoted(medium)}{did_you_mean(str(medium), media)}; it is {', '.join(media)}"
            )
        return legible(of_width(self.engine, width_m), medium)

    def preflight(self, hand: Hand | None = None, loop: Loop | None = None) -> Preflight:
        """Judge what is safe and what will be felt on the device; it is not opened.

        Raises: ConfigError if there is no device or force law; TangibleError as `Pipeline.make`.
        """
        return judge(self.flight(hand, loop))

    def flight(self, hand: Hand | None = None, loop: Loop | None = None) -> Flight:
        """Measure what the checks of `preflight` judge. Raises: as `preflight`."""
        device, config = self.device, self.engine.config
        law = config.render
        if law is None:
            raise config.missing("render")
        touch, surface = self.touch, fit_to_device(self.pipeline.make("surface"), config, device)[0]
        return survey(
            law.method.felt(surface) if isinstance(law.method, Reshaping) else surface,
            touch,
            law.method,
            device,
            size=config.size,
            safety=config.safety,
            scene_relief_m=self.engine.scene.relief_m,
            of_parts=config.heights is not None,
            smoothed=self.engine.scene.height is None,
            law_name=law.name,
            fitted=config.materials.fit == "device",
            hand=hand,
            loop=loop,
        )

    def _turn(self, first: "Feeling", beacon: str | int | None) -> Slot:
        """Return the turn of this scene on the device of the first one. Raises: ConfigError for another device."""
        ours, theirs = self.engine.config, first.engine.config
        own = self.given is None and ours.device is not None
        if ours.mapping != theirs.mapping or (own and ours.felt_device != theirs.felt_device):
            here, before = (each.engine.config.path or each.engine.scene.name for each in (self, first))
            raise ConfigError(
                f"{here}: has another `device:` or `mapping:` than {before}, which is felt before it; give both the "
                "same, or leave `device:` out of all but the first"
            )
        on = self
        if self.given is None and ours.device is None and theirs.device is not None:
            on = Feeling(self.pipeline, theirs.device.method)
        reliefs = None if self.engine.scene.frames is None else lambda: self.reliefs
        return Slot(on._touch_or_film(), ours.safety, self.pipeline.make("surface"), self._beacon(beacon), reliefs)

    def _touch_or_film(self) -> Touch | Film:
        """Return what a loop feels: of a video, a film."""
        return self.touch if self.engine.scene.frames is None else self.film()

    def _beacon(self, part: str | int | None) -> Beacon | None:
        """Return the beacon to a part, by its name or number. Raises: ConfigError for an unknown part."""
        return None if part is None else beacon_to(self.pipeline.make("surface"), part)

    def _about(self) -> About:
        said = about(self.engine)
        if self.given is None:
            return said
        return replace(said, device=named_method("device", self.given, self.engine.registry).name)

    def _report(self, report: ServoReport) -> None:
        hooks.tell(self.engine.registry.plugins, "tangible_servo_report", report=report)


def _in_turn(said: About, each: Sequence[About]) -> About:
    """Return the description of scenes that are felt in turn."""
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
