"""A force law would push in free air or on a broken state, or kick a hand on a surface that breaks a careless one."""

from typing import Any, NamedTuple, cast

import numpy as np
import pytest

from planes import UP_M, WIDTH_M, at, tilted
from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, HapticSurface
from tangible_core.errors import OptionError
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.scenes import sphere_cap
from tangible_render.contact.approach import LEAP_M, STRETCH_M
from tangible_render.force_shading import ForceShading
from tangible_render.grey_level import GreyLevel
from tangible_render.lateral_gradient import LateralGradient
from tangible_render.lateral_shape import LateralShape
from tangible_render.penalty import Penalty
from tangible_render.penalty_gradient import PenaltyGradient
from tangible_render.proxy import Proxy
from tangible_render.surface.coefficients import spline_coefficients
from tangible_render.tangible_mask import TangibleMask
from tangible_render.with_materials import WithMaterials

MARGIN_M = 0.002
"""Distance to which the hand goes under the base plane and over the highest place."""


class Worst(NamedTuple):
    """The worst responses of all ticks."""

    not_finite: int
    """Number of forces that were not finite."""
    pushed_when_broken: int
    """Number of forces other than zero for a state that was not finite."""
    greatest_n: float
    gained_j: float
    """Largest energy gained in a tick: that of a spring, |F|^2 / 2 k, minus its previous one and the hand's work.

    The gain of sampling alone, k |step|^2 / 2, is subtracted. Ticks after a leap or a broken state do not count.
    """
    lost: int
    """Number of ticks more than a micrometre off the ball, from 20 ticks after a leap on."""
    touched: int
    """Number of ticks in contact."""


def fuzz(
    touch: CompiledTouch,
    surface: HapticSurface,
    ticks: int,
    seed: int = 0,
    stiffness_n_per_m: float = 800.0,
    ball_m: tuple[float, float] = (0.0, 0.0),
) -> Worst:
    """Move a random hand at 0.05 mm/s to 0.5 m/s over a surface, its sides and bottom; return the worst responses."""
    import random_hand_kernels

    worst, half_m = np.zeros(6), np.array(surface.extent_m) / 2
    low_m, high_m = float(surface.height_m.min()) - MARGIN_M, float(surface.height_m.max()) + MARGIN_M
    cast(Any, random_hand_kernels).walk(
        touch.fixed, touch.address(), ticks, seed, half_m, low_m, high_m, stiffness_n_per_m, ball_m,
        np.zeros((5, 6)), worst,
    )  # fmt: skip
    not_finite, pushed, greatest_n, gained_j, lost, touched = worst.tolist()
    return Worst(int(not_finite), int(pushed), greatest_n, gained_j, int(lost), int(touched))


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


K, FASTEST_M = 800.0, 5e-4
MAPS = rough_surfaces()
BALL = sphere_cap(shape=(256, 256)).surface
LAWS = (
    "penalty",
    "penalty-gradient",
    "force-shading",
    "grey-level",
    "lateral-gradient",
    "lateral-shape",
    "tangible-mask",
)
HOW_MANY = [
    pytest.param(150_000, id="150 thousand"),
    pytest.param(4_000_000, id="4 million", marks=pytest.mark.nightly),
]


def walk_over(renderer: ForceRenderer, surface: HapticSurface, ticks: int, seed: int = 1) -> Worst:
    touch = renderer.touch(surface)
    assert isinstance(touch, CompiledTouch)
    worst = fuzz(touch, surface, ticks, seed, K)
    assert worst.not_finite == worst.pushed_when_broken == 0
    assert worst.touched > 0
    return worst


def cover(surface: HapticSurface, *names: str) -> HapticSurface:
    """Cover the surface with a checkerboard of materials, 8 x 8 cells each."""
    rows, columns = np.indices(surface.height_m.shape) // 8
    labels = np.asarray((rows + columns) % len(names), np.int32)
    return HapticSurface(surface.relief, labels, tuple(library()[name] for name in names))


def farthest(surface: HapticSurface) -> float:
    """Return the longest way from hand to proxy: released where the surface above is nearer, or a leap away."""
    coefficients = spline_coefficients(surface.height_m)
    deep = float(coefficients.max() - min(coefficients.min(), surface.height_m.min() - MARGIN_M))
    return float(np.hypot(max(STRETCH_M, deep) + LEAP_M, deep))


@pytest.mark.parametrize("ticks", HOW_MANY)
@pytest.mark.parametrize("name", MAPS)
class TestProxy:
    def test_proxy_is_stable_with_and_without_friction_and_effects(self, name: str, ticks: int):
        """No tick gives more than its sampling, so no path does, closed or not; a Taylor series errs a little."""
        worst = walk_over(Proxy(stiffness_n_per_m=K), MAPS[name], ticks)
        assert worst.greatest_n <= K * farthest(MAPS[name])
        assert worst.gained_j <= 1e-8
        worst = walk_over(Proxy(static_friction=0.6, dynamic_friction=0.4), MAPS[name], ticks)
        assert worst.greatest_n <= K * farthest(MAPS[name])
        assert worst.gained_j <= K / 2 * FASTEST_M**2
        surface = cover(MAPS[name], "sand", "rubber", "water", "brick")
        worst = walk_over(Proxy(), surface, ticks)
        stiffest, steepest, fastest = 900.0, 2.0, 5 * 0.5 * 3
        assert worst.greatest_n <= (stiffest * farthest(surface) + 3 * fastest) * (1 + steepest) * 2


@pytest.mark.parametrize("ticks", HOW_MANY)
def test_proxy_never_loses_the_exact_nearest_point(ticks: int):
    touch = Proxy(stiffness_n_per_m=K).touch(BALL)
    assert isinstance(touch, CompiledTouch)
    worst = fuzz(touch, BALL, ticks, 3, K, ball_m=(0.1, -0.08))
    assert worst.lost == 0 and worst.touched > 0.1 * ticks


@pytest.mark.whole
@pytest.mark.parametrize("ticks", [15_000, pytest.param(1_000_000, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("name", MAPS)
@pytest.mark.parametrize("law", LAWS)
def test_other_force_laws_are_bounded(law: str, name: str, ticks: int):
    """The bound is the spring to the highest place, as steep as the steepest edge of two cells; also with materials."""
    surface = MAPS[name]
    deep = float(surface.height_m.max() - surface.height_m.min()) * 2.5 + MARGIN_M
    pitch = min(surface.relief.pitch_m)
    steep = 1 + 4 * float(np.ptp(surface.height_m)) / pitch
    most = max(K * deep, 3.0) * steep
    assert walk_over(load_method("render", law)(), surface, ticks).greatest_n <= most
    with_sand = walk_over(WithMaterials(law=law), cover(surface, "sand", "skin"), ticks)
    assert with_sand.greatest_n <= 4 * most + 50
