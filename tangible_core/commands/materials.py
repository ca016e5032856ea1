"""`materials`: the library, with units and sources."""

from dataclasses import asdict
from pathlib import Path

from ..materials import load_library
from . import show


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
            f"{1e6 * each.roughness_m:g}",
            f"{1e3 * each.grain_m:g}",
        )
        for each in library.values()
    ]
    headings = ("material", "N/m", "N s/m", "static", "dynamic friction", "roughness um", "grain mm")
    show.table(headings, rows)
    show.say("\n[bold]sources[/]")
    for each in library.values():
        show.say(f"  {each.name}: {each.source}")
