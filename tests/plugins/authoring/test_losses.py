"""Losses by a cure: if a case fails, a person agrees to a cure that takes away something else than is said."""

from pathlib import Path

import pytest

from tangible_authoring.fixing import losses
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.preflight.verdict import Change

TEXT = """\
scene: builtin/brick
want: touch
workspace: {smooth_m: 2 mm, relief_m: 5 mm, width_m: 80 mm}
relief: {slope: 2}
render: {use: proxy, stiffness_n_per_m: 800, damping_n_s_per_m: 0.5}
"""


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("workspace.smooth_m", "0.007", "blurs 3.5 times as much (`workspace.smooth_m: 7 mm` in place of 2 mm)"),
        ("workspace.relief_m", "0.002", "is 40 % as high (`workspace.relief_m: 2 mm` in place of 5 mm)"),
        ("relief.slope", "0.9", "has no slope above 0.9, so that steep edges become ramps (`relief.slope: 0.9` in"),
        ("render.stiffness_n_per_m", "400", "is 50 % as stiff (`render.stiffness_n_per_m: 400 N/m` in place of 800"),
        ("workspace.width_m", "0.04", "is 50 % as wide (`workspace.width_m: 40 mm` in place of 80 mm)"),
        ("workspace.smooth_m", "0.001", "blurs less"),
        ("workspace.relief_m", "0.00525", "is 1.1 times as high (`workspace.relief_m: 5.25 mm` in place of 5 mm)"),
        ("workspace.relief_m", "0.0052", "is 104 % as high (`workspace.relief_m: 5.2 mm` in place of 5 mm)"),
        ("relief.slope", "3", "may be steeper"),
        ("render.damping_n_s_per_m", "0.25", "is damped 50 % as much (`render.damping_n_s_per_m: 0.25 N s/m` in"),
        ("safety.stiffness_margin", "0.4", "may be only 50 % as stiff (`safety.stiffness_margin: 0.4` in place of"),
        ("safety.stiffness_margin", "0.96", "may be 1.2 times as stiff (`safety.stiffness_margin: 0.96` in place of"),
        ("safety.max_force_n", "2.5", "is changed (`safety.max_force_n: 2.5 N`)"),
        ("materials.fit", "device", "has materials that are felt more gently than they are, where the device cannot"),
        ("safety.coupling", "auto", "is felt through a spring, which makes hard things softer (`safety.coupling: a"),
    ],
)  # fmt: skip
def test_cure_is_said_with_what_it_takes_away(key: str, value: str, said: str):
    config = parse_config(TEXT, Path("p.yaml"), default_registry())
    (sentence,) = losses(config, {key: Change(key, value, "at most")})
    assert sentence.startswith(said)
