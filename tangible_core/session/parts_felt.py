"""The part and material under the tip, by name; looked up outside the force loop."""

import json
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from ..data import HapticSurface, ServoReport, TickFlag, Vector
from ..data.part_words import label_of_number, name_part
from ..errors import OutputError, TangibleError, quoted
from .recording import Recording

Places = Float64[np.ndarray, "n 3"]


class BeaconFelt(NamedTuple):
    """The time in which a beacon was on."""

    number: int
    """Number of its part."""
    name: str
    """Name of its part; empty if it has none on this surface."""
    share: float
    """Share of all ticks."""

    def __str__(self) -> str:
        return f"A beacon pulled to {part_label(self.number, self.name)} for {100 * self.share:.0f} % of the time"


class PartFelt(NamedTuple):
    """The contact with one part."""

    number: int
    name: str
    """Name of the part; empty if it has none."""
    share: float
    """Share of the time in contact in which the tip was on the part."""
    peak_force_n: float
    material: str = ""
    """Name of its material; empty if the surface has none."""


def with_parts(
    surface: HapticSurface | None, on_report: Callable[[ServoReport], None]
) -> Callable[[ServoReport], None]:
    """Return a function that adds the part and the material under the tip to a report, and passes it on."""
    return lambda report: on_report(with_part(report, surface))


def with_part(report: ServoReport, surface: HapticSurface | None) -> ServoReport:
    """Return a report with the part and the material under the tip."""
    if surface is None or not report.ticks:
        return report
    at_m = report.state.position_m
    return replace(report, part=part_under(surface, at_m), material=material_under(surface, at_m))


def part_under(surface: HapticSurface, position_m: Vector) -> str:
    """Return the label of the part under a tip, in contact or not; empty off the surface, or if it has no parts."""
    if surface.names is None:
        return ""
    number = _under(surface, position_m)
    return "" if number < 0 else part_label(number, surface.names[number])


def material_under(surface: HapticSurface, position_m: Vector) -> str:
    """Return the name of the material under a tip, in contact or not; empty off the surface, or if it has none."""
    if not surface.materials:
        return ""
    number = _under(surface, position_m)
    return "" if number < 0 else surface.materials[number].name


def names_text(names: Mapping[int, str]) -> str:
    """Return the names of parts as text for the header of a recording; empty for none."""
    return json.dumps({str(number): names[number] for number in sorted(names)}, ensure_ascii=False) if names else ""


def materials_text(surface: HapticSurface) -> str:
    """Return the names of a surface's materials by the number of their label, as `names_text`; empty for none."""
    return names_text({number: material.name for number, material in enumerate(surface.materials or ())})


def names_in(configuration: str) -> str:
    """Return `names_text` of the parts in the text of a pipeline file; empty if it cannot be read."""
    from ..files.yaml.source import parse_source, plain

    try:
        parts: Any = plain(parse_source(configuration, Path(), "a mapping", empty=True).tree).get("parts")
        names = {int(number): getattr(part, "get", {"name": part}.get)("name") for number, part in parts.items()}
        return names_text({label_of_number(number): str(name).strip() for number, name in names.items() if name})
    except (TangibleError, AttributeError, TypeError, ValueError):  # reported when the file is run
        return ""


def read_names(text: str) -> list[dict[int, str]]:
    """Read the text of `names_text`, a line for each scene of a kiosk. Raises: OutputError if it is damaged."""
    try:
        scenes = [json.loads(line or "{}") for line in text.splitlines()]
        return [{int(number): str(name) for number, name in names.items()} for names in scenes]
    except (ValueError, AttributeError, RecursionError) as error:
        raise OutputError(f"the names of its parts are damaged: {quoted(text)}; record it again") from error


def part_label(number: int, name: str) -> str:
    """Return a part's name, or its number if it has none."""
    return name or name_part(number)


def parts_felt(recording: Recording, surface: HapticSurface) -> tuple[PartFelt, ...]:
    """Return every part that was touched, by time in contact, longest first; none if the surface has no parts."""
    force_n = np.linalg.norm(recording.force_n, axis=1)
    pulled_in_air = (recording.flags & (TickFlag.BEACON | TickFlag.TOUCHING)) == TickFlag.BEACON
    touching = (force_n > 0) & ~pulled_in_air
    if surface.names is None or not touching.any():
        return ()
    under, force_n = _parts_under(surface, recording.position_m[touching]), force_n[touching]
    numbers, ticks = np.unique(under[under >= 0], return_counts=True)
    order = np.argsort(-ticks, kind="stable")
    materials = [material.name for material in surface.materials or ()]
    return tuple(
        PartFelt(
            number,
            surface.names[number],
            count / len(under),
            float(force_n[under == number].max()),
            materials[number] if materials else "",
        )
        for number, count in zip(numbers[order].tolist(), ticks[order].tolist(), strict=True)
    )


def beacons_felt(recording: Recording, surface: HapticSurface) -> tuple[BeaconFelt, ...]:
    """Return every part that a beacon pulled to, with its name on this surface, longest first."""
    ticks, count = Counter[int](recording.beacon[recording.beacon >= 0].tolist()), len(recording.rows)
    names = dict(enumerate(surface.names or ()))
    return tuple(BeaconFelt(number, names.get(number, ""), n / count) for number, n in ticks.most_common())


def _under(surface: HapticSurface, position_m: Vector) -> int:
    """Return the label under a place; -1 off the surface, or if it has no labels."""
    if surface.labels is None:
        return -1
    return int(_parts_under(surface, np.array([position_m], np.float64))[0])


def _parts_under(surface: HapticSurface, at_m: Places) -> Int32[np.ndarray, " n"]:
    """Return the number of the part under each place; -1 off the surface."""
    labels = surface.labels
    assert labels is not None
    (rows, columns), (width_m, length_m) = labels.shape, surface.extent_m
    across, along = 0.5 + at_m[:, 0] / width_m, 0.5 - at_m[:, 1] / length_m
    over = (across >= 0) & (across <= 1) & (along >= 0) & (along <= 1)
    column = np.minimum((np.where(over, across, 0) * columns).astype(np.intp), columns - 1)
    row = np.minimum((np.where(over, along, 0) * rows).astype(np.intp), rows - 1)
    return np.where(over, labels[row, column], np.int32(-1))
