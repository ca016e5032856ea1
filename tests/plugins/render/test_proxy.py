"""The proxy against exact nearest points, and its ways in and out."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, Force, HapticState, HapticSurface, Material, Relief
from tangible_core.plugins.interfaces import Touch
from tangible_core.testing.synthetic.reliefs import cliff, cone, waves
from tangible_core.testing.synthetic.scenes import KnownSurface, plane, ramp, sphere_cap
from tangible_render.contact import closest, contact
from tangible_render.contact import held as holding
from tangible_render.proxy import Proxy
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_surface

RNG = np.random.default_rng(23)
K = 800.0
LEVEL = plane(0.01).surface
GLUE = Proxy(static_friction=50.0, dynamic_friction=50.0)
"""Holds the proxy where it first is, and so shows by its force where that is."""


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((float(x), float(y), float(z)), velocity))


def stroke(
    known: KnownSurface, seconds: float, depth_m: float, speed: float = 1.0, wide_m: float = 0.034
) -> np.ndarray:
    """A wandering hand at 1 kHz, this deep under the surface; about 82 mm/s at most."""
    t = np.arange(int(1000 * seconds)) / 1000 * speed
    x, y = wide_m * np.sin(2 * np.pi * 0.31 * t), wide_m * np.sin(2 * np.pi * 0.23 * t + 0.7)
    return np.array([known.at(*place, depth_m) for place in np.column_stack([x, y]).tolist()])


def nearest(known: KnownSurface, path: np.ndarray) -> np.ndarray:
    """The exact nearest points of waves, by Newton's method on the formula itself, followed along the path."""
    p, found = path[0, :2].copy(), []
    for hand in path:
        for _ in range(100):
            step = _newton(known, p, hand)
            p += step
            if np.abs(step).max() < 1e-15:
                break
        found.append([*p, known.height_m(*p)])
    return np.array(found)


def _newton(known: KnownSurface, p: np.ndarray, hand: np.ndarray, eps: float = 1e-6) -> np.ndarray:
    slope = np.array(known.slope(*p))
    hessian = np.array([np.subtract(known.slope(*(p + d)), known.slope(*(p - d))) for d in np.eye(2) * eps]) / (2 * eps)
    away = hand - [*p, known.height_m(*p)]
    matrix = np.eye(2) + np.outer(slope, slope) - away[2] * hessian
    return np.linalg.solve(matrix, away[:2] + away[2] * slope)


class TestAccuracy:
    def test_on_a_plane_it_is_a_spring_along_the_normal(self):
        known = ramp()
        for x, y in RNG.uniform(-0.035, 0.035, (20, 2)):
            force = at(Proxy().touch(known.surface), *known.at(x, y, 0.001))
            normal = known.normal(x, y)
            assert np.allclose(force, K * 0.001 * normal[2] * normal, rtol=1e-4, atol=1e-5)

    def test_on_a_sphere_it_points_from_the_centre(self):
        known = sphere_cap(shape=(256, 256))
        for x, y in RNG.uniform(-0.03, 0.03, (20, 2)):
            hand = np.add(known.at(x, y, 0.002), [0, 0, 0.08])  # from the sphere's centre
            out = hand / np.linalg.norm(hand)
            force = np.array(at(Proxy().touch(known.surface), *known.at(x, y, 0.002)))
            assert np.allclose(force, K * (0.1 - np.linalg.norm(hand)) * out, rtol=1e-5, atol=1e-5)

    @pytest.mark.parametrize("shape", [(40, 100), (100, 40)])
    @pytest.mark.parametrize("extent_m", [(0.08, 0.03), (0.03, 0.08)])
    def test_on_a_surface_that_is_not_square(self, shape: tuple[int, int], extent_m: tuple[float, float]):
        """Up to its borders: on a plane the nearest point within them is known."""
        width, length = extent_m
        rows, columns = np.indices(shape) + 0.5
        x, y = (columns / shape[1] - 0.5) * width, (0.5 - rows / shape[0]) * length
        a, b, c = 0.4, -0.7, 0.05
        surface = HapticSurface(Relief((c + a * x + b * y).astype(np.float32), extent_m))
        clamped = 0
        inside = RNG.uniform(-0.5, 0.5, (60, 2)) * extent_m
        inside[20:, 0] = -width / 2 + RNG.uniform(0, 0.001, 40)
        inside[40:, 1] = length / 2 - RNG.uniform(0, 0.001, 20)
        for qx, qy in inside.tolist():
            qz = c + a * qx + b * qy - 0.003
            px, py = (np.array((qx, qy)) + np.array((a, b)) * -0.003 / (1 + a * a + b * b)).tolist()
            if px < -width / 2:
                px, clamped = -width / 2, clamped + 1
                py = qy + b * (qz - c - a * px - b * qy) / (1 + b * b)
            if py > length / 2:
                py, clamped = length / 2, clamped + 1
                px = max(qx + a * (qz - c - b * py - a * qx) / (1 + a * a), -width / 2)
            path = np.tile((qx, qy, qz), (40, 1))  # it goes 0.25 mm a tick at most
            force = Proxy().touch(surface).path(path)[-1]
            assert np.allclose(force, K * np.array((px - qx, py - qy, c + a * px + b * py - qz)), rtol=0, atol=1e-4)
        assert clamped > 20

    @pytest.mark.parametrize("shape", [(26, 256), (256, 26)])
    def test_a_moving_hand_feels_what_one_at_rest_does(self, shape: tuple[int, int]):
        """However long the cells are: the last step of a tick is small beside the shorter side of one."""
        rows, columns = np.indices(shape) + 0.5
        x, y = (columns / shape[1] - 0.5) * 0.08, (0.5 - rows / shape[0]) * 0.08
        heights = 0.008 + 0.004 * np.sin(x * 2 * np.pi / 0.03) * np.cos(y * 2 * np.pi / 0.03)
        surface = HapticSurface(Relief(heights.astype(np.float32), (0.08, 0.08)))
        t = np.linspace(0.001, 0.007, 1000)
        path = np.column_stack([t, 0.8 * t[::-1], 0.0065 + 0.004 * np.sin(t * 210) * np.cos(0.8 * t * 210)])
        still = Proxy().touch(surface).path(np.repeat(path, 6, axis=0))[5::6]
        assert (still[:, 2] > 0).all()
        assert np.linalg.norm(Proxy().touch(surface).path(path) - still, axis=1).max() <= K * 1e-9

    def test_on_fine_cells_a_surface_that_is_smooth_is_read_twice_a_tick(self, monkeypatch: pytest.MonkeyPatch):
        """A step that is long for the cells is the last where it is short for what they show: at most 0.01 um off."""
        c = ((np.arange(512) + 0.5) / 512 - 0.5) * 0.01
        wave = 2 * np.pi / 0.02
        surface = HapticSurface(
            Relief((0.004 * (1 + np.sin(wave * (c + c[:, None])))).astype(np.float32), (0.01, 0.01))
        )
        x = np.arange(-0.004, 0.003, 4e-5)
        path = np.column_stack([x, -0.7 * x, 0.004 * (1 + np.sin(wave * 1.7 * x)) - 0.0008])
        still = Proxy().touch(surface).path(np.repeat(path, 20, axis=0))[19::20]
        assert np.linalg.norm(Proxy().touch(surface).path(path) - still, axis=1)[10:].max() <= K * 1e-8
        read = 0

        def counted(*arguments: Any) -> Any:
            nonlocal read
            read += 1
            return spline.bend(*arguments)

        monkeypatch.setattr(closest, "bend", counted)
        shape, place = spline_surface(surface, "never"), tuple(path[0, :2].tolist())
        for i, hand in enumerate(path.tolist()):
            read = read if i > 10 else 0
            place = cast(Any, closest.settle)(*shape, *place[:2], *hand, 0.0, 0.0, 0.0)
        assert read <= 2.1 * (len(path) - 11)

    @pytest.mark.parametrize("friction", [False, True])
    def test_it_asks_ahead_for_what_it_reads_two_ticks_later(self, monkeypatch: pytest.MonkeyPatch, friction: bool):
        known = waves()
        hands, memory = stroke(known, 0.2, 0.0008), np.zeros(contact.REMEMBERED)
        touch = cast(CompiledTouch, Proxy().touch(known.surface))  # compiled before its parts are exchanged
        asked: list[tuple[float, float]] = []
        monkeypatch.setattr(holding, "prefetch", lambda *arguments: asked.append(arguments[3:]))
        shape, tiles_m = touch.fixed[:5], touch.fixed[5]
        material = np.zeros((4, 4), np.int32), np.array([[K, 0.0, 0.1, 0.05]])
        law, told = (holding.spring_and_damper, material) if friction else (holding.spring, (K,))
        proxies = []
        for hand in hands.tolist():
            cast(Any, law)(shape, tiles_m, *told, memory, *hand, 0.0, 0.0, 0.0)
            proxies.append(memory[:2].copy())
        assert len(asked) == len(hands)
        off_m = np.linalg.norm(np.subtract(asked[5:-2], proxies[7:]), axis=1)
        assert off_m.max() <= 1e-5 < 4e-5 < np.linalg.norm(np.diff(proxies, axis=0), axis=1)[5:].min()

    def test_a_hand_under_all_of_a_tile_is_in_without_a_reading(self, monkeypatch: pytest.MonkeyPatch):
        known = waves()
        path = stroke(known, 4, 0.0008)
        felt, unsure = (cast(CompiledTouch, Proxy().touch(known.surface)) for _ in range(2))
        tiles_m = felt.fixed[5].copy()
        tiles_m[..., 1] = -np.inf
        unsure.fixed = (*unsure.fixed[:5], tiles_m, *unsure.fixed[6:])
        assert (felt.path(path) == unsure.path(path)).all()
        monkeypatch.setattr(contact, "height", None)
        shape, bounds, memory = felt.fixed[:5], felt.fixed[5], np.zeros(contact.REMEMBERED)
        assert cast(Any, contact.approach)(*shape, bounds, memory, 0.0, 0.0, float(bounds[..., 1].min()) - 1e-6, 0.0)

    @pytest.mark.parametrize("depth_m", [0.0002, 0.0008])
    def test_on_waves_at_the_speed_of_a_hand(self, depth_m: float):
        known = waves()
        path = stroke(known, 4, depth_m, speed=0.99)
        assert 0.075 < np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1).max() * 1000 < 0.082
        force, exact = Proxy().touch(known.surface).path(path) / K, nearest(known, path) - path
        off_m = np.linalg.norm(force - exact, axis=1)
        sines = np.linalg.norm(np.cross(force, exact), axis=1) / np.linalg.norm(force, axis=1)
        assert np.percentile(off_m, 99) <= 1e-8
        assert np.percentile(np.degrees(sines / np.linalg.norm(exact, axis=1)), 99) <= 1e-3

    def test_the_track_holds_at_half_a_metre_a_second(self):
        known = waves()
        path = stroke(known, 2, 0.0005, speed=4.4)
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() > 0.0005
        off_m = np.linalg.norm(Proxy().touch(known.surface).path(path) / K + path - nearest(known, path), axis=1)
        assert off_m.max() < 1e-7

    def test_on_a_cone_the_size_and_direction_are_those_of_its_side(self):
        known = cone(slope=0.5)
        for x, y in ((0.02, 0.01), (-0.015, 0.02), (0.0, -0.025)):
            force = np.array(at(Proxy().touch(known.surface), *known.at(x, y, 0.001)))
            assert np.allclose(force, K * 0.001 * known.normal(x, y)[2] * known.normal(x, y), rtol=2e-3, atol=1e-4)


class TestWays:
    def test_it_starts_where_the_hand_came_through(self):
        """Sideways into a cliff half way up: held back along x, not lifted to the top."""
        touch = Proxy().touch(cliff(shape=(512, 512)).surface)
        x = np.linspace(-0.003, 0.0005, 50)
        force = touch.path(np.column_stack([x, np.zeros(50), np.full(50, 0.002)]))
        assert np.allclose(force[-1], [-K * 0.0005, 0, 0], atol=0.12) and abs(force[-1, 0]) > 0.25

    @pytest.mark.parametrize("slope", [(0.0, 0.0), (0.5, 0.0), (-1.5, 0.8)])
    def test_a_contact_starts_on_the_way_within_a_64th_of_where_it_crosses(self, slope: tuple[float, float]):
        """On the side that the hand came from, so that nothing is stored that was not given."""
        known, starts = ramp(slope, 0.1), []
        for _ in range(100):
            x, y, dx, dy, dz = RNG.uniform(-1, 1, 5) * (0.02, 0.02, 0.0028, 0.0028, 0.0028)
            outside = np.array(known.at(x, y, -abs(dz) - 1e-6))
            inside = np.array(known.at(x + dx, y + dy, 0.002))
            if np.linalg.norm(inside - outside) > 0.0049:
                continue
            touch = GLUE.touch(known.surface)
            assert at(touch, *outside) == NO_FORCE
            way = (inside - outside)[:2]
            proxy = inside[:2] + np.array(at(touch, *inside))[:2] / K
            assert (proxy - outside[:2]) @ (-way[1], way[0]) == pytest.approx(0, abs=1e-9)
            over = abs(dz) + 1e-6
            crosses, starts_at = over / (over + 0.002), way @ (proxy - outside[:2]) / (way @ way)
            starts.append(crosses - starts_at)
        assert min(starts) >= -1e-4 and max(starts) <= 1 / 64 + 1e-4
        assert len(starts) > 20 and max(starts) > 1 / 128  # it is searched for in halves

    def test_a_hand_that_is_put_down_deep_is_taken_straight_up(self):
        touch = Proxy().touch(LEVEL)
        assert at(touch, 0.03, 0.03, -0.01) == pytest.approx((0, 0, K * 0.02), rel=1e-5)
        assert at(touch, -0.03, 0.01, 0.005) == pytest.approx((0, 0, K * 0.005), rel=1e-5)

    def test_a_hand_from_beside_the_block_is_held_off_and_let_up_over_the_rim(self):
        touch = Proxy().touch(LEVEL)
        assert at(touch, 0.041, 0.002, 0.004) == NO_FORCE
        assert at(touch, 0.039, 0.003, 0.004) == pytest.approx((K * 0.001, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.007) == pytest.approx((K * 0.002, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.0105) == NO_FORCE
        assert at(touch, 0.038, 0.004, 0.0095) == pytest.approx((0, 0, K * 0.0005), abs=1e-4)

    def test_so_it_is_from_the_far_and_the_near_side(self):
        """Of a block that is not square."""
        touch = Proxy().touch(HapticSurface(Relief(np.full((64, 64), 0.01, np.float32), (0.08, 0.05))))
        for side in (1, -1):
            assert at(touch, 0.002, side * 0.026, 0.004) == NO_FORCE
            assert at(touch, 0.003, side * 0.024, 0.004) == pytest.approx((0, side * K * 0.001, 0), abs=1e-9)
            assert at(touch, 0.004, side * 0.023, 0.007) == pytest.approx((0, side * K * 0.002, 0), abs=1e-9)
            assert at(touch, 0.004, side * 0.023, 0.0105) == NO_FORCE
            assert at(touch, 0.004, side * 0.023, 0.0095) == pytest.approx((0, 0, K * 0.0005), abs=1e-4)

    def test_a_hand_that_rises_over_the_rim_in_the_block_is_let_to_the_top(self):
        """Not at once over to where it is: from the place at the rim on."""
        touch = Proxy(static_friction=0.5, dynamic_friction=0.5).touch(ramp((1.0, 0.0), 0.05).surface)
        assert at(touch, -0.041, 0.0, 0.005) == NO_FORCE
        held = at(touch, -0.038, 0.0, 0.006)
        assert held == pytest.approx((-K * 0.002, 0, 0), abs=1e-9)
        assert at(touch, -0.038, 0.0, 0.0101).z > 0

    def test_a_wall_does_not_throw_the_hand_out_at_its_far_side(self):
        heights = np.zeros((256, 256))
        heights[:, 100:116] = 0.01  # 5 mm thick
        touch = Proxy().touch(HapticSurface.from_heights(heights))
        x = np.linspace(-0.012, -0.005, 200)
        force = touch.path(np.column_stack([x, np.zeros(200), np.full(200, 0.005)]))
        assert (force[:, 0] <= 1e-9).all() and force[-1, 0] < -1.0

    def test_a_proxy_left_far_behind_is_let_go(self):
        heights = np.zeros((256, 256))
        heights[:, 60:] = 0.006
        touch = Proxy().touch(HapticSurface.from_heights(heights))
        x = np.linspace(-0.03, 0.03, 600)
        force = touch.path(np.column_stack([x, np.zeros(600), np.full(600, 0.004)]))
        assert np.linalg.norm(force, axis=1).max() < K * 0.0201
        assert force[-1] == pytest.approx([0, 0, K * 0.002], abs=1e-3)

    def test_it_is_not_let_go_where_the_surface_above_is_farther(self):
        """24 mm deep it is let go where it is left farther behind than that, not 20 mm."""
        z, x = np.linspace(0.0099, -0.014, 30), np.append(np.linspace(0, 0.0238, 30), 0.0242)
        path = np.vstack([np.column_stack([0 * z, 0 * z, z]), np.column_stack([x, 0 * x, np.full(31, -0.014)])])
        force = GLUE.touch(LEVEL).path(path)
        assert force[-2] == pytest.approx((-K * 0.0238, 0, K * 0.024), abs=1e-5)
        assert force[-1] == pytest.approx((0, 0, K * 0.024), abs=1e-5)

    @pytest.mark.parametrize("axis", range(3))
    def test_a_hand_that_moves_5_mm_in_a_tick_is_new(self, axis: int):
        for leap_m, held in ((0.0049, True), (0.0051, False)):
            hand, touch = np.array((0.001, 0.001, 0.0)), GLUE.touch(LEVEL)
            at(touch, 0.0, 0.0, 0.0)
            assert at(touch, *hand) == pytest.approx((-K * 0.001, -K * 0.001, K * 0.01), abs=1e-5)
            hand[axis] -= leap_m
            x, y, z = hand if held else (0.0, 0.0, hand[2])
            assert at(touch, *hand) == pytest.approx((-K * x, -K * y, K * (0.01 - z)), abs=1e-5)

    def test_in_a_tick_it_goes_two_millimetres_at_most(self):
        """Eight steps of a quarter: after a hand that moved by 4.5 mm it arrives in the third tick."""
        touch = Proxy(damping_n_s_per_m=1e-300).touch(LEVEL)
        at(touch, 0.0, 0.0, 0.009)
        for behind_m in (0.0025, 0.0005, 0.0):
            assert at(touch, 0.0027, 0.0036, 0.009) == pytest.approx(
                (-K * behind_m * 0.6, -K * behind_m * 0.8, K * 0.001), abs=1e-6
            )

    def test_a_wall_between_level_grounds_is_not_leapt_over(self):
        """The short cut on level ground is taken in the tile alone that the proxy is in."""
        heights = np.full((256, 256), 0.004)
        heights[:, 135:137] = 0.02
        path = np.column_stack([np.linspace(-0.004, 0.012, 800), np.full(800, 0.001), np.full(800, 0.002)])
        surface = HapticSurface.from_heights(heights)
        general, quick = Proxy(damping_n_s_per_m=1e-300).touch(surface), Proxy().touch(surface)
        found = quick.path(path)
        assert np.allclose(general.path(path), found, rtol=0, atol=1e-6)
        assert found[path[:, 0] > 0.005, 0].max() < -K * 0.003

    def test_so_is_one_at_the_side_of_the_block(self):
        x = np.linspace(0.041, -0.03, 1000)
        force = Proxy().touch(LEVEL).path(np.column_stack([x, np.zeros(1000), np.full(1000, 0.004)]))
        assert np.linalg.norm(force, axis=1).max() < K * 0.0201
        assert force[-1] == pytest.approx([0, 0, K * 0.006], abs=1e-6)

    @pytest.mark.parametrize(
        "other", [{}, {"damping_n_s_per_m": 1.0}, {"roughness_m": 1e-4}], ids=["spring", "damped", "textured"]
    )
    def test_a_force_that_is_no_number_is_none(self, other: dict[str, float]):
        rock = replace(Material("rock", 1e308, 0.0, 0.0, 0.0), **other)
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01), 0.08, np.zeros((8, 8), np.int32), (rock,))
        touch = Proxy().touch(surface)
        assert at(touch, 0.0, 0.0, 0.009).z > 1e300
        assert at(touch, 0.0, 0.0, -1000.0) == NO_FORCE
        assert at(touch, 0.0, 0.0, 0.009).z > 1e300

    def test_where_nothing_is_touched_there_is_no_proxy(self):
        for renderer in (Proxy(), Proxy(static_friction=0.5, dynamic_friction=0.5)):
            touch = renderer.touch(LEVEL)
            assert isinstance(touch, CompiledTouch)
            at(touch, 0.01, 0.02, 0.009)
            assert touch.memory[:3] == pytest.approx((0.01, 0.02, 0.01))
            for elsewhere in ((0.01, 0.02, 0.011), (0.5, 0.02, 0.009), (np.nan, 0.02, 0.009)):
                at(touch, *elsewhere)
                assert np.isnan(touch.memory[2])
                at(touch, 0.01, 0.02, 0.009)

    def test_a_lost_state_ends_the_contact(self):
        touch = Proxy(static_friction=5.0, dynamic_friction=5.0).touch(LEVEL)
        at(touch, 0.0, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009).x < -0.5
        assert at(touch, np.nan, 0.0, 0.009) == NO_FORCE
        assert at(touch, 0.002, 0.0, 0.009).x == pytest.approx(0, abs=1e-9)


class TestMaterials:
    def test_the_spring_is_that_of_where_the_proxy_is(self):
        labels = np.zeros((64, 64), np.int32)
        labels[:, 32:] = 1
        hard, soft = (Material(name, k, 0.0, 50.0, 50.0) for name, k in (("hard", 1200.0), ("soft", 300.0)))
        surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, (hard, soft))
        touch = Proxy().touch(surface)
        at(touch, -0.001, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009) == pytest.approx((-1200 * 0.002, 0, 1200 * 0.001), abs=1e-5)

    def test_it_says_the_greatest_stiffness(self):
        """By which the guard of a loop softens it."""
        soft = Material("soft", 300.0, 0.0, 0.0, 0.0)
        labels = np.arange(4096, dtype=np.int32).reshape(64, 64) % 3
        for other in ({}, {"damping_n_s_per_m": 1.0}, {"roughness_m": 1e-4}):
            materials = tuple(replace(soft, stiffness_n_per_m=k, **other) for k in (500.0, 1500.0, 900.0))
            touch = Proxy().touch(HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, materials))
            assert isinstance(touch, CompiledTouch)
            assert touch.stiffness_n_per_m == 1500.0
        plain = Proxy(stiffness_n_per_m=700.0).touch(LEVEL)
        assert isinstance(plain, CompiledTouch)
        assert plain.stiffness_n_per_m == 700.0
