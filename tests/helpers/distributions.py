"""Distributions that are made up, as `pip install` leaves them in a folder."""

import textwrap
from collections.abc import Mapping
from pathlib import Path

Points = Mapping[str, Mapping[str, str]]
"""Group -> name -> module, or module:Class."""


def distribution(site: Path, name: str, points: Points, version: str = "1.0", **modules: str) -> Path:
    """Write one into a folder, which is made where it is not there, and which is returned; modules: name -> source."""
    info = site / f"{name}-{version}.dist-info"
    info.mkdir(parents=True)
    info.joinpath("METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    lines = [f"[{group}]\n" + "".join(f"{key} = {of[key]}\n" for key in of) for group, of in points.items()]
    info.joinpath("entry_points.txt").write_text("\n".join(lines))
    for module, source in modules.items():
        site.joinpath(f"{module}.py").write_text(textwrap.dedent(source))
    return site
