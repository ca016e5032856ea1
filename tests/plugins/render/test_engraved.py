"""A border between parts would be felt in the wrong place, too shallow or ragged: a groove of the stated section."""

from dataclasses import replace

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import HapticSurface, Relief, digest_of
from tangible_core.errors import OptionError
from tangible_core.materials.assignment import library
from tangible_core.plugins import ForceRenderer
from tangible_core.plugins.notes import collected
from tangible_core.plugins.registry import load_method
from tangible_devices import Mock
from tangible_render import borders
from tangible_render.borders import border_distance
from tangible_render.engraved import Engraved
from tangible_render.proxy import Proxy
from tangible_render.with_materials import WithMaterials

SIDE_M, HIGH_M, K = 0.08, 0.004, 600.0
GROOVE = Engraved(law={"use": "penalty-gradient", "stiffness_n_per_m": K}, width_m=0.003, depth_m=0.0006)


def grid(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of the cells' centres."""
    rows, columns = np.indices((cells, cells))
    return ((columns + 0.5) / cells - 0.5) * SIDE_M, (0.5 - (rows + 0.5) / cells) * SIDE_M


def level(labels: np.ndarray, height_m: float = HIGH_M) -> HapticSurface:
    relief = Relief(np.full(labels.shape, height_m, np.float32), (SIDE_M, SIDE_M))
    return HapticSurface(relief, labels.astype(np.int32))


def section(distance_m: np.ndarray, method: Engraved = GROOVE) -> np.ndarray:
    """Return the formula's section, a raised cosine."""
    within = np.abs(distance_m) < method.width_m / 2
    return np.where(within, method.depth_m / 2 * (1 + np.cos(2 * np.pi * distance_m / method.width_m)), 0.0)


def straight(cells: int, degrees: float) -> tuple[HapticSurface, np.ndarray, np.ndarray]:
    """Two halves; the distance of each cell from the line between them; the cells whose nearest point is in sight."""
    turn, (x, y) = np.radians(degrees), grid(cells)
    aside_m = 0.0 if degrees % 90 == 0 else 0.31 * SIDE_M / cells
    distance_m = y * np.cos(turn) - x * np.sin(turn) - aside_m
    inner = np.maximum(np.abs(x), np.abs(y)) < SIDE_M / 2 - 0.003
    return level(distance_m > 0), distance_m, inner


class TestSection:
    @pytest.mark.parametrize("cells", [400])
    @pytest.mark.parametrize("degrees", [0, 3, 22.5, 45, 77, 90, 130])
    def test_section_on_a_straight_border_is_the_formula(self, cells: int, degrees: float):
        """The error is 4 um on average and 17 um at most on cells of 0.2 mm, half of that on cells half as wide."""
        surface, distance_m, inner = straight(cells, degrees)
        near = inner & (np.abs(distance_m) < GROOVE.width_m / 2)
        error_m = np.abs(HIGH_M - GROOVE.felt(surface).height_m - section(distance_m))
        assert error_m[near].mean() < 4e-6 * 400 / cells
        assert error_m[inner].max() < 17e-6 * 400 / cells

    def test_circle_keeps_its_radius_and_lines_stay_by_the_labels(self):
        x, y = grid(400)
        distance_m = np.hypot(x, y) - 0.0203
        error_m = np.abs(HIGH_M - GROOVE.felt(level(distance_m < 0)).height_m - section(distance_m))
        assert error_m.max() < 5e-5 and error_m.mean() < 1e-6
        labels = np.random.default_rng(0).integers(0, 2, (40, 50)).astype(np.int32)
        at, beside = borders.border_lines(labels)
        assert len(at) == sum(np.count_nonzero(np.diff(labels, axis=axis)) for axis in (0, 1))
        away = np.abs(at - borders._sides(labels)[0])
        assert 0.49 < away.max() <= 0.5 and beside.min() >= 0 and beside.max() < len(at)
        x, y = grid(400)
        labels = ((x > 0) + 2 * (y > 0)).astype(np.int32)
        carved = GROOVE.felt(level(labels)).height_m
        away = np.minimum(np.abs(x), np.abs(y))
        assert np.abs(HIGH_M - carved - section(away)).max() < 2e-5
        wide = HapticSurface(Relief(np.full((400, 200), HIGH_M, np.float32), (SIDE_M, SIDE_M)), labels[:, ::2])
        assert np.abs(GROOVE.felt(wide).height_m - carved[:, ::2])[5:-5, 10:-10].max() < 1e-4

    @pytest.mark.parametrize("axis", [0, 1], ids=["rows", "columns"])
    def test_distance_on_long_cells_is_exact_in_both_directions(self, axis: int):
        labels = (np.indices((60, 50))[axis] >= 20).astype(np.int32)
        away_m = np.abs(np.indices(labels.shape)[axis] - 19.5) * (1e-3, 4e-3)[axis]
        found = border_distance(labels, (4e-3, 1e-3), 0.01)
        assert found == pytest.approx(np.minimum(away_m, 0.01), abs=1e-8)

    def test_grid_too_coarse_along_one_side_is_reported(self):
        labels = (np.indices((100, 800))[1] > 400).astype(np.int32)
        with collected() as notes:
            GROOVE.felt(HapticSurface(Relief(np.full((100, 800), HIGH_M, np.float32), (SIDE_M, SIDE_M)), labels))
        assert ["3 mm is 3.8 cells wide" in note for note in notes] == [True]


class TestForces:
    def test_hand_sinks_into_the_groove_by_its_section(self):
        surface, *_ = straight(400, 0)
        y = np.linspace(-0.003, 0.003, 400)
        path = np.column_stack([0 * y + 0.001, y, np.full_like(y, HIGH_M - 0.001)])
        depth_m = GROOVE.touch(surface).path(path)[:, 2] / K
        assert np.allclose(depth_m, 0.001 - section(y), atol=8e-6)

    @pytest.mark.parametrize("law", ["proxy", {"use": "with-materials", "law": "penalty"}, "lateral-shape"])
    def test_force_is_that_of_the_inner_law_on_the_carved_surface(self, law: str | dict[str, str]):
        surface = straight(200, 30)[0]
        surface = replace(surface, materials=(library()["sand"], library()["rubber"]), names=("a", "b"))
        method = Engraved(law=law)
        carved = method.felt(surface)
        assert carved.labels is not None and surface.labels is not None and carved.names == surface.names
        assert np.array_equal(carved.labels, surface.labels)
        assert carved.materials == surface.materials
        use = dict(method.law) if isinstance(method.law, dict) else {}
        own = load_method("render", use.pop("use"))(**use).touch(carved)
        path = np.random.default_rng(2).uniform(-0.01, 0.01, (2000, 3)).cumsum(axis=0) / 40 + [0, 0, HIGH_M]
        found = method.touch(surface)
        assert digest_of(found.path(path)) == digest_of(own.path(path)) and found.path(path).any()
        assert found.stiffness_n_per_m == own.stiffness_n_per_m

    @pytest.mark.parametrize("labels", [None, np.zeros((50, 50), np.int32), np.full((50, 50), 3, np.int32)])
    def test_surface_without_borders_is_reported_once(self, labels: np.ndarray | None):
        surface = HapticSurface(Relief(np.full((50, 50), HIGH_M, np.float32), (SIDE_M, SIDE_M)), labels)
        path = np.column_stack([np.linspace(-0.05, 0.05, 200), np.zeros(200), np.full(200, HIGH_M - 0.001)])
        with collected() as notes:
            found = Engraved().touch(surface).path(path)
        assert digest_of(found) == digest_of(Proxy().touch(surface).path(path))
        assert notes == ["no groove is engraved: the surface has no borders between parts or segments"]


class TestBase:
    def test_ground_too_low_for_a_groove_is_raised_and_reported(self):
        halves = straight(400, 30)[0]
        surface = HapticSurface(Relief(np.full((400, 400), 0.0002, np.float32), (SIDE_M, SIDE_M)), halves.labels)
        with collected() as notes:
            carved = GROOVE.felt(surface)
        assert carved.height_m.min() == 0
        assert carved.height_m.max() == pytest.approx(GROOVE.depth_m, abs=2e-6)
        assert notes == ["the surface is raised by 0.4 mm, so that its grooves stay above the base"]
        deep = GROOVE.felt(straight(400, 30)[0])
        assert np.allclose(deep.height_m - deep.height_m.min(), carved.height_m, atol=1e-8)


@pytest.mark.whole
def test_preflight_judges_the_grooves():
    labels = (np.indices((80, 80))[1] > 40).astype(np.int32)
    scene = Scene.photo(np.full((80, 80, 3), 128, np.uint8), segments=labels)
    level_m = {number: {"height_m": 0.004} for number in (1, 2)}

    def notes(law: ForceRenderer) -> str:
        pipeline = Pipeline(
            scene,
            render=law,
            device=Mock(),
            parts=level_m,
            heights={"by": "given", "round_m": 0, "bulge_m": 0, "detail_m": 0},
            workspace={"width_m": 0.04, "relief_m": 0.006, "smooth_m": 0},
            cached=False,
        )
        return "".join(each.note for each in pipeline.preflight() if each.of == "a wall")

    assert "the steepest slope is 0" in notes(Proxy())
    assert "the steepest slope is 2." in notes(Engraved(width_m=0.004, depth_m=0.003))


class TestOptions:
    @pytest.mark.parametrize(
        "options",
        [
            {"law": "engraved"},
            {"law": {"use": "proxy", "stifness": 3}},
            {"law": {}},
            {"law": "no-such-law"},
            {"width_m": 0},
            {"depth_m": np.inf},
        ],
    )
    def test_wrong_options_are_refused(self, options: dict[str, object]):
        with pytest.raises(OptionError):
            Engraved(**options)  # pyright: ignore[reportArgumentType]

    def test_materials_around_engraved_are_refused(self):
        with pytest.raises(OptionError):
            WithMaterials(law="engraved")
        assert Engraved(law={"use": "with-materials"}).touch(straight(50, 30)[0]) is not None
