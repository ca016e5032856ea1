"""All checks together. Otherwise a problem would have no cure, or an odd surface no verdict."""

import math
from typing import Any

import pytest

from flights import fly, half_slope, level
from tangible_core import HapticSurface, Workspace
from tangible_core.preflight import CHECKS, judge
from tangible_core.preflight.checks.cures import flatten, narrow
from tangible_core.preflight.checks.device import lateness
from tangible_core.preflight.checks.stiffness import law_stiffness, quantisation
from tangible_core.preflight.verdict import check_bound


@pytest.mark.parametrize("law", ["proxy", "penalty-gradient", "grey-level", "tangible-mask", "lateral-gradient"])
@pytest.mark.parametrize("surface", [level(cells=1), half_slope(5.0, 32)], ids=["pixel", "half"])
def test_checks_all_yield_verdicts_and_failures_have_cures(law: str, surface: HapticSurface):
    verdicts = judge(fly(surface, law))
    assert len(verdicts) >= len(CHECKS) - 3
    for verdict in verdicts:
        assert (verdict.verdict == "ok") == (verdict.cure == "") == (verdict.says == ""), verdict
        assert "proxy" not in verdict.cure or law != "proxy", verdict
        assert math.isfinite(verdict.value)


@pytest.mark.parametrize("relation", ["<=", ">="])
def test_check_bound_nan_meets_no_bound(relation: Any):
    assert check_bound("check", "of", math.nan, relation, 1.0, "N", "", cure="measure it").verdict == "warn"
    assert check_bound("check", "of", 1.0, relation, math.nan, "N", "", cure="measure it").verdict == "warn"


def test_surface_at_a_scale_is_made_smaller_by_the_scale():
    """240 m at 1:2000 are 120 mm; what reaches 60 mm is 1:4000, and half as high is half the exaggeration."""
    size = Workspace(scale="1:2000", exaggeration=2).size("heights")._replace(width_m=0.12)
    flight = fly(level(), size=size, exaggeration=2.0)
    assert str(narrow(flight, "0.06")) == "`workspace.scale: 1:4000`"
    assert str(flatten(flight, 0.5)) == "`workspace.exaggeration: 1`"
    assert str(narrow(fly(level()), "0.06")) == "`workspace.width_m: 0.06`"


def test_law_that_is_not_a_spring_has_no_stiffness_limit():
    for law in ("grey-level", "tangible-mask"):
        [found] = law_stiffness(fly(level(), law))
        assert (found.verdict, found.value) == ("ok", 0)
        assert not list(quantisation(fly(level(), law)))
        assert "stiffness it leaves" not in {each.of for each in lateness(fly(level(), law))}
