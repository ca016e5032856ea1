"""A session with a device on the surface of a pipeline: preflight, the session itself, replay and reports."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from os import PathLike
from threading import Event
from typing import TypeVar, cast, final

import numpy as np

from .. import session
from ..data import TICK_COLUMNS, ServoReport
from ..data.arguments import named_options
from ..errors import ConfigError
from ..files.paths import as_path, without_folders
from ..plugins.failures import naming_plugins
from ..plugins.interfaces import Film, HapticDevice, Medium, Reshaping, Touch
from ..preflight import Flight, Hand, Legibility, Loop, Preflight, Settings, judge, survey
from ..runtime.threads import limited_threads
from ..servo import OVER, Beacon, Servo, beacon_to
from ..session import About, PartFelt, Recording, Slot, TrackingError
from ..session.film import ByClock, Reliefs
from .config.methods import check_kind, named_method
from .engine.engine import Engine
from .engine.film import make_film, make_reliefs
from .engine.stages.touch import fit_to_device
from .feel_options import Felt
from .output.legible import drawn_parts, drawn_width_m, exporter_for, legible
from .output.runs import about, device_in_workspace, join_descriptions, path_tracking, tell_report

T = TypeVar("T")
NO_ROWS = np.empty((0, len(TICK_COLUMNS)))


@final
class Feeling:
    """The surface of a pipeline on the given device, or on the configured one."""

    def __init__(self, pipeline: Felt, device: HapticDevice | str | None = None) -> None:
        """Keep both; nothing runs, and no device is opened yet.

        device: an object, or the name of an installed device with its default options.
        Raises: ConfigError for an object of another kind; UnknownMethod, BrokenMethod.
        """
        if isinstance(device, str):
            device = cast("HapticDevice", pipeline.engine.registry.load("device", device)())
        if device is not None:
            check_kind("device", device)
        self.pipeline = pipeline
        self.engine: Engine = pipeline.engine
        self.own_device = device

    @property
    def device(self) -> HapticDevice:
        """The device in the picture's frame, by the mapping. Raises: ConfigError without a device."""
        device = device_in_workspace(self.engine, self.own_device)
        if device is None:
            raise self.engine.config.missing("device")
        return device

    @property
    def touch(self) -> Touch:
        """The force law on the surface, with materials that fit the device. Raises: as `Pipeline.make`."""
        return self.pipeline.make("touch") if self.own_device is None else self.engine.touch_on(self.own_device)

    @property
    def reliefs(self) -> Reliefs:
        """The frames of a video as reliefs; not open yet.

        `with feeling.reliefs as reliefs: for number, time_s, relief in reliefs:` makes one after the other, steady in
        time and of one scale; without end where the video repeats. `reliefs.frames.at` skips to the frame that is due,
        and `reliefs.made` makes its relief.
        Raises: ConfigError for a scene without a video, or a relief that is made of parts.
        """
        return make_reliefs(self.engine.config, self.engine.scene)

    def film(self, period_s: float = 0.001) -> Film:
        """Make the touch of the video's first frame, as a film for the next ones.

        A `Servo` or `session.run_simulated` takes it like a touch, and it is shown the `reliefs`; `run` does both.
        period_s: of the force loop.
        Raises: ConfigError for a scene without a video, or a force law without films; TangibleError as `make`.
        """
        config = self.engine.config
        return make_film(self.engine, config.felt_device if self.own_device is None else self.device, period_s)

    @named_options
    @naming_plugins()
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
        """Run a session, and return its recording.

        Ctrl-C, `stop`, and a device that fails end it: the force is zero, and the recording has the reason. A video
        plays during the session, by the clock of a simulated device; its parts and materials stay those of the first
        frame. `ServoReport.film` reports how it plays.
        seconds: None goes on until something ends it; in real time only. The others: see `FeelOptions`.
        Raises: ConfigError without a device or force law, for an unknown part, or if others of `then` have another
        device; DeviceError if it cannot be opened; OutputError for the file.
        """
        file = None if record is None else as_path(record, "record")
        if file is not None:
            session.check_record_path(file, seconds is None)
        device, about_session = self.device, self._about()
        listener = _both(partial(tell_report, self.engine), on_report)
        if not in_real_time:
            if then or on_wait:
                raise ConfigError(
                    "then, on_wait: are for a session in real time; leave them out, or in_real_time=False"
                )
            recording = self._run_simulated(device, math.inf if seconds is None else seconds, listener, stop, beacon)
            recording = replace(recording, about=about_session.with_versions())
            if file is not None:
                recording.save(file)
            return recording

        turns = [
            self._turn(self, beacon),
            *(Feeling(pipeline, self.own_device)._turn(self, beacon) for pipeline in then),
        ]
        about_session = join_descriptions(
            about_session, [Feeling(pipeline)._about() for pipeline in (self.pipeline, *then)]
        )

        def run(rows: Callable[[np.ndarray], None]) -> str:
            report = session.run_kiosk(
                turns, device, seconds, each_s if then else math.inf, on_report=listener, keep=rows, on_start=on_start,
                on_wait=on_wait, stop=stop, threads=self.engine.threads,
            )  # fmt: skip
            return "" if report.stopped == OVER else report.stopped

        if file is not None:
            with session.keeping(file, about_session) as writer:
                reason = run(_both(writer.append, keep))
                writer.close(reason)
            return Recording.load(file) if keep is None else Recording(NO_ROWS, reason, about_session.with_versions())
        rows = [NO_ROWS]
        reason = run(keep or rows.append)
        return Recording(np.concatenate(rows), reason, about_session.with_versions())

    def _run_simulated(
        self,
        device: HapticDevice,
        seconds: float,
        listener: Callable[[ServoReport], None],
        stop: Event | None,
        beacon: str | int | None,
    ) -> Recording:
        listener = session.with_parts(self.pipeline.make("surface"), listener)
        touch, options = self._touch_or_film(), (self.engine.config.safety, stop, self._beacon(beacon))
        if not isinstance(touch, Film):
            return session.run_simulated(touch, device, seconds, listener, *options)
        with self.reliefs as reliefs, limited_threads(self.engine.threads):
            frames = ByClock(reliefs, touch)
            return session.run_simulated(touch, device, seconds, frames.with_counts(listener), *options, frames=frames)

    def replay(self, recording: Recording | str | PathLike[str]) -> Recording:
        """Return the forces of this pipeline's force law for each recorded state, without limits.

        recording: or its file. `session.compared` measures the distance of the forces from the recorded ones.
        Raises: as `Pipeline.make`, and OutputError for a file that cannot be read.
        """
        recording = recording if isinstance(recording, Recording) else Recording.load(recording)
        about_replay = replace(about(self.engine), device=f"replay of {recording.about.device or 'a recording'}")
        return replace(session.replay(self.touch, recording), about=about_replay.with_versions())

    def track(self, ticks: Recording) -> TrackingError:
        """Report how well the hand tracked the device's path, if it has one. ticks: one of `session.EVERY` ticks."""
        return path_tracking(self.engine, self.device, ticks)

    def parts_felt(self, ticks: Recording) -> tuple[PartFelt, ...]:
        """Return how long and how hard each part was touched, the longest first; none without parts.

        ticks: the ticks, or one of `session.EVERY`. Raises: as `Pipeline.make`.
        """
        return session.parts_felt(ticks, self.pipeline.make("surface"))

    def legible(self, medium: Medium = "force", width_m: float | None = None) -> Legibility:
        """Check whether fingers can read the parts: on swell paper, as a print, on pins, or on a force device.

        width_m: of the whole picture; by default as export draws it, `width_on`. The simplified parts are judged where
        `is_simplified_on` this medium.
        Raises: ConfigError for an unknown medium or width; TangibleError as `Pipeline.make`.
        """
        return legible(self.engine, medium, width_m)

    def width_on(self, medium: Medium) -> float:
        """Return the width of the whole picture on a medium, m, as export draws it; on a device, the workspace's."""
        return drawn_width_m(self.engine, exporter_for(self.engine, medium))

    def is_simplified_on(self, medium: Medium) -> bool:
        """Return True if parts are simplified on a medium: by `simplify`, or because its exporter draws no others."""
        return drawn_parts(self.engine, exporter_for(self.engine, medium)) == "simplified"

    def preflight(self, hand: Hand | None = None, loop: Loop | None = None) -> Preflight:
        """Judge the safety and the quality of the surface on the device, which is not opened.

        Raises: ConfigError without a device or force law; TangibleError as `Pipeline.make`.
        """
        return judge(self.flight(hand, loop))

    def flight(self, hand: Hand | None = None, loop: Loop | None = None) -> Flight:
        """Measure the quantities that `preflight` judges. Raises: as `preflight`."""
        device, config = self.device, self.engine.config
        law = config.render
        if law is None:
            raise config.missing("render")
        touch, surface = self.touch, fit_to_device(self.pipeline.make("surface"), config, device)[0]
        settings = Settings(
            config.size,
            config.safety,
            scene_relief_m=self.engine.scene.relief_m,
            exaggeration=None if config.workspace.scale is None else config.workspace.exaggeration,
            of_parts=config.heights is not None,
            smoothed=self.engine.scene.height is None,
            slope=config.relief.slope if config.relief_kind in ("depth", "edges", "figure", "lines") else None,
            law_name=law.name,
            fitted=config.materials.fit == "device",
        )
        return survey(
            law.method.felt(surface) if isinstance(law.method, Reshaping) else surface,
            touch,
            law.method,
            device,
            settings,
            hand=hand,
            loop=loop,
        )

    def _turn(self, first: "Feeling", beacon: str | int | None) -> Slot:
        """Return the turn of this scene on the device of the first one. Raises: ConfigError for another device."""
        ours, theirs = self.engine.config, first.engine.config
        own = self.own_device is None and ours.device is not None
        if ours.mapping != theirs.mapping or (own and ours.felt_device != theirs.felt_device):
            here, before = (feeling.engine.config.path or feeling.engine.scene.name for feeling in (self, first))
            raise ConfigError(
                f"{here}: has another `device:` or `mapping:` than {before}, which comes before it; give both the "
                "same, or leave `device:` out of all but the first"
            )
        on = self
        if self.own_device is None and ours.device is None and theirs.device is not None:
            on = Feeling(self.pipeline, theirs.device.method)
        reliefs = None if self.engine.scene.frames is None else lambda: self.reliefs
        touch, surface = on._touch_or_film(), self.pipeline.make("surface")
        name = ours.path.name if ours.path else without_folders(self.engine.scene.name)
        return Slot(touch, ours.safety, surface, self._beacon(beacon), reliefs, name)

    def _touch_or_film(self) -> Touch | Film:
        return self.touch if self.engine.scene.frames is None else self.film()

    def _beacon(self, part: str | int | None) -> Beacon | None:
        """Return the beacon to a part, by its name or number. Raises: ConfigError for an unknown part."""
        return None if part is None else beacon_to(self.pipeline.make("surface"), part)

    def _about(self) -> About:
        about_pipeline = about(self.engine)
        if self.own_device is None:
            return about_pipeline
        return replace(about_pipeline, device=named_method("device", self.own_device, self.engine.registry).name)


def _both(one: Callable[[T], None], other: Callable[[T], None] | None) -> Callable[[T], None]:
    def call(value: T) -> None:
        one(value)
        if other is not None:
            other(value)

    return call
