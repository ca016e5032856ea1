"""A hand would be kicked: on surfaces that break a careless law nothing runs away, gains energy or loses its track."""

import numpy as np
import pytest

from random_hand import MARGIN_M, Worst, fuzz
from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import HapticSurface
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.scenes import sphere_cap
from tangible_render.contact.approach import LEAP_M, STRETCH_M
from tangible_render.proxy import Proxy
from tangible_render.surface.coefficients import spline_coefficients
from tangible_render.with_materials import WithMaterials

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
    def test_proxy_without_friction_is_stable(self, name: str, ticks: int):
        """No tick gives more than its sampling, so no path does, closed or not; a Taylor series errs a little."""
        worst = walk_over(Proxy(stiffness_n_per_m=K), MAPS[name], ticks)
        assert worst.greatest_n <= K * farthest(MAPS[name])
        assert worst.gained_j <= 1e-8

    def test_proxy_with_friction_is_stable(self, name: str, ticks: int):
        """The start of a contact is exact to 1/64 of a tick's way, times the slope of a spike."""
        worst = walk_over(Proxy(static_friction=0.6, dynamic_friction=0.4), MAPS[name], ticks)
        assert worst.greatest_n <= K * farthest(MAPS[name])
        assert worst.gained_j <= K / 2 * FASTEST_M**2

    def test_proxy_with_all_effects_is_stable(self, name: str, ticks: int):
        """Textures turn a force by their slopes, and damping is of a clock that jitters fivefold."""
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
