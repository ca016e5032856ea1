"""`tangible materials ...`: the library of materials, with units and sources, as tables."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tangible_core.cli import Json, completing, show
from tangible_core.errors import ConfigError

if TYPE_CHECKING:
    from tangible_core.data import Material, Texture

STROKE_M_PER_S = 0.12  # the speed at which the sources measured vibration
MODELS: dict[Texture, str] = {
    "smooth": "no heights",
    "periodic": "lines a grain apart, or two crossed sets of them",
    "stochastic": "noise of one octave around the grain",
    "stick-slip": "friction that sticks and slips once a grain, over noise of one octave around the grain",
    "drag": "a force against the velocity, over noise of one octave around the grain if there is roughness",
}
"""Texture -> its model in words."""
UNITS = {"_n_s_per_m": "N s/m", "_n_per_m": "N/m", "_deg": "degrees", "_m": "m"}
Library = Annotated[Path | None, typer.Option(help="Custom YAML file, added to the shipped materials.")]

app = typer.Typer(name="materials", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def materials(context: typer.Context, library: Library = None, as_json: Json = False) -> None:
    """List the materials; show some."""
    if context.invoked_subcommand is not None:
        if library or as_json:
            raise ConfigError(f"materials: write the options after {context.invoked_subcommand!r}")
        return

    from tangible_core.materials import load_library

    materials = load_library(library)
    if as_json:
        show.print_json({name: asdict(material) for name, material in materials.items()})
        return
    show.sentence(f"{len(materials)} materials; `tangible materials show NAME` explains the values of one.")
    rows = [
        (
            row.name,
            f"{row.stiffness_n_per_m:g}",
            f"{row.damping_n_s_per_m:g}",
            f"{row.static_friction:g}",
            f"{row.dynamic_friction:g}",
            row.texture,
            f"{1e6 * row.roughness_m:g}",
            f"{1e3 * row.grain_m:g}",
        )
        for row in materials.values()
    ]
    headings = ("material", "N/m", "N s/m", "static", "dynamic friction", "texture", "roughness um", "grain mm")
    show.table(headings, rows, named=1)
    show.say("\n[bold]sources[/]")
    for row in materials.values():
        show.say(f"  {row.name}: {row.source}")


@app.command("show")
def show_one(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help="The material, as `tangible materials` lists it.",
            show_default=False,
            autocompletion=completing.materials,
        ),
    ],
    library: Library = None,
    as_json: Json = False,
) -> None:
    """Show everything about one material.

    Each value with its unit and its source, and its texture.
    """
    from tangible_core.materials import VALUES, find, load_library, value_sources

    material = find(name, load_library(library))
    sources = value_sources(material)
    if as_json:
        show.print_json({**asdict(material), "sources": sources, "vibration_hz": _vibration_hz(material)})
        return
    rows = [(key, _worth(getattr(material, key)), _unit(key), sources[key]) for key in VALUES]
    show.table(("value", "", "unit", "source"), rows, f"[bold]{material.name}[/]", named=1)
    show.say(f"\n{material.texture}: {MODELS[material.texture]}.")
    if (hertz := _vibration_hz(material)) is not None:
        show.say(f"A stroke at {STROKE_M_PER_S:g} m/s vibrates with {hertz:.0f} Hz.")


def _vibration_hz(material: Material) -> float | None:
    """Return the frequency of a stroke at the sources' speed; None for a material without waves."""
    waves = material.roughness_m > 0 or material.texture == "stick-slip"
    return STROKE_M_PER_S / material.grain_m if waves else None


def _unit(key: str) -> str:
    return next((unit for suffix, unit in UNITS.items() if key.endswith(suffix)), "")


def _worth(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"
