"""A force law would push in free air or on a broken state, or take an impossible option."""

import numpy as np
import pytest

from planes import UP_M, WIDTH_M, at, tilted
from tangible_core.data import NO_FORCE, HapticSurface
from tangible_core.errors import OptionError
from tangible_render.force_shading import ForceShading
from tangible_render.grey_level import GreyLevel
from tangible_render.lateral_gradient import LateralGradient
from tangible_render.lateral_shape import LateralShape
from tangible_render.penalty import Penalty
from tangible_render.penalty_gradient import PenaltyGradient
from tangible_render.proxy import Proxy
from tangible_render.tangible_mask import TangibleMask

PUSHING_UP = (
    PenaltyGradient(),
    PenaltyGradient(damping_n_s_per_m=2.0),
    GreyLevel(),
    Penalty(damping_n_s_per_m=2.0),
    ForceShading(),
    Proxy(),
    Proxy(static_friction=0.5, dynamic_friction=0.3, damping_n_s_per_m=2.0),
)
LATERAL = (TangibleMask(), LateralGradient(), LateralShape())
RENDERERS = PUSHING_UP + LATERAL
RNG = np.random.default_rng(7)
BUMPY = HapticSurface.from_heights(RNG.uniform(0, 0.004, (12, 16)), WIDTH_M)


@pytest.mark.parametrize("renderer", RENDERERS, ids=repr)
class TestEveryRenderer:
    def test_force_in_free_air_is_zero(self, renderer):
        touch, edge = renderer.touch(tilted(0, 0)), WIDTH_M / 2
        assert at(touch, 0, 0, UP_M) == NO_FORCE
        assert at(touch, 0, 0, UP_M, (0, 0, -1)) == NO_FORCE
        for x, y in ((np.nextafter(edge, 1), 0), (0, -np.nextafter(edge, 1)), (5, 5), (1e300, 0)):
            assert at(touch, x, y, 0.0) == NO_FORCE
        for x, y in ((edge, edge), (-edge, -edge)):
            assert (at(touch, x, y, 0.0).z > 0) == (renderer in PUSHING_UP)

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("axis", range(6))
    def test_state_not_finite_has_no_force(self, renderer, bad: float, axis: int):
        numbers = [0.001, 0.002, -0.003, 0.0, 0.0, 0.0]
        numbers[axis] = bad
        assert at(renderer.touch(BUMPY), *numbers[:3], velocity=tuple(numbers[3:])) == NO_FORCE


@pytest.mark.parametrize(
    ("renderer", "option", "value"),
    [
        (PenaltyGradient, "stiffness_n_per_m", 0),
        (PenaltyGradient, "stiffness_n_per_m", -800),
        (PenaltyGradient, "stiffness_n_per_m", np.inf),
        (PenaltyGradient, "damping_n_s_per_m", -1),
        (PenaltyGradient, "damping_n_s_per_m", np.nan),
        (PenaltyGradient, "stifness_n_per_m", 800),
        (GreyLevel, "force_at_white_n", 0),
        (GreyLevel, "force_at_white_n", np.nan),
        (Penalty, "damping_n_s_per_m", -1),
        (TangibleMask, "mask_px", 4),
        (TangibleMask, "mask_px", 1),
        (TangibleMask, "mask_m", 0),
        (LateralGradient, "dequantise", "often"),
        (LateralShape, "dequantise", 0),
        (Proxy, "static_friction", -0.1),
        (Proxy, "dynamic_friction", 0.2),
    ],
)
def test_wrong_options_are_refused(renderer, option: str, value: float):
    with pytest.raises(OptionError, match=option):
        renderer(**{option: value})
