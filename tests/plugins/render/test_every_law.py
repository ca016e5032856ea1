"""Properties of every force law: free air, states and surfaces of any kind, options."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planes import UP_M, WIDTH_M, at, tilted
from tangible_core.data import NO_FORCE, HapticState, HapticSurface, Relief
from tangible_core.errors import GeometryError, OptionError
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

    def test_path_is_force_by_force(self, renderer):
        path = np.column_stack([RNG.uniform(-0.035, 0.035, (300, 2)), RNG.uniform(-0.002, 0.005, 300)])
        path[77] = np.nan
        steps = np.diff(path, axis=0, prepend=path[:1]) / 0.002
        steps[[77, 78]] = 0  # a step from or to nowhere has no velocity
        touch = renderer.touch(BUMPY)
        singly = [touch.force(HapticState(tuple(p), tuple(v))) for p, v in zip(path, steps, strict=True)]
        assert np.array_equal(renderer.touch(BUMPY).path(path, period_s=0.002), singly)
        assert np.count_nonzero(singly) > 50

    @pytest.mark.usefixtures("unchecked_shapes")
    def test_path_of_any_layout_is_the_same(self, renderer):
        def forces_on(path: np.ndarray) -> np.ndarray:
            return renderer.touch(BUMPY).path(path)

        assert forces_on(np.empty((0, 3))).shape == (0, 3)
        path = np.asfortranarray(RNG.uniform(-0.003, 0.003, (10, 3)))
        path.flags.writeable = False
        assert np.array_equal(forces_on(path), forces_on(np.ascontiguousarray(path)))
        assert np.array_equal(forces_on(np.zeros((1, 3), int)), [at(renderer.touch(BUMPY), 0, 0, 0)])

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize("shape", [(3,), (3, 2), (2, 3, 3)])
    def test_path_of_another_shape_is_refused(self, renderer, shape: tuple[int, ...]):
        with pytest.raises(GeometryError, match=r"\(n, 3\)"):
            renderer.touch(BUMPY).path(np.zeros(shape))

    @pytest.mark.parametrize("period_s", [0.0, -1.0, np.nan, np.inf])
    def test_period_not_positive_is_refused(self, renderer, period_s: float):
        with pytest.raises(GeometryError, match="period_s"):
            renderer.touch(BUMPY).path(np.zeros((2, 3)), period_s)

    @pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1), (2, 1)])
    def test_smallest_surfaces_have_finite_forces(self, renderer, shape: tuple[int, int]):
        touch = renderer.touch(HapticSurface(Relief(np.full(shape, UP_M, np.float32), (WIDTH_M, WIDTH_M))))
        expected = renderer.touch(tilted(0, 0))
        for x, y in ((0, 0), (0.03125, -0.03125), (-0.013, 0.021)):
            assert at(touch, x, y, 0.001) == pytest.approx(at(expected, x, y, 0.001), abs=1e-12)

    def test_heights_of_any_layout_are_the_same(self, renderer):
        heights = np.asarray(RNG.uniform(0, 0.004, (6, 9)), np.float32)
        extent = (WIDTH_M, WIDTH_M)
        plain = renderer.touch(HapticSurface(Relief(heights, extent)))
        turned = renderer.touch(HapticSurface(Relief(np.asfortranarray(heights), extent)))
        path = RNG.uniform(-0.004, 0.004, (50, 3))
        assert np.array_equal(plain.path(path), turned.path(path))

    @given(st.lists(st.floats(), min_size=6, max_size=6))
    def test_force_at_any_state_is_finite(self, renderer, numbers: list[float]):
        force = at(renderer.touch(BUMPY), *numbers[:3], velocity=tuple(numbers[3:]))
        assert np.isfinite(force).all()


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
