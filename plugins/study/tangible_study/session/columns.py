"""Descriptions of the columns of all tables, as BIDS wants them next to a table."""

import json
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any


def describe_participants() -> dict[str, Any]:
    """Return the description of each column of the list of participants."""
    return _columns()["participants"]


def describe_answers(units: Mapping[str, str]) -> dict[str, Any]:
    """Return the description of each column of the table of answers. units: of the levels, by comparison."""
    unit = next(iter(units.values())) if len(set(units.values())) == 1 else json.dumps(dict(units))
    described = {"Units": unit} if units else {}
    answers = _columns()["answers"]
    return answers | {name: answers[name] | described for name in ("level", "standard")}


@cache
def _columns() -> dict[str, dict[str, Any]]:
    return json.loads(files("tangible_study.session").joinpath("columns.json").read_text(encoding="utf-8"))
