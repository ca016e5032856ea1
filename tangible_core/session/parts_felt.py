"""Which part and material the tip is on, by their names; looked up beside the force loop, never in it."""

import json
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from ..data import HapticSurface, ServoReport, TickFlag, Vector
from ..errors import OutputError, TangibleError, quoted
from .recording import Recording

Places = Float64[np.ndarray, "n 3"]


class BeaconFelt(NamedTuple):
    """How long a beacon was on."""

    number: int
    """Of its part."""
    name: str
    """Of its part; empty where nobody gave it one, or the surface is another one."""
    share: float
    """Of all ticks."""

    def __str__(self) -> str:
        return f"A beacon pulled to {called(self.number, self.name)} for {100 * self.share:.0f} % of the time"


class PartFelt(NamedTuple):
    """How a part was felt."""

    number: int
    name: str
    """Empty where nobody gave it one."""
    share: float
    """Of the time in contact, in which the tip was on it."""
    peak_force_n: float
    material: str = ""
    """The name of its material; empty where the surface has none."""


def telling_parts(surface: HapticSurface | None, tell: Callable[[ServoReport], None]) -> Callable[[ServoReport], None]:
    """`tell`, which then hears of the part and the material under the tip too. surface: None for one without either."""
    return lambda report: tell(with_part(report, surface))


def with_part(report: ServoReport, surface: HapticSurface | None) -> ServoReport:
    """A report with what the part under the tip is called, and its material."""
    if surface is None or not report.ticks:
        return report
    at_m = report.state.position_m
    return replace(report, part=part_under(surface, at_m), material=material_under(surface, at_m))


def part_under(surface: HapticSurface, position_m: Vector) -> str:
    """What the part under a tip is called, touched or not; empty beside the surface, and where that has no parts."""
    if surface.names is None:
        return ""
    number = _under(surface, position_m)
    return "" if number < 0 else called(number, surface.names[number])


def material_under(surface: HapticSurface, position_m: Vector) -> str:
    """The name of the material under a tip, touched or not; empty beside the surface, and where that has none."""
    if not surface.materials:
        return ""
    number = _under(surface, position_m)
    return "" if number < 0 else surface.materials[number].name


def names_text(names: Mapping[int, str]) -> str:
    """The names of parts by number, as the header of a recording has them; empty for none."""
    return json.dumps({str(number): names[number] for number in sorted(names)}, ensure_ascii=False) if names else ""


def materials_text(surface: HapticSurface) -> str:
    """The names of a surface's materials by the number of their label, as `names_text`; empty where it has none."""
    return names_text({number: each.name for number, each in enumerate(surface.materials or ())})


def names_in(configuration: str) -> str:
    """`names_text` of the parts that the text of a pipeline file names; empty where it is none that can be read."""
    from ..files.yaml.source import parse_source, plain

    try:
        parts: Any = plain(parse_source(configuration, Path(), "a mapping", empty=True).tree).get("parts")
        names = {int(number): getattr(each, "get", {"name": each}.get)("name") for number, each in parts.items()}
        return names_text({number: str(name).strip() for number, name in names.items() if name})
    except (TangibleError, AttributeError, TypeError, ValueError):  # whoever runs it complains of it
        return ""


def names_of(text: str) -> list[dict[int, str]]:
    """What `names_text` wrote, of each scene that was felt in turn. Raises: OutputError if it is damaged."""
    try:
        scenes = [json.loads(line or "{}") for line in text.splitlines()]
        return [{int(number): str(name) for number, name in names.items()} for names in scenes]
    except (ValueError, AttributeError, RecursionError) as error:
        raise OutputError(f"the names of its parts are damaged: {quoted(text)}; record it again") from error


def called(number: int, name: str) -> str:
    """A part by its name, or by its number where it has none."""
    return name or f"part {number}"


def parts_felt(felt: Recording, surface: HapticSurface) -> tuple[PartFelt, ...]:
    """Every part that was touched, the longest touched first; none where the surface has no parts."""
    force_n = np.linalg.norm(felt.force_n, axis=1)
    pulled_in_air = (felt.flags & (TickFlag.BEACON | TickFlag.TOUCHING)) == TickFlag.BEACON
    touching = (force_n > 0) & ~pulled_in_air
    if surface.names is None or not touching.any():
        return ()
    under, force_n = _parts_under(surface, felt.position_m[touching]), force_n[touching]
    numbers, ticks = np.unique(under[under >= 0], return_counts=True)
    order = np.argsort(-ticks, kind="stable")
    materials = [each.name for each in surface.materials or ()]
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


def beacons_felt(felt: Recording, surface: HapticSurface) -> tuple[BeaconFelt, ...]:
    """Every part that a beacon pulled to, the longest first; by the names of this surface."""
    ticks = Counter[int](felt.beacon[felt.beacon >= 0].tolist())
    names = dict(enumerate(surface.names or ()))
    found = [BeaconFelt(number, names.get(number, ""), count / len(felt.rows)) for number, count in ticks.items()]
    return tuple(sorted(found, key=lambda each: -each.share))


def _under(surface: HapticSurface, position_m: Vector) -> int:
    """The label under a place, -1 beside the surface and where that has no labels."""
    if surface.labels is None:
        return -1
    return int(_parts_under(surface, np.array([position_m], np.float64))[0])


def _parts_under(surface: HapticSurface, at_m: Places) -> Int32[np.ndarray, " n"]:
    """The number of the part under each place, -1 beside the surface."""
    labels = surface.labels
    assert labels is not None
    (rows, columns), (width_m, length_m) = labels.shape, surface.extent_m
    across, along = 0.5 + at_m[:, 0] / width_m, 0.5 - at_m[:, 1] / length_m
    over = (across >= 0) & (across <= 1) & (along >= 0) & (along <= 1)
    column = np.minimum((np.where(over, across, 0) * columns).astype(np.intp), columns - 1)
    row = np.minimum((np.where(over, along, 0) * rows).astype(np.intp), rows - 1)
    return np.where(over, labels[row, column], np.int32(-1))
