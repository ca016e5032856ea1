"""`demo`, `run`, `plan`: a pipeline from file to report."""

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from importlib.resources import files
from io import StringIO
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from .. import session
from ..data import MaterialMap, Record, ServoReport
from ..errors import ConfigError
from ..files.writing import write_text
from ..pipeline.cache import Cache, write_record
from ..pipeline.config import Chosen, parse_config
from ..pipeline.engine import Pipeline, load_pipeline
from ..plugins import hooks
from ..plugins.interfaces import HapticDevice
from ..plugins.registry import default_registry
from ..report import disparity_errors, draw_sheet, write_figures
from ..session import Recording
from . import show

Figures = Mapping[Any, Any]
SHOWN = ("disparity", "segments", "materials", "surface")
"""Products that the report draws, beside what is wanted."""


@dataclass(frozen=True)
class Results:
    """What a run made, and where it lies."""

    figures: dict[str, Any]
    files: list[Path]


def demo(out: Path, seconds: float, as_json: bool, cached: bool) -> None:
    """Run the embedded example."""
    text = files("tangible_core").joinpath("demo.yaml").read_text(encoding="utf-8")
    config = parse_config(text, Path("demo.yaml"), default_registry())
    pipeline = Pipeline(config, default_registry(), Cache() if cached else None)
    results = execute(pipeline, out, seconds)
    _print(pipeline, results, as_json)
    if not as_json:
        show.say(NEXT.format(config=out / "config.yaml"))


NEXT = """
Next:
  tangible plan {config}              what a run does and why, without running it
  tangible feel {config} --seconds 5  the same surface on the configured device
  tangible run {config} --set render.use=grey-level   the report's own law, to compare
  tangible plugins                    what else there is to put into `use:`"""


def run(config: Path, sets: Sequence[str], out: Path | None, seconds: float, as_json: bool, cached: bool) -> None:
    """Make what the file wants."""
    pipeline = open_pipeline(config, sets, cached)
    _print(pipeline, execute(pipeline, out or Path("out") / config.stem, seconds), as_json)


def plan(config: Path, sets: Sequence[str], as_json: bool, cached: bool) -> None:
    """Say what would be made."""
    steps = open_pipeline(config, sets, cached).plan().steps
    if as_json:
        show.print_json(show.as_rows(steps))
    else:
        show.outcomes(steps, ran="to run")


def open_pipeline(config: Path, sets: Sequence[str], cached: bool) -> Pipeline:
    """The pipeline of a file, with or without the user's cache."""
    pipeline = load_pipeline(config, sets)
    if not cached:
        pipeline.cache = None
    return pipeline


def device_of(pipeline: Pipeline) -> Chosen[HapticDevice]:
    """The device that the file names, seen through its mapping. Raises: ConfigError if it names none."""
    device, felt = pipeline.config.device, pipeline.config.felt_device
    if device is None or felt is None:
        raise ConfigError(f"{pipeline.config.path}: `device:` is missing; add one, such as `device: {{use: mock}}`")
    return replace(device, method=felt)


def execute(pipeline: Pipeline, out: Path, seconds: float) -> Results:
    """Make what the configuration wants, and write the results and their report into a folder.

    The completed configuration is written first: a folder that cannot be written stops the run before it starts.
    """
    write_text(out / "config.yaml", _as_yaml(pipeline))
    written = [out / "config.yaml"]
    pipeline.plan()
    with session.rehearsal(pipeline) as pipeline.beside:
        value = pipeline.make()
        products = {name: pipeline.make(name) for name in SHOWN if _concerns(pipeline, name)}
        products[pipeline.config.want] = value
        recording = _feel(pipeline, value, seconds)
    for name, record in products.items():
        if isinstance(record, Record):
            write_record(out / f"{name}.npz", record)
            written.append(out / f"{name}.npz")
    if recording is not None:
        recording.save(out / "recording.npz")
        written.append(out / "recording.npz")
    figures = _figures(pipeline, products, recording)
    written += [_draw(pipeline, products, recording, out / "sheet.png")]
    write_figures(out / "outcomes.json", _document(pipeline, figures))
    return Results(figures, [*written, out / "outcomes.json"])


def _concerns(pipeline: Pipeline, product: str) -> bool:
    """Whether what is wanted is made from this product, as the rules say."""
    return product in pipeline.needed(pipeline.config.want)


def _feel(pipeline: Pipeline, value: Any, seconds: float) -> Recording | None:
    device = pipeline.config.felt_device
    if pipeline.config.want != "touch" or device is None or not device.spec().simulated:
        return None
    said = about(pipeline).stamped()
    if pipeline.beside is not None:
        pipeline.beside.wait(session.FELT)
    recording = session.run(value, device, seconds, tell_of(pipeline), pipeline.config.safety)
    return replace(recording, about=said)


def tell_of(pipeline: Pipeline) -> Callable[[ServoReport], None]:
    """What passes the reports of a loop on to the observers."""

    def tell(report: ServoReport) -> None:
        hooks.tell(pipeline.registry.plugins, "tangible_servo_report", report=report)

    return tell


def about(pipeline: Pipeline) -> session.About:
    """What a recording says of the pipeline that was felt."""
    used = {kind: getattr(pipeline.config, kind) for kind in ("device", "render")}
    names = {kind: chosen.name if chosen else "" for kind, chosen in used.items()}
    return session.About(names["device"], names["render"], _as_yaml(pipeline))


def _as_yaml(pipeline: Pipeline) -> str:
    """The completed configuration."""
    yaml, text = YAML(typ="safe"), StringIO()
    yaml.default_flow_style = False
    yaml.sort_base_mapping_type_on_output = False  # pyright: ignore[reportAttributeAccessIssue]
    yaml.dump(pipeline.config.completed(), text)  # pyright: ignore[reportUnknownMemberType]
    return text.getvalue()


def _draw(pipeline: Pipeline, products: Mapping[str, Any], recording: Recording | None, path: Path) -> Path:
    scene = pipeline.scene
    draw_sheet(path, views=scene.views, truth=scene.truth, recording=recording, title=scene.name,
               **{name: products.get(name) for name in (*SHOWN, "relief")})  # fmt: skip
    return path


def _figures(pipeline: Pipeline, products: Mapping[str, Any], recording: Recording | None) -> dict[str, Any]:
    figures: dict[str, Any] = {}
    truth, disparity = pipeline.scene.truth, products.get("disparity")
    if truth is not None and disparity is not None:
        figures["disparity"] = disparity_errors(disparity.disparity_px, truth)
    if isinstance(chosen := products.get("materials"), MaterialMap):
        figures["materials"] = {
            label: {"name": material.name, "why": why}
            for label, (material, why) in enumerate(zip(chosen.materials, chosen.reasons, strict=True))
        }
    if recording is not None:
        figures["force"] = recording.figures()
    return figures


def _document(pipeline: Pipeline, figures: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "scene": pipeline.scene.name,
        "versions": {name: version(name) for name in ("tangible-images", "numpy", "opencv-contrib-python-headless")}
        | {"python": platform.python_version(), "platform": platform.platform()},
        "outcomes": show.as_rows(pipeline.outcomes),
        "figures": figures,
    }


def _print(pipeline: Pipeline, results: Results, as_json: bool) -> None:
    if as_json:
        show.print_json({**_document(pipeline, results.figures), "files": [str(path) for path in results.files]})
        return
    show.outcomes(pipeline.outcomes, f"[bold]{pipeline.scene.name}[/]")
    for name, values in results.figures.items():
        title, lines = LINES[name]
        show.say(f"\n[bold]{title}[/]")
        for line in lines(values):
            show.say(f"  {line}")
    show.say("\n[bold]written[/]")
    for path in results.files:
        show.plain(f"  {path}")


def _error_lines(figures: Figures) -> list[str]:
    return [
        f"bad1 {figures['bad1']:.2f} %, bad2 {figures['bad2']:.2f} % of pixels over 1 px, 2 px (unknown counts as bad)",
        f"average {figures['average_px']:.3f} px, rms {figures['rms_px']:.3f} px "
        f"over the {figures['density']:.1f} % that are known",
    ]


def _material_lines(figures: Figures) -> list[str]:
    return [f"{label}: {each['name']} ({each['why']})" for label, each in figures.items()]


def _force_lines(figures: Figures) -> list[str]:
    return [
        f"peak {figures['peak_force_n']:.2f} N, median in contact {figures['median_contact_force_n']:.2f} N, "
        f"in contact {100 * figures['contact_share']:.0f} % of {figures['seconds']:.1f} s ({figures['ticks']} ticks)"
    ]


LINES: dict[str, tuple[str, Callable[[Figures], list[str]]]] = {
    "disparity": ("error against the truth", _error_lines),
    "materials": ("materials", _material_lines),
    "force": ("force along the path", _force_lines),
}
