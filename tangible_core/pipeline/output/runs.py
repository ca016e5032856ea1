"""Runs: the wanted product of a pipeline, kept in a folder with its figures and its sheet."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from html import escape
from importlib.metadata import version
from pathlib import Path
from textwrap import indent
from typing import Any, Literal, get_args

import numpy as np

from ...data import DisparityMap, HapticSurface, MaterialMap, Outcomes, Record, ServoReport, Work
from ...data.products import IN_REPORT
from ...errors import ConfigError, OutputError, did_you_mean, wrong_argument
from ...files.json_text import write_figures
from ...files.paths import without_folders
from ...files.writing import sole_writer, write_text
from ...mapping import intended_path, map_device, over
from ...metrics import disparity_errors
from ...plugins import hooks
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
from .result_folders import CONFIG, GUESSED, MANIFEST, NO_CONFIG, OUTCOMES, RECORDING, SHEET, check_folder, rewriting
from .showing import can_draw, drawing, png_html

Sheet = Literal["png", "svg", "pdf"]


@dataclass(frozen=True, eq=False)
class Run:
    """The results of a run and their files."""

    scene: str
    products: Mapping[str, Any]
    """The products of the report and the wanted one, by name; None for a skipped product."""
    recording: Recording | None
    """The session of a wanted touch on a simulated device."""
    figures: Mapping[str, Any]
    """Errors against the truth, materials with reasons, and forces, as far as the run has them."""
    outcomes: Outcomes
    versions: Mapping[str, str]
    title: str
    language: str
    """The language of the title and of the names of parts, as a tag."""
    files: tuple[Path, ...]
    sheet_says: str
    """The description of the sheet."""

    @property
    def sheet(self) -> Path:
        """The file of the sheet. Raises: OutputError where no exporter draws sheets."""
        for path in self.files:
            if path.stem == SHEET:
                return path
        raise OutputError(f"{self.scene}: has no sheet, as no exporter named {SHEET!r} is installed")

    def __repr__(self) -> str:
        names = [name for name, value in self.products.items() if value is not None]
        return f"Run of {self.scene}: {', '.join(names)}, in {self.files[0].parent}"

    def _repr_html_(self) -> str:
        if self.sheet.suffix == ".png":
            return png_html(self.sheet.read_bytes(), self.sheet_says)
        return self.sheet.read_text(encoding="utf-8") if self.sheet.suffix == ".svg" else escape(self.sheet_says)

    def document(self) -> dict[str, Any]:
        """Return everything but the products, as plain values."""
        return {
            "scene": self.scene,
            "title": self.title,
            "language": self.language,
            "versions": self.versions,
            "outcomes": [asdict(outcome) for outcome in self.outcomes],
            "figures": self.figures,
        }


def make_run(engine: Engine, out: Path, want: str, seconds: float, sheet: Sheet = "png") -> Run:
    """Make the wanted product, and write the results and their report into a folder in place of an earlier run's."""
    if sheet not in (kinds := get_args(Sheet)):
        raise wrong_argument("sheet", sheet, f"one of {', '.join(kinds)}{did_you_mean(str(sheet), kinds)}")
    engine.check(want)
    with sole_writer(out / MANIFEST):
        check_folder(out, engine.config.path)
        return _make_run(engine, out, want, seconds, sheet)


def _make_run(engine: Engine, out: Path, want: str, seconds: float, sheet: Sheet) -> Run:
    with warm_up(engine, want) as engine.compiler:
        value = engine.make_on_grid(want)
        products = {name: engine.make_on_grid(name) for name in IN_REPORT if name in engine.all_inputs(want)}
        products[want] = value
        recording = _run_touch(engine, value, seconds) if want == "touch" else None
    figures, config_file = _figures(engine, products, recording), _config_file(engine)
    records = {f"{name}.npz": record for name, record in products.items() if isinstance(record, Record)}
    recordings = [RECORDING] if recording is not None else []
    sheets = [f"{SHEET}.{sheet}"] if can_draw(engine.registry) else []
    heights, high = engine.config.heights, products.keys() & {"relief", "surface", "touch"}
    guesses = {GUESSED: to_correct(engine)} if heights is not None and heights.by == "guess" and high else {}
    texts = {**config_file, **guesses}
    files = tuple(out / name for name in (*texts, *records, *recordings, *sheets, OUTCOMES))
    with rewriting(out, engine.config.path) as place:
        for name, record in records.items():
            write_record(place(name), record)
        if recording is not None:
            recording.save(place(RECORDING))
        about_sheet = "".join(_draw(engine, products, recording, place(name)) for name in sheets)
        versions = {name: version(name) for name in ("tangible-images", "numpy", "opencv-contrib-python-headless")}
        versions |= {"python": platform.python_version(), "platform": platform.platform()}
        run = Run(
            engine.scene.name, products, recording, figures, engine.outcomes, versions, engine.config.title,
            engine.config.language, files, about_sheet,
        )  # fmt: skip
        for name, text in texts.items():
            write_text(place(name), text)
        write_figures(place(OUTCOMES), run.document())
    return run


def _config_file(engine: Engine) -> dict[str, str]:
    """Return the completed configuration, or the reason why no file can have it, by the name of its file."""
    try:
        return {CONFIG: engine.config.as_yaml()}
    except ConfigError as error:
        return {NO_CONFIG: f"{error}\n"}


def about(engine: Engine) -> About:
    """Describe the pipeline for a recording."""
    methods = {kind: getattr(engine.config, kind) for kind in ("device", "render")}
    names = {kind: method.name if method else "" for kind, method in methods.items()}
    try:
        text = engine.config.as_yaml()
    except ConfigError as error:
        text = indent(str(error), "# ")
    parts, materials = names_text(engine.config.part_names), materials_text(engine.make_on_grid("surface"))
    return About(names["device"], names["render"], text, parts=parts, materials=materials)


def join_descriptions(first: About, each: Sequence[About]) -> About:
    """Describe scenes that follow one another in one recording."""
    configuration = "---\n".join(one.configuration for one in each)
    names = (tuple(getattr(one, which) for one in each) for which in ("parts", "materials"))
    parts, materials = ("\n".join(lines) if any(lines) else "" for lines in names)
    return replace(first, configuration=configuration, parts=parts, materials=materials)


def device_in_workspace(engine: Engine, device: HapticDevice | None = None) -> HapticDevice | None:
    """Place the device, or the configured one, over the surface, in the picture's frame; None without a device."""
    frame_device = engine.config.felt_device if device is None else map_device(device, engine.config.mapping)
    return frame_device and over(frame_device, engine.make("surface").extent_m)


def path_tracking(engine: Engine, device: HapticDevice | None, ticks: Recording) -> TrackingError:
    """Report how well the path of a device of `device_in_workspace` was tracked. ticks: one of `EVERY`."""
    path_m = device and intended_path(device, np.arange(len(ticks.rows)) * EVERY)
    return tracking_error(ticks, path_m, engine.make("surface"))


def tell_report(engine: Engine, report: ServoReport) -> None:
    """Tell a report of the force loop to the installed hooks."""
    hooks.tell(engine.registry.plugins, "tangible_servo_report", report=report)


def _run_touch(engine: Engine, touch: Touch, seconds: float) -> Recording | None:
    """Run a touch on the configured device; None without a simulated one."""
    device = device_in_workspace(engine)
    if device is None or not device.spec().simulated:
        return None
    description = about(engine).with_versions()
    if engine.compiler is not None:
        engine.compiler.wait(FELT)
    listener = with_parts(engine.make_on_grid("surface"), partial(tell_report, engine))
    recording = run_simulated(touch, device, seconds, listener, engine.config.safety)
    return replace(recording, about=description)


def _draw(engine: Engine, products: Mapping[str, Any], recording: Recording | None, path: Path) -> str:
    scene, language = engine.scene, engine.config.language
    products_shown: dict[str, Any] = {name: products.get(name) for name in (*IN_REPORT, "relief")}
    if scene.truth is not None and products_shown["disparity"] is not None:
        products_shown["disparity"] = engine.make("disparity")  # pixel by pixel next to its truth
    title = engine.config.title or without_folders(scene.name)
    if doubts := [doubt.text.partition(":")[0] for doubt in engine.outcomes.doubts]:
        title = f"{title} (doubtful: {'; '.join(doubts)})"
    extras = {"views": scene.views, "truth": scene.truth, "recording": recording}
    return drawing().draw(Work(title, language, products_shown, extras=extras), path)


def _figures(engine: Engine, products: Mapping[str, Any], recording: Recording | None) -> dict[str, Any]:
    figures: dict[str, Any] = {}
    truth = engine.scene.truth
    if truth is not None and isinstance(products.get("disparity"), DisparityMap):
        disparity = engine.make("disparity")
        figures["disparity"] = disparity_errors(disparity.disparity_px, truth)
    if isinstance(material_map := products.get("materials"), MaterialMap):
        figures["materials"] = {
            label: {"name": material.name, "why": why}
            for label, (material, why) in enumerate(zip(material_map.materials, material_map.reasons, strict=True))
        }
    if says := [note.text for note in engine.on_heights if note.kind == "decision"]:
        figures["heights"] = {"says": says}
    if isinstance(surface := products.get("surface"), HapticSurface) and surface.names is not None:
        figures["parts"] = _part_figures(engine, surface)
    if recording is not None:
        figures["force"] = recording.figures()
        if sentence := recording.guard_sentence:
            figures["guard"] = {"says": sentence}
        hand = path_tracking(engine, device_in_workspace(engine), Recording(recording.rows[::EVERY]))
        if hand.says:
            figures["hand"] = hand._asdict()
    return figures


def _part_figures(engine: Engine, surface: HapticSurface) -> dict[int, dict[str, Any]]:
    """Return name, material, height and the reason of the height for each part, by number."""
    heights = part_heights(engine)
    names, materials = surface.names or (), surface.materials
    return {
        number: {
            "name": name,
            "material": materials[number].name if materials else None,
            "height_m": heights.heights_m[number] if heights else None,
            "why": heights.reasons[number] if heights else "",
        }
        for number, name in enumerate(names)
    }
