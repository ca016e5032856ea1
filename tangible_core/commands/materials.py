"""`materials`: the library, with units and sources, as tables and as pictures."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..data import Material, Texture
from ..materials.assignment import find, load_library
from ..materials.files import VALUES, sources_of
from . import show

STROKE_M_PER_S = 0.12
"""At which the sources measured vibration."""
MODELS: dict[Texture, str] = {
    "smooth": "no heights",
    "periodic": "lines a grain apart, or two crossed sets of them",
    "stochastic": "noise of one octave round the grain",
    "stick-slip": "friction that sticks and slips once a grain, over noise of one octave round the grain",
    "drag": "a force against the velocity, over noise of one octave round the grain where there is roughness",
}
UNITS = {"_n_s_per_m": "N s/m", "_n_per_m": "N/m", "_deg": "degrees", "_m": "m"}


def materials(path: Path | None, as_json: bool) -> None:
    """One line a material."""
    library = load_library(path)
    if as_json:
        show.print_json({name: asdict(material) for name, material in library.items()})
        return
    rows = [
        (
            each.name,
            f"{each.stiffness_n_per_m:g}",
            f"{each.damping_n_s_per_m:g}",
            f"{each.static_friction:g}",
            f"{each.dynamic_friction:g}",
            each.texture,
            f"{1e6 * each.roughness_m:g}",
            f"{1e3 * each.grain_m:g}",
        )
        for each in library.values()
    ]
    headings = ("material", "N/m", "N s/m", "static", "dynamic friction", "texture", "roughness um", "grain mm")
    show.table(headings, rows)
    show.say("\n[bold]sources[/]")
    for each in library.values():
        show.say(f"  {each.name}: {each.source}")


def show_one(name: str, path: Path | None, as_json: bool) -> None:
    """Each value of one material with its unit and its source, and what its texture is."""
    material = find(name, load_library(path))
    sources = sources_of(material)
    if as_json:
        show.print_json({**asdict(material), "sources": sources, "vibration_hz": _vibration_hz(material)})
        return
    rows = [(key, _worth(getattr(material, key)), _unit(key), sources[key]) for key in VALUES]
    show.table(("value", "", "unit", "source"), rows, f"[bold]{material.name}[/]")
    show.say(f"\n{material.texture}: {MODELS[material.texture]}.")
    if (hertz := _vibration_hz(material)) is not None:
        show.say(f"A stroke at {STROKE_M_PER_S:g} m/s vibrates with {hertz:.0f} Hz.")


def draw(names: Sequence[str], out: Path, path: Path | None, as_json: bool) -> None:
    """A picture a material, those named or all."""
    from ..report.material_sheet import draw_material

    library = load_library(path)
    chosen = [find(name, library) for name in names] or list(library.values())
    files: list[Any] = []
    for material in chosen:
        draw_material(out / f"{material.name}.png", material)
        files.append(out / f"{material.name}.png")
        if not as_json:
            show.plain(str(files[-1]))
    if as_json:
        show.print_json({"files": files})


def _vibration_hz(material: Material) -> float | None:
    """Of a stroke at the sources' speed; None for a material without waves."""
    waves = material.roughness_m > 0 or material.texture == "stick-slip"
    return STROKE_M_PER_S / material.grain_m if waves else None


def _unit(key: str) -> str:
    return next((unit for suffix, unit in UNITS.items() if key.endswith(suffix)), "")


def _worth(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"
