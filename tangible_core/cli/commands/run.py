"""The commands `demo`, `run` and `plan`: a pipeline from file to report."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from ...errors import ConfigError
from ...plugins.registry import default_registry
from .. import sentences, show
from ..options import ConfigOrPictures, Json, NoCache, Sets, Verbose, is_quiet

if TYPE_CHECKING:
    from ...pipeline.config.methods import NamedMethod
    from ...pipeline.output.runs import Run
    from ...pipeline.pipeline import Pipeline
    from ...plugins.interfaces import HapticDevice

Seconds = Annotated[float, typer.Option(help="Length of the simulated touch, s.")]


def demo(
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results [default: out/demo].")] = None,
    seconds: Seconds = 8.0,
    verbose: Verbose = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Run the built-in example from picture to force.

    A stereo pair with known depth becomes a surface, which a simulated hand feels.
    """
    from importlib.resources import files

    from ...pipeline.config.parsing import parse_config
    from ...pipeline.engine.cache import Cache
    from ...pipeline.pipeline import Pipeline

    text = files("tangible_core").joinpath("demo.yaml").read_text(encoding="utf-8")
    config = parse_config(text, DEMO, default_registry())
    pipeline = Pipeline.from_config(config, default_registry(), None if no_cache else Cache())
    out = out or default_place(DEMO)
    done = pipeline.run(out, seconds=seconds)
    _print(done, as_json, verbose)
    _check_complete(done)
    if not (as_json or is_quiet()):
        show.plain(NEXT.format(config=out / "config.yaml"))


DEMO = Path("tangible demo/demo.yaml")  # no name that a user's own demo.yaml has

NEXT = """
Next:
  tangible ui {config}                see it, hear it and feel it with the mouse, on a page in the browser
  tangible plan {config}              what a run does and why, without running it
  tangible feel {config} --seconds 5  the same surface on the configured device
  tangible run {config} --set render.use=grey-level   the report's own law, to compare
  tangible plugins                    what else there is to put into `use:`"""


def run(
    config: ConfigOrPictures,
    sets: Sets = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results [default: out/NAME].")] = None,
    seconds: Seconds = 8.0,
    sheet: Annotated[Literal["png", "svg", "pdf"], typer.Option(help="Format of the sheet.")] = "png",
    verbose: Verbose = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Run a pipeline file, or a picture, and write a report.

    A simulated device feels the surface; a real one is never moved: see `feel`.
    """
    pipeline = open_pipeline(config, sets or [], not no_cache)
    done = pipeline.run(out or default_place(config[0], config[1:]), seconds=seconds, sheet=sheet)
    _print(done, as_json, verbose)
    _check_complete(done)
    if not (as_json or is_quiet()):
        words = [*map(str, config), *(word for each in sets or [] for word in ("--set", each))]
        show.plain(f"\nNext:\n  {shlex.join(['tangible', 'ui', *words])}  {SEE}")


SEE = "see it, hear it and feel it with the mouse, on a page in the browser"


def plan(config: ConfigOrPictures, sets: Sets = None, as_json: Json = False, no_cache: NoCache = False) -> None:
    """Show what `run` would do, and why; run nothing.

    Exit 2 if `run` would refuse.
    """
    plan = open_pipeline(config, sets or [], not no_cache).plan()
    if as_json:
        show.print_json(show.as_rows(plan.steps))
    else:
        if not plan.refusal:
            show.sentence(sentences.plan_summary(plan.steps))
        show.outcomes(plan.steps, ran="to run")
    if plan.refusal:
        show.flush()
        raise ConfigError(f"this cannot be run: {plan.refusal}")


def open_pipeline(config: Path | Sequence[Path], sets: Sequence[str], cached: bool) -> Pipeline:
    """Open the pipeline of a file, or of pictures without one; cached: with the user's cache."""
    from ...pipeline.engine.cache import Cache
    from ...pipeline.pipeline import Pipeline, load_pipeline
    from ...pipeline.starter import are_pictures, not_pictures, suited_config
    from ...scene.formats.kinds import is_binary

    files = [config] if isinstance(config, Path) else config
    if are_pictures(files):
        pipeline = Pipeline.from_config(suited_config(files, default_registry(), sets), cache=Cache())
        if not is_quiet():
            command = shlex.join(["tangible", "new", *map(str, files)])
            show.note(f"without a pipeline file, values that suit the picture are used: `{command}` writes them down")
    elif folder := next((file for file in files if file.is_dir() or file.suffix.lower() in TABLES), None):
        raise ConfigError(f"{folder}: its pictures or rows are run by `tangible batch mine.yaml --over {folder}`")
    elif any(file.suffix.lower() in OTHER_FILES for file in files) or (len(files) == 1 and is_binary(files[0])):
        raise not_pictures(files)
    elif len(files) > 1:
        raise ConfigError(f"{', '.join(map(str, files))}: name one pipeline file, one picture, or left and right")
    else:
        pipeline = load_pipeline(files[0], sets)
    if not cached:
        pipeline.engine.cache = None
    if (width_m := pipeline.config.size.width_m) > MAX_HAND_M:
        show.note(f"the surface is {width_m:g} m wide; if {width_m:g} cm are meant, write `width_m: {width_m:g} cm`")
    return pipeline


MAX_HAND_M = 1.0  # from which width on a unit was more likely forgotten than meant
TABLES = (".csv", ".parquet")  # of settings


OTHER_FILES = frozenset((".eps", ".ai", ".psd", ".doc", ".docx", ".odt", ".pptx", ".html", ".stl", ".obj"))
"""Suffixes of files that people try, and that are neither pictures nor pipeline files."""


def configured_device(pipeline: Pipeline) -> NamedMethod[HapticDevice]:
    """Return the configured device with its name. Raises: ConfigError if there is none."""
    device, felt = pipeline.config.device, pipeline.config.felt_device
    if device is None or felt is None:
        raise pipeline.config.missing("device")
    return replace(device, method=felt)


def default_place(source: Path, others: Sequence[Path] = ()) -> Path:
    """Return the folder for results if the user named none. others: a right view, which stands beside the source."""
    from ...pipeline.output.result_folders import default_folder, default_name

    first = default_name(source, *others)
    folder = default_folder(source, name=first)
    if folder.name != first:
        show.note(
            f"{folder.parent / first} holds other results, and is left as it is; these go to {folder} (`--out` chooses)"
        )
    return folder


def _print(run: Run, as_json: bool, verbose: bool) -> None:
    if as_json:
        show.print_json({**run.document(), "files": [str(path) for path in run.files]})
        return
    if is_quiet():
        return
    show.sentence(sentences.run_summary(run))
    if verbose:
        show.outcomes(run.outcomes, f"[bold]{run.scene}[/]")
        for name, values in run.figures.items():
            title, lines = LINES[name]
            show.say(f"\n[bold]{title}[/]")
            for line in lines(values):
                show.plain(f"  {line}")
        show.say("\n[bold]written[/]")
        for path in run.files:
            show.plain(f"  {path}")
        return
    for name in SENTENCES:
        if name in run.figures:
            for line in LINES[name][1](run.figures[name]):
                show.plain(f"{line}\n")
    show.plain(sentences.where(run.files))


def _check_complete(run: Run) -> None:
    """Report a simulated touch that stopped early. Raises: KeyboardInterrupt if Ctrl-C stopped it."""
    from ...session import INTERRUPTED

    if run.recording is None or not run.recording.stopped:
        return
    seconds, why = run.recording.figures()["seconds"], run.recording.stopped
    show.flush()
    show.note(
        f"stopped after {seconds:.1f} s ({why}); recording.npz has those {seconds:.1f} s, all other files are complete"
    )
    if why == INTERRUPTED:
        raise KeyboardInterrupt


def _error_lines(figures: Mapping[Any, Any]) -> list[str]:
    return [
        f"{figures['bad1']:.2f} % of the pixels are off by more than 1 px (bad1), {figures['bad2']:.2f} % by more than "
        "2 px (bad2); unknown ones count as bad",
        f"average {figures['average_px']:.3f} px, rms {figures['rms_px']:.3f} px "
        f"over the {figures['density']:.1f} % that are known",
    ]


def _material_lines(figures: Mapping[Any, Any]) -> list[str]:
    from ...data.part_words import name_part, shown_number

    lines = list[str]()
    for label, figure in figures.items():
        place, name = name_part(int(label), noun="segment"), figure["name"]
        why = figure["why"].removeprefix(f"{place}: ").removesuffix(f" -> {name}")
        lines.append(f"{shown_number(int(label))}: {name} ({why})")
    return lines


def _part_lines(figures: Mapping[Any, Any]) -> list[str]:
    from ...data.part_words import shown_number

    return [
        f"{shown_number(int(number))}: {', '.join(_properties(figure))}"
        + (f" ({figure['why']})" if figure["why"] else "")
        for number, figure in figures.items()
    ]


def _properties(part: Mapping[Any, Any]) -> list[str]:
    height_m = part["height_m"]
    properties = (part["name"], "" if height_m is None else f"{1000 * height_m:.3g} mm high", part["material"])
    return [each for each in properties if each]


def _force_lines(figures: Mapping[Any, Any]) -> list[str]:
    return [
        f"peak {figures['peak_force_n']:.2f} N, median in contact {figures['median_contact_force_n']:.2f} N, "
        f"in contact {100 * figures['contact_share']:.0f} % of {figures['seconds']:.1f} s ({figures['ticks']} ticks)"
    ]


# The figures that tell the scale, and what went differently from what was requested: printed without --verbose too.
SENTENCES = ("heights", "guard", "hand")

LINES: dict[str, tuple[str, Callable[[Mapping[Any, Any]], list[str]]]] = {
    "disparity": ("error against the truth", _error_lines),
    "materials": ("materials", _material_lines),
    "parts": ("parts", _part_lines),
    "force": ("force along the path", _force_lines),
    "heights": ("the heights", lambda figures: figures["says"]),
    "guard": ("what the guard changed", lambda figures: [figures["says"]]),
    "hand": ("the hand", lambda figures: [figures["says"]]),
}
