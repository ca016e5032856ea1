"""A run: what a pipeline wants, made and kept in a folder with its figures and its sheet."""

import platform
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from html import escape
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from ...data import DisparityMap, HapticSurface, MaterialMap, Outcomes, Record, ServoReport, Work
from ...data.products import IN_REPORT
from ...errors import ConfigError, OutputError
from ...files.json_text import write_figures
from ...files.writing import write_text
from ...mapping import intended_path, map_device, over
from ...metrics import disparity_errors
from ...plugins.interfaces import HapticDevice, Touch
from ...session import (
    EVERY,
    About,
    Recording,
    TrackingError,
    materials_text,
    names_text,
    run_simulated,
    tracking_error,
    with_parts,
)
from ..engine.cache import write_record
from ..engine.engine import Engine
from ..engine.warm_up import FELT, warm_up
from .parts_text import part_heights, to_correct
from .run_folder import CONFIG, GUESSED, NO_CONFIG, OUTCOMES, RECORDING, SHEET, check_folder, rewritten
from .showing import can_draw, drawing, png_html

Sheet = Literal["png", "svg", "pdf"]
"""What a sheet can be drawn as."""


@dataclass(frozen=True, eq=False)
class Run:
    """What a run made, and where it lies."""

    scene: str
    products: Mapping[str, Any]
    """By name: those that the report shows and the one that was wanted; None where one was skipped."""
    recording: Recording | None
    """What was felt, where a touch was wanted and the device is simulated."""
    figures: Mapping[str, Any]
    """Errors against the truth, materials and why, forces: what of it there is."""
    outcomes: Outcomes
    versions: Mapping[str, str]
    title: str
    language: str
    """Of the title and of the names of parts, as a tag."""
    files: tuple[Path, ...]
    sheet_says: str
    """What is on the sheet, in words."""

    @property
    def sheet(self) -> Path:
        """The picture of all of it. Raises: OutputError where no exporter draws sheets."""
        for path in self.files:
            if path.stem == SHEET:
                return path
        raise OutputError(f"{self.scene}: has no sheet, as no exporter named {SHEET!r} is installed")

    def _repr_html_(self) -> str:
        if self.sheet.suffix == ".png":
            return png_html(self.sheet.read_bytes(), self.sheet_says)
        return self.sheet.read_text(encoding="utf-8") if self.sheet.suffix == ".svg" else escape(self.sheet_says)

    def document(self) -> dict[str, Any]:
        """Everything but the products, as plain values."""
        return {
            "scene": self.scene,
            "title": self.title,
            "language": self.language,
            "versions": self.versions,
            "outcomes": [asdict(each) for each in self.outcomes],
            "figures": self.figures,
        }


def make_run(
    engine: Engine,
    out: Path,
    want: str,
    seconds: float,
    on_report: Callable[[ServoReport], None] | None = None,
    sheet: Sheet = "png",
) -> Run:
    """Make what is wanted, and write the results and their report into a folder, in place of an earlier run's.

    What is refused, and a folder that cannot be written, stop the run before it starts. A
    touch is felt for so many seconds of a simulated device's own time; a real device is not moved.
    Raises: OutputError if the folder cannot be written; TangibleError as `Engine.make` and `run_simulated`.
    """
    engine.check(want)
    check_folder(out, engine.config.path)
    with warm_up(engine, want) as engine.beside:
        value = engine.make_on_grid(want)
        products = {name: engine.make_on_grid(name) for name in IN_REPORT if name in engine.inputs_of(want)}
        products[want] = value
        recording = _felt(engine, value, seconds, on_report) if want == "touch" else None
    figures, config = _figures(engine, products, recording), _configuration(engine)
    kept = {f"{name}.npz": record for name, record in products.items() if isinstance(record, Record)}
    felt = [RECORDING] if recording is not None else []
    drawn = [f"{SHEET}.{sheet}"] if can_draw(engine.registry) else []
    texts = {config.name: config.text, **_guessed(engine, products)}
    files = tuple(out / name for name in (*texts, *kept, *felt, *drawn, OUTCOMES))
    with rewritten(out, engine.config.path) as place:
        for name, record in kept.items():
            write_record(place(name), record)
        if recording is not None:
            recording.save(place(RECORDING))
        says = "".join(_draw(engine, products, recording, place(name)) for name in drawn)
        said = engine.config.title, engine.config.language
        run = Run(engine.scene.name, products, recording, figures, engine.outcomes, _versions(), *said, files, says)
        for name, text in texts.items():
            write_text(place(name), text)
        write_figures(place(OUTCOMES), run.document())
    return run


class _Configuration(NamedTuple):
    name: str
    text: str


def _configuration(engine: Engine) -> _Configuration:
    """The file of the completed configuration; where no file can say it, one that says why."""
    try:
        return _Configuration(CONFIG, engine.config.as_yaml())
    except ConfigError as error:
        return _Configuration(NO_CONFIG, f"{error}\n")


def _guessed(engine: Engine, products: Mapping[str, Any]) -> dict[str, str]:
    """The file of what was guessed of parts, where anything was."""
    heights, high = engine.config.heights, products.keys() & {"relief", "surface", "touch"}
    return {GUESSED: to_correct(engine)} if heights is not None and heights.by == "guess" and high else {}


def about(engine: Engine) -> About:
    """What a recording says of the pipeline that was felt."""
    used = {kind: getattr(engine.config, kind) for kind in ("device", "render")}
    names = {kind: chosen.name if chosen else "" for kind, chosen in used.items()}
    try:
        text = engine.config.as_yaml()
    except ConfigError as error:
        text = f"# {error}"
    parts, materials = names_text(engine.config.part_names), materials_text(engine.make_on_grid("surface"))
    return About(names["device"], names["render"], text, parts=parts, materials=materials)


def felt_device(engine: Engine, device: HapticDevice | None = None) -> HapticDevice | None:
    """This or the configured device as the picture sees it, a path of its own over the surface; None where none is."""
    felt = engine.config.felt_device if device is None else map_device(device, engine.config.mapping)
    return felt and over(felt, engine.make("surface").extent_m)


def how_followed(engine: Engine, felt: HapticDevice | None, seen: Recording) -> TrackingError:
    """How the hand followed the path of a device of `felt_device`. seen: one of `EVERY` ticks."""
    path_m = felt and intended_path(felt, np.arange(len(seen.rows)) * EVERY)
    return tracking_error(seen, path_m, engine.make("surface"))


def _felt(
    engine: Engine, touch: Touch, seconds: float, on_report: Callable[[ServoReport], None] | None
) -> Recording | None:
    device = felt_device(engine)
    if device is None or not device.spec().simulated:
        return None
    said = about(engine).with_versions()
    if engine.beside is not None:
        engine.beside.wait(FELT)
    told = with_parts(engine.make_on_grid("surface"), on_report) if on_report else None
    recording = run_simulated(touch, device, seconds, told, engine.config.safety)
    return replace(recording, about=said)


def _draw(engine: Engine, products: Mapping[str, Any], recording: Recording | None, path: Path) -> str:
    scene, language = engine.scene, engine.config.language
    shown: dict[str, Any] = {name: products.get(name) for name in (*IN_REPORT, "relief")}
    if scene.truth is not None and shown["disparity"] is not None:
        shown["disparity"] = engine.make("disparity")  # pixel by pixel beside its truth
    title = engine.config.title or (Path(scene.name).name if Path(scene.name).is_absolute() else scene.name)
    if doubts := [each.text.partition(":")[0] for each in engine.outcomes.doubts]:
        title = f"{title} (doubtful: {'; '.join(doubts)})"
    extras = {"views": scene.views, "truth": scene.truth, "recording": recording}
    return drawing().draw(Work(title, language, shown, extras=extras), path)


def _figures(engine: Engine, products: Mapping[str, Any], recording: Recording | None) -> dict[str, Any]:
    figures: dict[str, Any] = {}
    truth = engine.scene.truth
    if truth is not None and isinstance(products.get("disparity"), DisparityMap):
        disparity = engine.make("disparity")
        figures["disparity"] = disparity_errors(disparity.disparity_px, truth)
    if isinstance(chosen := products.get("materials"), MaterialMap):
        figures["materials"] = {
            label: {"name": material.name, "why": why}
            for label, (material, why) in enumerate(zip(chosen.materials, chosen.reasons, strict=True))
        }
    if isinstance(surface := products.get("surface"), HapticSurface) and surface.names is not None:
        figures["parts"] = _part_figures(engine, surface)
    if recording is not None:
        figures["force"] = recording.figures()
        if said := recording.guard_sentence:
            figures["guard"] = {"says": said}
        hand = how_followed(engine, felt_device(engine), Recording(recording.rows[::EVERY]))
        if hand.says:
            figures["hand"] = hand._asdict()
    return figures


def _part_figures(engine: Engine, surface: HapticSurface) -> dict[int, dict[str, Any]]:
    """By number: the name of each part, its material, and its height with where that is from."""
    found = part_heights(engine)
    names, materials = surface.names or (), surface.materials
    return {
        number: {
            "name": name,
            "material": materials[number].name if materials else None,
            "height_m": found.heights_m[number] if found else None,
            "why": found.reasons[number] if found else "",
        }
        for number, name in enumerate(names)
    }


def _versions() -> dict[str, str]:
    named = {name: version(name) for name in ("tangible-images", "numpy", "opencv-contrib-python-headless")}
    return named | {"python": platform.python_version(), "platform": platform.platform()}
