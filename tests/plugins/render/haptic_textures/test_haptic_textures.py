"""A material's texture would feel wrong, buzz, or push the hand on."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import Material
from tangible_core.errors import MaterialError
from tangible_core.materials.assignment import library
from tangible_render.haptic_textures import compile_textures, peak_wavelength_m, radial_spectrum, sample_tile, stroke
from tangible_render.haptic_textures.forces import STATE, along, texture_force
from tangible_render.haptic_textures.heights import GONE, WHOLE, remaining, texture_height
from tangible_render.haptic_textures.sample import line_spectrum
from tangible_render.haptic_textures.table import DRAG, STIFFNESS, SWING, WAVES, directions, waves

TICK_S = 0.001
GRAIN_M, ROUGH_M = 1e-3, 1e-4
PLAIN = Material("made up", 500.0, 1.0, 0.6, 0.5, roughness_m=ROUGH_M, grain_m=GRAIN_M)
RUBBER = replace(PLAIN, name="rubber", texture="stick-slip", roughness_m=0.0)
ROUGH = [each for each in library().values() if each.roughness_m]
WAVING = [replace(PLAIN, anisotropy=0.3, direction_deg=20.0), replace(PLAIN, texture="periodic", irregularity=0.4)]

points = st.tuples(*[st.floats(-0.1, 0.1)] * 2)


def heights(material: Material, xs: np.ndarray, ys: np.ndarray, vx: float = 0.0, vy: float = 0.0) -> np.ndarray:
    """Return h, dh/dx and dh/dy at points, (n, 3)."""
    table = compile_textures([material])
    return np.array([texture_height(table, 0, x, y, vx, vy, TICK_S) for x, y in zip(xs, ys, strict=True)])


def forces(material: Material, path_m: np.ndarray, normal_n: np.ndarray | float = 1.0) -> np.ndarray:
    """Return the lateral force along a path without velocity, (n, 2), a row each tick."""
    table, state = compile_textures([material]), np.zeros(STATE)
    normals = np.broadcast_to(normal_n, len(path_m))
    return np.array([texture_force(table, 0, state, *p, 0.0, 0.0, n) for p, n in zip(path_m, normals, strict=True)])


def line(length_m: float, step_m: float) -> np.ndarray:
    """Return positions along x."""
    return np.arange(0, length_m, step_m)[:, None] * (1.0, 0.0)


def unit(random: np.random.Generator) -> np.ndarray:
    """Return a random direction."""
    angle = random.uniform(0, 2 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


def by_name(material: Material) -> str:
    return material.name


def series(angle_rad: float, first: int) -> float:
    """Return the cosine (first: 0) or sine (1) of an angle by its series in fractions, rounded once."""
    x = Fraction(angle_rad)
    return float(sum((-1) ** n * x ** (2 * n + first) / math.factorial(2 * n + first) for n in range(45)))


class TestWaves:
    # of the first four, one function of Debian's C library is not the nearest number
    HARD = (7.676830714897059, 7.499854328744833, 3.6283649819710115, 3.6201619344866383)

    @pytest.mark.parametrize("angle_rad", [*HARD, 0.0, -0.5, math.pi, -math.pi / 2, 2 * math.pi, 1e-9])
    def test_directions_are_the_nearest_numbers_on_every_system(self, angle_rad: float):
        found = directions(np.array([angle_rad]))
        assert [float(each[0]) for each in found] == [series(angle_rad, 0), series(angle_rad, 1)]

    @pytest.mark.parametrize("material", ROUGH, ids=by_name)
    def test_roughness_is_the_amplitude_of_one_wave_of_the_same_power(self, material: Material):
        made = waves(material)
        assert np.sum(made.amplitude_m**2) == pytest.approx(material.roughness_m**2, rel=1e-12)
        assert 0 < len(made.phase) <= WAVES

    def test_seed_gives_the_same_waves_on_every_machine(self):
        made = waves(replace(PLAIN, name="sand", seed=3))
        assert made.phase[:3] == pytest.approx([0.5365125855, 0.9444867216, 0.2684379101], abs=1e-9)

    @pytest.mark.parametrize(("texture", "count"), [("stochastic", 24), ("drag", 24), ("stick-slip", 8)])
    def test_noise_fills_one_octave_and_its_fan(self, texture: str, count: int):
        """Expect one wave in each stratum: of a triangle in octaves, its tip at the grain, and of a fan."""
        made = waves(replace(RUBBER, texture=texture, roughness_m=ROUGH_M, drag_n_s_per_m=1.0, anisotropy=0.75, seed=5))
        octaves = np.sort(np.log2(np.hypot(made.fx, made.fy) * GRAIN_M))
        below = 0.5 + 0.5 * np.sign(octaves) * (1 - (1 - 2 * np.abs(octaves)) ** 2)
        assert below == pytest.approx((np.arange(count) + 0.5) / count, abs=1e-9)
        across_deg = np.sort(np.rad2deg(np.arctan2(made.fx, made.fy)))  # away from lines that run along x
        assert np.array_equal(np.floor((across_deg / 45 + 0.5) * count), np.arange(count))
        assert made.amplitude_m == pytest.approx(ROUGH_M / np.sqrt(count))

    def test_weaves_and_irregular_lines_have_their_powers(self):
        made = waves(replace(PLAIN, texture="periodic", anisotropy=0.6, direction_deg=30.0))
        ahead, across = np.argsort(made.amplitude_m)
        assert made.amplitude_m[ahead] / made.amplitude_m[across] == pytest.approx(0.4)
        ways = np.rad2deg(np.arctan2(made.fy, made.fx)) % 180
        assert ways[[across, ahead]] == pytest.approx([120, 30])
        assert np.hypot(made.fx, made.fy) == pytest.approx(1 / GRAIN_M)
        made = waves(replace(PLAIN, texture="periodic", anisotropy=1.0, direction_deg=30.0, irregularity=0.4))
        share = made.amplitude_m**2 / ROUGH_M**2
        assert share == pytest.approx([0.6, *[0.4 / 7] * 7])
        octaves = np.log2(np.hypot(made.fx, made.fy) * GRAIN_M)
        assert octaves == pytest.approx([0, *np.linspace(-0.1, 0.1, 7)], abs=1e-9)
        turned_deg = np.rad2deg(np.arctan2(made.fy, made.fx)) % 180 - 120
        assert turned_deg[0] == pytest.approx(0, abs=1e-9)
        assert np.sort(turned_deg[1:]) == pytest.approx(np.linspace(-6, 6, 7), abs=1e-9)


class TestHeights:
    @given(points)
    def test_lines_are_a_cosine(self, at: tuple[float, float]):
        lines = replace(PLAIN, texture="periodic", anisotropy=1.0)
        turn = 2 * np.pi / GRAIN_M
        height, slope_x, slope_y = heights(lines, *np.transpose([at]))[0]
        assert height == pytest.approx(ROUGH_M * np.cos(turn * at[1]), abs=1e-9 * ROUGH_M)
        assert slope_x == pytest.approx(0, abs=1e-12)
        assert slope_y == pytest.approx(-ROUGH_M * turn * np.sin(turn * at[1]), abs=1e-8)

    @pytest.mark.parametrize("material", ROUGH, ids=by_name)
    def test_gradient_is_that_of_the_height(self, material: Material):
        x, y = np.random.default_rng(0).uniform(-0.05, 0.05, (2, 50))
        step_m = 1e-5 * material.grain_m
        found = heights(material, x, y)
        across = heights(material, x + step_m, y)[:, 0] - heights(material, x - step_m, y)[:, 0]
        away = heights(material, x, y + step_m)[:, 0] - heights(material, x, y - step_m)[:, 0]
        steep = 2 * np.pi * material.roughness_m / material.grain_m
        assert found[:, 1] == pytest.approx(across / (2 * step_m), abs=1e-5 * steep)
        assert found[:, 2] == pytest.approx(away / (2 * step_m), abs=1e-5 * steep)

    @given(st.tuples(*[st.floats()] * 4))
    def test_height_is_finite_everywhere(self, state: tuple[float, ...]):
        table = compile_textures([PLAIN])
        found = texture_height(table, 0, *state, TICK_S)
        assert np.isfinite(found).all()
        assert np.abs(found[0]) <= 1.000001 * np.sqrt(WAVES) * ROUGH_M
        if not np.isfinite(state).all():
            assert found == (0.0, 0.0, 0.0)

    @pytest.mark.parametrize("grain_m", [1e-300, 1e-12, 1e12])
    def test_extreme_grains_stay_finite(self, grain_m: float):
        assert np.isfinite(heights(replace(PLAIN, grain_m=grain_m), *np.array([[0.01], [0.02]]))).all()

    def test_table_serves_many_materials(self):
        table = compile_textures([PLAIN, RUBBER, library()["water"]])
        assert texture_height(table, 1, 0.01, 0.0, 0.0, 0.0, TICK_S) == (0.0, 0.0, 0.0)
        assert texture_height(table, 0, 0.01, 0.0, 0.0, 0.0, TICK_S)[0] != 0
        assert list(table[:, STIFFNESS]) == [0, 500, 0]
        assert list(table[:, DRAG]) == [0, 0, library()["water"].drag_n_s_per_m]
        swings = compile_textures([RUBBER, replace(RUBBER, static_friction=5.0)])[:, SWING]
        assert swings == pytest.approx([0.2, 0.9])  # a friction that comes down to 0 would have to stay there
        assert not table.flags.writeable
        assert compile_textures([]).shape == (0, table.shape[1])


class TestSampling:
    def test_wave_is_whole_gone_or_between_and_a_slow_hand_gets_the_whole_texture(self):
        assert [remaining(turns) for turns in (0.0, WHOLE, GONE, 0.5, 1e300)] == [1, 1, 0, 0, 0]
        assert (WHOLE, GONE) == (1 / 5, 1 / 3)
        assert remaining(0.25) == pytest.approx(1 - 3 * 0.375**2 + 2 * 0.375**3)
        x = np.linspace(0, 0.02, 100)
        slow = 0.99 * WHOLE * GRAIN_M / np.sqrt(2) / TICK_S  # the shortest wave is half an octave below the grain
        assert np.array_equal(heights(PLAIN, x, 0 * x, slow), heights(PLAIN, x, 0 * x))


class TestDrag:
    @given(points, st.tuples(*[st.floats(-1, 1)] * 2), st.floats(1e-3, 10))
    def test_drag_opposes_the_velocity_only_and_is_zero_without_contact(
        self, at: tuple, velocity: tuple, normal_n: float
    ):
        table = compile_textures([library()["water"]])
        found = texture_force(table, 0, np.zeros(STATE), *at, *velocity, normal_n)
        assert found == pytest.approx(-library()["water"].drag_n_s_per_m * np.array(velocity))
        assert texture_force(table, 0, np.zeros(STATE), 0.0, 0.0, 1.0, 1.0, 0.0) == (0.0, 0.0)


class TestStickSlip:
    def test_friction_is_a_spring_until_it_slips_at_the_static_friction_to_the_dynamic_one_on_average(self):
        for normal_n in (0.5, 1.0, 3.0):
            pull_n = -forces(RUBBER, line(0.01, 1e-6), normal_n)[:, 0]
            assert pull_n.max() == pytest.approx(RUBBER.static_friction * normal_n, rel=2e-3)
        sliding_n = -forces(RUBBER, line(0.0412, 2e-5))[600:, 0]  # forty grains
        assert sliding_n.mean() == pytest.approx(RUBBER.dynamic_friction, rel=0.005)
        assert sliding_n.min() == pytest.approx(2 * RUBBER.dynamic_friction - RUBBER.static_friction, rel=0.01)
        way_m = np.append(np.linspace(0, 5e-4, 50), np.linspace(5e-4, 0, 50))
        found = forces(RUBBER, way_m[:, None] * (0.6, -0.8))
        rise = RUBBER.stiffness_n_per_m * RUBBER.static_friction / RUBBER.dynamic_friction
        assert found == pytest.approx(-rise * way_m[:, None] * (0.6, -0.8), abs=1e-12)

    @pytest.mark.parametrize("static_friction", [0.5, 0.6, 5.0])
    def test_bristle_stores_no_more_than_the_hand_puts_in(self, static_friction: float):
        """Take a tick from any state: k m |z|^2 / 2 must grow by -F.dx at most."""
        sticky = replace(RUBBER, static_friction=static_friction)
        table, random = compile_textures([sticky]), np.random.default_rng(4)
        k, swing = sticky.stiffness_n_per_m, min(static_friction / sticky.dynamic_friction - 1, 0.9)
        tight = 0
        for i in range(4000):
            bristle_m = 10 ** random.uniform(-5, -1.5) * unit(random)
            level = 1 + random.uniform(-swing, swing)
            step_m, most_m = 10 ** random.uniform(-6, -2) * unit(random), 10 ** random.uniform(-6, -1.5)
            if i % 2:
                shorter = random.uniform(0.5, 1)
                step_m, most_m = -bristle_m * (1 - shorter) / 2, float(np.hypot(*bristle_m)) * shorter
            state = np.array([0.0, 0.0, *bristle_m, random.random(), level, 1.0])
            before_j = k * level * bristle_m @ bristle_m / 2
            force_n = texture_force(table, 0, state, *step_m, 0.0, 0.0, most_m * k / sticky.dynamic_friction)
            after_j = k * state[5] * state[2:4] @ state[2:4] / 2
            gained_j = after_j - before_j + np.dot(force_n, step_m)
            assert force_n == pytest.approx(-k * state[5] * state[2:4])
            assert gained_j <= 1e-12 * (before_j + after_j)
            tight += gained_j > -1e-12 * (before_j + after_j)
        assert static_friction == 0.5 or tight > 100  # where the bound holds the level back, it is met exactly

    @pytest.mark.parametrize("turns", [0.01, 0.07, 0.11, 0.15, 0.3])
    def test_level_rises_over_a_grain_and_falls_at_once(self, turns: float):
        """Compare with a sawtooth of four harmonics with Lanczos' factors, each gone above a third of the rate."""
        table, state, normal_n = compile_textures([RUBBER]), np.zeros(STATE), 0.01
        most_m = RUBBER.dynamic_friction * normal_n / RUBBER.stiffness_n_per_m
        texture_force(table, 0, state, 0.0, 0.0, 0.0, 0.0, normal_n)
        n, fine = np.arange(1, 5), np.linspace(0, np.pi, 100001)
        lanczos = np.sinc(n / 5) / n
        high = lanczos / np.max(lanczos @ np.sin(np.outer(n, fine)))
        over = np.clip((n * turns - 1 / 5) / (1 / 3 - 1 / 5), 0, 1)
        high = high * (1 - over**2 * (3 - 2 * over))
        swing = RUBBER.static_friction / RUBBER.dynamic_friction - 1
        for i in range(1, 40):
            x = most_m + i * turns * GRAIN_M
            found = texture_force(table, 0, state, x, 0.0, 0.0, 0.0, normal_n)[0]
            level = 1 - swing * np.sum(high * np.sin(2 * np.pi * n * i * turns))
            assert -found == pytest.approx(level * RUBBER.dynamic_friction * normal_n, rel=1e-5)
            assert 0 <= state[4] < 1  # turns are left out, so that a phase keeps its digits

    @pytest.mark.parametrize(
        ("material", "between"),
        [
            (0, (0.0, 0.0, 0.0, 0.0, 0.0)),
            (0, (0.0, 0.0, 0.0, 0.0, -1.0)),
            (0, (np.nan, 0.0, 0.0, 0.0, 1.0)),
            (0, (0.0, 0.0, np.inf, 0.0, 1.0)),
            (0, (1e200, 0.0, 0.0, 0.0, 1.0)),
            (1, (0.0, 0.0, 0.0, 0.0, 1.0)),
            (2, (0.0, 0.0, 0.0, 0.0, 1.0)),
        ],
        ids=["lifted", "under tension", "no number", "no speed", "flung away", "on another", "on none"],
    )
    def test_each_contact_starts_afresh(self, material: int, between: tuple[float, ...]):
        table, state = compile_textures([RUBBER, replace(RUBBER, name="soft"), PLAIN]), np.zeros(STATE)
        way_m = np.append(np.linspace(0, 0.0034, 100), np.linspace(0.0034, 0.0022, 30))[:, None] * (0.6, -0.8)

        def strokes() -> list[tuple[float, float]]:
            return [texture_force(table, 0, state, *at, 0.0, 0.0, 1.0) for at in way_m]

        first = strokes()
        assert texture_force(table, material, state, *between) == (0.0, 0.0)
        assert strokes() == first


class TestTile:
    def test_tile_has_the_heights_at_its_pixel_centres(self):
        for material in WAVING:
            tile = sample_tile(material, 0.004, 40)
            at_m = (np.arange(40) + 0.5) * 1e-4 - 0.002
            x, y = np.meshgrid(at_m, at_m[::-1])  # the top row is far
            expected = heights(material, x.ravel(), y.ravel())[:, 0].reshape(40, 40)
            assert tile == pytest.approx(expected, abs=1e-6 * ROUGH_M)

    @pytest.mark.parametrize("direction_deg", [0.0, 90.0])
    def test_tile_leaves_out_undersampled_waves(self, direction_deg: float):
        lines = replace(PLAIN, texture="periodic", anisotropy=1.0, direction_deg=direction_deg)
        assert not sample_tile(lines, 0.1, 299).any()
        assert sample_tile(lines, 0.1, 301).any()

    @pytest.mark.parametrize(("width_m", "pixels"), [(0.0, 8), (np.nan, 8), (np.inf, 8), (-1.0, 8), (0.01, 0)])
    def test_tile_of_wrong_size_is_refused(self, width_m: float, pixels: int):
        with pytest.raises(MaterialError):
            sample_tile(PLAIN, width_m, pixels)


class TestSpectrum:
    @pytest.mark.parametrize("material", ROUGH, ids=by_name)
    def test_spectrum_peaks_at_the_stated_wavelength(self, material: Material):
        width_m = 96 * material.grain_m
        tile = sample_tile(material, width_m, 480)
        assert peak_wavelength_m(radial_spectrum(tile, width_m)) == pytest.approx(material.grain_m, rel=0.05)

    def test_spectrum_of_a_line_is_blurred_over_an_eighth_of_an_octave(self):
        for spectrum in (
            line_spectrum(np.cos(2 * np.pi * np.arange(4000) / 10), 0.1),
            radial_spectrum(np.cos(2 * np.pi * np.arange(512) / 8) * np.ones((512, 1)), 0.1),
        ):
            octaves, power = np.log2(spectrum[0]), spectrum[1]
            assert power.sum() == pytest.approx(1)
            assert np.all(np.diff(octaves) < 0)
            middle = octaves @ power
            assert np.sqrt((octaves - middle) ** 2 @ power) == pytest.approx(1 / 8, rel=0.05)


class TestStroke:
    def test_strokes_take_any_direction_and_equal_ticks(self):
        """Stroke lines along x away from the user at 2 kHz: a wave of 1 mm at 100 mm/s spans 20 ticks."""
        lines, speed_m_per_s = replace(PLAIN, texture="periodic", anisotropy=1.0), 0.1
        felt = stroke(lines, speed_m_per_s, 2.0, 0.005, 0.0005, 90.0)
        turn = 2 * np.pi / GRAIN_M
        assert felt.way_m == pytest.approx(np.arange(round(0.005 / speed_m_per_s * 2000)) * speed_m_per_s / 2000)
        assert felt.height_m == pytest.approx(ROUGH_M * np.cos(turn * felt.way_m), abs=1e-12)
        assert felt.force_n[1:] == pytest.approx(
            -2 * lines.dynamic_friction + 2 * ROUGH_M * turn * np.sin(turn * felt.way_m[1:]), abs=1e-6
        )
        assert not np.any(stroke(lines, speed_m_per_s, 2.0, 0.005, 0.0005, 0.0).height_m - ROUGH_M)
        assert stroke(RUBBER, 0.02).force_n.min() == pytest.approx(-RUBBER.static_friction, rel=0.02)
        table = compile_textures([library()["skin"]])
        path_m = np.cumsum(np.random.default_rng(0).normal(0, 1e-4, (50, 2)), axis=0)
        felt, state = np.empty((50, 5)), np.zeros(STATE)
        along(table, 0, np.zeros(STATE), path_m, TICK_S, 1.0, felt)
        velocity = np.diff(path_m, axis=0, prepend=path_m[:1]) / TICK_S
        for row, at, v in zip(felt, path_m, velocity, strict=True):
            assert row[:3] == pytest.approx(texture_height(table, 0, *at, *v, TICK_S), rel=1e-12)
            assert row[3:] == pytest.approx(texture_force(table, 0, state, *at, *v, 1.0), rel=1e-12)

    @pytest.mark.parametrize(
        "wrong", [{"speed_m_per_s": 0.0}, {"normal_n": -1.0}, {"length_m": np.nan}, {"direction_deg": np.inf}]
    )
    def test_wrong_stroke_is_refused(self, wrong: dict[str, float]):
        with pytest.raises(MaterialError):
            stroke(PLAIN, **wrong)
