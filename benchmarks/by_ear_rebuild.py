"""Rebuild a picture from the English sentences said about it alone: which parts touch, and their order in height."""

import re
from collections import defaultdict
from collections.abc import Iterable
from statistics import median
from typing import NamedTuple

import numpy as np

ENTERED = re.compile(r"^(?:Touching|On the picture again:?) (?P<what>.+)$")
STEPPED = re.compile(r"^(?P<way>Up|Down) (?P<mm>\d+(?:\.\d+)?) mm: (?P<what>.+)$")
LEVELLED = re.compile(r"^Level: (?P<what>.+)$")
STAYED = re.compile(r"^(?:Left|Right|Near|Far) rim of the picture$|^(?:Rises|Falls) by ")
NUMBERED = re.compile(r"^.*\bpart (\d+)$")


class Rebuilt(NamedTuple):
    """A picture as it was understood: its parts by what they are called."""

    touching: frozenset[frozenset[str]]  # pairs of parts that touch
    height_mm: dict[str, float]  # heights over the first part, for every part that a way of steps leads to


def rebuild(announcements: Iterable[str]) -> Rebuilt:
    """Rebuild the picture that these announcements are about."""
    steps: dict[tuple[str, str], list[float]] = defaultdict(list)
    here: str | None = None
    for announcement in announcements:
        for sentence in re.split(r"(?<=[.;])\s+", announcement):
            words = sentence.rstrip(".;")
            if entered := ENTERED.match(words):
                here = _name(entered["what"])
            elif stepped := STEPPED.match(words) or LEVELLED.match(words):
                there = _name(stepped["what"])
                if here is not None and here != there:
                    steps[here, there].append(_rise_mm(stepped))
                here = there
            elif not STAYED.match(words):
                here = None  # something was left out, or the hand was lifted
    pairs = frozenset(frozenset(pair) for pair in steps)
    return Rebuilt(pairs, _heights(steps))


def _rise_mm(stepped: re.Match[str]) -> float:
    said = stepped.groupdict()
    return 0.0 if "mm" not in said else float(said["mm"]) * (1 if said["way"] == "Up" else -1)


def _name(what: str) -> str:
    numbered = NUMBERED.match(what)
    return f"part {numbered[1]}" if numbered else what.split(",")[0]


def _heights(steps: dict[tuple[str, str], list[float]]) -> dict[str, float]:
    names = sorted({name for pair in steps for name in pair})
    if not names:
        return {}
    rows, rises = [], []
    for (low, high), all_mm in steps.items():
        row = np.zeros(len(names))
        row[names.index(high)], row[names.index(low)] = 1, -1
        weight = len(all_mm) ** 0.5
        rows.append(weight * row)
        rises.append(weight * median(all_mm))
    found = np.linalg.lstsq(np.array(rows), np.array(rises), rcond=None)[0]
    return {name: float(height - found[0]) for name, height in zip(names, found, strict=True)}
