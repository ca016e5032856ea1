"""`demo`, `run`, `plan`: a pipeline from file to report."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from .options import Config, Json, NoCache, Sets

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from ..pipeline.config import NamedMethod
    from ..pipeline.pipeline import Pipeline
    from ..pipeline.runs import Run
    from ..plugins.interfaces import HapticDevice

Seconds = Annotated[float, typer.Option(help="Simulated time for which the surface is felt, s.")]


def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for the results.")] = Path("out/demo"),
    seconds: Seconds = 8.0,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Run the built-in example from picture to force.

    A stereo pair with known depth becomes a surface, which a simulated hand feels.
    """
    from importlib.resources import files

    from ..pipeline.cache import Cache
    from ..pipeline.config import parse_config
    from ..pipeline.pipeline import Pipeline
    from ..plugins.registry import default_registry
    from . import show

    text = files("tangible_core").joinpath("demo.yaml").read_text(encoding="utf-8")
    config = parse_config(text, Path("demo.yaml"), default_registry())
    pipeline = Pipeline.of(config, default_registry(), None if no_cache else Cache())
    _print(pipeline.run(out, seconds=seconds), as_json)
    if not as_json:
        show.say(NEXT.format(config=out / "config.yaml"))


NEXT = """
Next:
  tangible plan {config}              what a run does and why, without running it
  tangible feel {config} --seconds 5  the same surface on the configured device
  tangible run {config} --set render.use=grey-level   the report's own law, to compare
  tangible plugins                    what else there is to put into `use:`"""


def run(
    config: Config,
    sets: Sets = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results [default: out/NAME].")] = None,
    seconds: Seconds = 8.0,
    sheet: Annotated[Literal["png", "svg", "pdf"], typer.Option(help="What the sheet is drawn as.")] = "png",
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Run a pipeline file and write a report.

    A simulated device feels the surface; a real one is never moved: see `feel`.
    """
    pipeline = open_pipeline(config, sets or [], not no_cache)
    _print(pipeline.run(out or Path("out") / config.stem, seconds=seconds, sheet=sheet), as_json)


def plan(config: Config, sets: Sets = None, as_json: Json = False, no_cache: NoCache = False) -> None:
    """Say what `run` would do, and why; run nothing."""
    from . import show

    steps = open_pipeline(config, sets or [], not no_cache).plan().steps
    if as_json:
        show.print_json(show.as_rows(steps))
    else:
        show.outcomes(steps, ran="to run")


def open_pipeline(config: Path, sets: Sequence[str], cached: bool) -> Pipeline:
    """The pipeline of a file, with or without the user's cache."""
    from ..pipeline.pipeline import load_pipeline

    pipeline = load_pipeline(config, sets)
    if not cached:
        pipeline.cache = None
    return pipeline


def device_of(pipeline: Pipeline) -> NamedMethod[HapticDevice]:
    """The configured device with its name. Raises: ConfigError if there is none."""
    from dataclasses import replace

    device, felt = pipeline.config.device, pipeline.config.felt_device
    if device is None or felt is None:
        raise pipeline.config.missing("device")
    return replace(device, method=felt)


def _print(run: Run, as_json: bool) -> None:
    from . import show

    if as_json:
        show.print_json({**run.document(), "files": [str(path) for path in run.files]})
        return
    show.outcomes(run.outcomes, f"[bold]{run.scene}[/]")
    for name, values in run.figures.items():
        title, lines = LINES[name]
        show.say(f"\n[bold]{title}[/]")
        for line in lines(values):
            show.say(f"  {line}")
    show.say("\n[bold]written[/]")
    for path in run.files:
        show.plain(f"  {path}")


def _error_lines(figures: Mapping[Any, Any]) -> list[str]:
    return [
        f"bad1 {figures['bad1']:.2f} %, bad2 {figures['bad2']:.2f} % of pixels over 1 px, 2 px (unknown counts as bad)",
        f"average {figures['average_px']:.3f} px, rms {figures['rms_px']:.3f} px "
        f"over the {figures['density']:.1f} % that are known",
    ]


def _material_lines(figures: Mapping[Any, Any]) -> list[str]:
    return [f"{label}: {each['name']} ({each['why']})" for label, each in figures.items()]


def _force_lines(figures: Mapping[Any, Any]) -> list[str]:
    return [
        f"peak {figures['peak_force_n']:.2f} N, median in contact {figures['median_contact_force_n']:.2f} N, "
        f"in contact {100 * figures['contact_share']:.0f} % of {figures['seconds']:.1f} s ({figures['ticks']} ticks)"
    ]


LINES: dict[str, tuple[str, Callable[[Mapping[Any, Any]], list[str]]]] = {
    "disparity": ("error against the truth", _error_lines),
    "materials": ("materials", _material_lines),
    "force": ("force along the path", _force_lines),
    "hand": ("the hand", lambda figures: [figures["says"]]),
}
