"""Parts of a picture. Otherwise a part would be felt at a wrong height or in a wrong material, or named wrongly."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap, Force, HapticState, HapticSurface, Note, SegmentMap, Views
from tangible_core.errors import ConfigError, MaterialError, PictureError
from tangible_core.parts import HeightChoice, PartChoice
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.pipeline.engine.part_heights import in_words
from tangible_core.pipeline.output.parts_text import part_heights, to_correct
from tangible_core.pipeline.pipeline import load_pipeline
from tangible_core.plugins.interfaces import DepthEstimator, PlainTouch, Segmenter, Skippable

ROWS, COLUMNS = 40, 60
LABELS = np.zeros((ROWS, COLUMNS), np.int32)
LABELS[5:15, 5:20] = LABELS[5:15, 40:55] = 1
LABELS[20:35, 20:45] = 2
"""Part 0 is the wall, of segment 1; 1 and 2 are the two boxes of segment 2; 3 is of segment 3."""
PICTURE = np.random.default_rng(0).random((ROWS, COLUMNS)).astype(np.float32)
ran: list[str] = []


@pytest.fixture(autouse=True)
def _forget():
    ran.clear()


class Ramp(DepthEstimator):
    """Nearer to the right."""

    def estimate(self, views: Views) -> DisparityMap:
        ran.append("disparity")
        rows, columns = views.shape
        nearness = (np.arange(columns, dtype=np.float32) + 0.5) / columns
        return DisparityMap(np.tile(nearness, (rows, 1)), unit="relative")


class Never(Ramp, Skippable):
    """A depth method that every scene skips."""

    def skip(self, views: Views) -> str | None:
        return "the views are identical"


class Same(Segmenter):
    """The labels of above, whatever it sees."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        ran.append("segments")
        return SegmentMap(LABELS)


class Nothing(PlainTouch):
    """Feels nothing."""

    def force(self, state: HapticState) -> Force:
        return Force(0.0, 0.0, 0.0)


def scene(labels: np.ndarray | None = LABELS, picture: np.ndarray = PICTURE) -> Scene:
    return Scene.photo(picture, segments=labels)


def pipeline(labels: np.ndarray | None = LABELS, cached: bool = False, **parts: Any) -> Pipeline:
    return Pipeline(scene(labels), **parts, cached=cached)


def outcome_kinds(made: Pipeline) -> dict[str, str]:
    return {outcome.product: outcome.outcome for outcome in made.outcomes}


def notes(made: Pipeline, product: str) -> tuple[Note, ...]:
    return next(outcome.notes for outcome in made.outcomes if outcome.product == product)


def middle_mm(surface: HapticSurface, number: int) -> float:
    assert surface.labels is not None
    return 1000 * float(np.median(surface.height_m[surface.labels == number]))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    np.save(tmp_path / "photo.npy", PICTURE)
    np.save(tmp_path / "labels.npy", LABELS)
    return tmp_path


def write_pipeline(folder: Path, text: str, name: str = "p.yaml") -> Path:
    path = folder / name
    path.write_text(f"scene: {{photo: photo.npy, segments: labels.npy}}\n{text}")
    return path


SAID = "parts: {1: wall, 2: {name: left box, height_m: 1 mm}, 4: {name: chest, height_m: 3 mm, material: glass}}\n"


class TestHeights:
    def test_heights_are_given_or_medians_of_the_depth(self):
        made = pipeline(
            parts={1: "wall", 2: PartChoice(height_m=0.001), 4: {"name": "chest", "height_m": 0.003}},
            heights={"by": "given", "bulge_m": 0, "detail_m": 0},
            workspace={"smooth_m": 0},
        )
        surface = made.surface
        assert made.make("parts") is not None and made.make("parts").segments == (0, 1, 1, 2)
        expected = np.float32([0, 0.001, 0, 0.003])[made.make("parts").labels]
        np.testing.assert_array_equal(surface.height_m, expected)
        np.testing.assert_array_equal(surface.labels, made.make("parts").labels)
        assert surface.names == ("wall", "", "", "chest")
        assert surface.extent_m == pytest.approx((0.08, 0.08 * ROWS / COLUMNS))
        assert [note.text for note in notes(made, "relief")] == [
            "no depth is needed: heights are given",
            "no height is given for parts 1 and 3, which lie at 0",
        ]
        made = pipeline(heights="depth", depth=Ramp())
        found = part_heights(made.engine)
        assert found is not None
        left, wall, chest, right = (found.heights_m[number] for number in (1, 0, 3, 2))
        assert 0 == left < wall < chest < right == pytest.approx(0.0042)
        assert middle_mm(made.surface, 1) < middle_mm(made.surface, 3) < middle_mm(made.surface, 2)
        assert float(made.relief.height_m.max()) <= 0.006 + 1e-9
        for by in ("given", "depth", "guess"):
            found = part_heights(pipeline(heights=by, parts={3: {"height_m": 0.0007}}, depth=Ramp()).engine)
            assert found is not None
            assert (found.heights_m[2], found.reasons[2]) == (0.0007, "given")
            assert found.heights_m == tuple(round(each, 5) for each in found.heights_m)
        unknown = pipeline(heights={"by": "depth", "detail_m": 0}, depth=Never())
        assert unknown.disparity is None
        assert float(unknown.relief.height_m.max()) == 0

    def test_guessed_heights_are_told_and_holes_known_by_colour(self, caplog: pytest.LogCaptureFixture):
        made = pipeline(heights="guess")
        made.make("relief")
        (warning,) = [note for note in notes(made, "relief") if note.kind == "warning"]
        assert warning.text.startswith("the heights of all 4 parts are guessed, as a picture does not show")
        assert [record.levelname for record in caplog.records if "guessed" in record.message] == ["WARNING"]
        made = pipeline(heights="guess", parts={1: {"height_m": 0}, 3: {"height_m": 0}})
        made.make("relief")
        assert notes(made, "relief")[-1].text.startswith("the heights of parts 2 and 4 are guessed")
        made = pipeline(heights="guess", parts={number: {"height_m": 0} for number in range(1, 5)})
        made.make("relief")
        assert [note.kind for note in notes(made, "relief")] == ["decision"]
        y, x = np.mgrid[:120, :160]
        far = np.hypot(x - 80, y - 85)
        labels = np.where(far < 12, 2, np.where(far < 30, 1, 0)).astype(np.uint8)
        for middle, is_hole in (((70, 95, 150), True), ((200, 40, 40), False)):
            picture = np.uint8([(70, 95, 150), (50, 40, 30), middle])[labels]
            made = Pipeline(Scene.photo(picture, segments=labels), heights="guess", cached=False)
            assert part_heights(made.engine) is not None
            ground, ring, inner = part_heights(made.engine).heights_m
            assert ground == 0 < ring
            assert (inner < ring) == is_hole


class TestSkipped:
    @pytest.mark.parametrize("by", ["given", "guess"])
    def test_depth_and_texture_are_skipped_with_given_segments(self, by: str):
        made = pipeline(heights=by, depth=Ramp(), texture=Same())
        plan = {step.product: (step.outcome, step.why) for step in made.plan("surface").steps}
        assert "disparity" not in plan and plan["segments"][0] == "given"
        assert "no depth is needed: heights are" in plan["relief"][1]
        assert ran == []
        made.make("surface")
        assert (ran, outcome_kinds(made)["disparity"]) == ([], "skipped")

    def test_stages_without_labels_or_parts_are_skipped_until_they_are_wanted(self):
        made = pipeline(None, heights="depth", depth=Ramp(), texture=Same())
        assert made.surface.labels is not None and made.surface.labels.max() == 3
        assert ran == ["segments", "disparity"]
        made = pipeline(depth=Ramp())
        made.make("surface")
        assert "parts" not in outcome_kinds(made)
        assert made.surface.names is None and part_heights(made.engine) is None
        assert made.make("parts") is not None and made.make("parts").count == 4
        assert outcome_kinds(made)["parts"] == "ran"
        assert pipeline(None, depth=Ramp()).make("parts") is None


class TestCached:
    def make_surface(self, folder: Path, text: str) -> Pipeline:
        found = load_pipeline(write_pipeline(folder, text), cache=Cache(folder / "cache"))
        found.make("surface")
        return found

    def test_changed_name_makes_no_product_again(self, folder: Path):
        self.make_surface(folder, f"{SAID}heights: given\nmaterials: {{rules: [{{part: left box, material: ice}}]}}\n")
        again = self.make_surface(
            folder,
            SAID.replace("left box", "crate") + "heights: given\nmaterials: {rules: [{part: crate, material: ice}]}\n",
        )
        assert outcome_kinds(again)["surface"] == "cached"
        assert again.surface.names == ("wall", "crate", "", "chest")
        assert again.materials is not None
        assert again.materials.reasons[1] == "part 2 (crate): rule 1, named -> ice"
        assert outcome_kinds(again)["materials"] == "cached"
        assert again.relief is not None and outcome_kinds(again)["relief"] == "cached"

    @pytest.mark.parametrize(
        ("said", "heights", "relief", "materials"),
        [
            (SAID.replace("1 mm", "2 mm"), "given", "ran", "cached"),
            (SAID.replace("glass", "sand"), "given", "cached", "ran"),
            (SAID, "guess", "ran", "cached"),
            *(
                (SAID, f"{{by: given, {each}}}", "ran", "cached")
                for each in ("round_m: 1 mm", "bulge_m: 0", "detail_m: 0")
            ),
        ],
    )
    def test_change_makes_only_what_it_changes(
        self, folder: Path, said: str, heights: str, relief: str, materials: str
    ):
        self.make_surface(folder, f"{SAID}heights: given\n")
        again = self.make_surface(folder, f"{said}heights: {heights}\n")
        assert {each: outcome_kinds(again)[each] for each in ("parts", "relief", "materials", "surface")} == {
            "parts": "cached", "relief": relief, "materials": materials, "surface": "ran",
        }  # fmt: skip
        if heights == "guess":
            again = self.make_surface(folder, f"{said}heights: {heights}\n")
            assert [note.kind for note in notes(again, "relief")] == ["decision", "warning"], "also of what is cached"


class TestMaterials:
    def test_material_of_a_part_goes_before_rules_and_the_choice(self):
        made = pipeline(
            parts={1: "wall", 2: {"name": "left box", "material": "glass"}},
            materials={
                "rules": [
                    {"part": "wall", "material": "ice"},
                    {"segment": 2, "material": "wood"},
                    {"part": 3, "material": "stone"},
                ],
                "by": {1: "leather", 2: "sand", 3: "cloth"},
            },
            depth=Ramp(),
        )
        found = made.materials
        assert found is not None
        assert [material.name for material in found.materials] == ["ice", "glass", "wood", "cloth"]
        assert found.reasons == (
            "part 1 (wall): rule 1, named -> ice",
            "part 2 (left box): its own -> glass",
            "part 3: rule 2, of segment 2 -> wood",
            "part 4: segment 3, named cloth",
        )

    def test_materials_by_place_and_colour_are_those_of_the_rules(self):
        colours = np.array([[0.5] * 3, [1, 0, 0], [0, 0, 1]], np.float32)[LABELS]
        rules = [{"at": [50, 10], "material": "ice"}, {"colour": "red", "material": "brick"}]
        made = Pipeline(
            scene(picture=colours), parts={}, materials={"rules": rules, "by": "rules"}, depth=Ramp(), cached=False
        )
        assert made.materials is not None
        assert [material.name for material in made.materials.materials] == ["plain", "brick", "ice", "plain"]
        assert made.materials.reasons[1] == "part 2: rule 2, 100 % of it red -> brick"
        for choice in ({"by": "rules", "rules": [{"segment": 8, "material": "ice"}]}, {8: "ice"}):
            with pytest.raises(MaterialError, match="there is no segment 8: the 3 segments are numbered from 1 to 3"):
                pipeline(parts={}, materials=choice, depth=Ramp()).make("materials")

    def test_materials_on_a_map_of_heights_are_by_parts(self):
        heights = Scene.heights(PICTURE, segments=LABELS)
        made = Pipeline(
            heights, parts={2: {"name": "lake", "material": "water"}}, materials={"by": "rules"}, cached=False
        )
        surface = made.surface
        assert surface.materials is not None and surface.names is not None
        assert (surface.materials[1].name, surface.materials[2].name, surface.names[1]) == ("water", "plain", "lake")
        assert outcome_kinds(made)["relief"] == "given"


class TestComplaints:
    """Mistakes that only the picture shows: each has the part, its place in the file, and the cure."""

    def complaints(self, folder: Path, text: str) -> ConfigError:
        made = load_pipeline(write_pipeline(folder, text), cache=Cache(folder / "cache"))
        with pytest.raises(ConfigError) as error:
            made.plan("surface")
        with pytest.raises(ConfigError) as later:
            made.make("surface")
        assert str(error.value) == str(later.value)
        return error.value

    @pytest.mark.parametrize(
        ("text", "location", "line", "column"),
        [
            ("parts:\n  1: wall\n  10: {name: ghost}\nheights: given\n", ("parts", 10), 4, 3),
            ("parts: {}\nmaterials: {rules: [{part: 5, material: ice}]}\n", ("materials", "rules", 0, "part"), 3, 22),
        ],
    )
    def test_unknown_part_is_refused_with_its_place(
        self, folder: Path, text: str, location: tuple, line: int, column: int
    ):
        error = self.complaints(folder, text)
        assert "the 4 parts are numbered from 1 to 4" in str(error)
        (complaint,) = error.complaints
        assert (complaint.location, complaint.line, complaint.column) == (location, line, column)
        with pytest.raises(ConfigError) as error:
            pipeline(parts={10: "ghost", 2: {"height_m": 1}}, heights="given").make("relief")
        assert [each.location for each in error.value.complaints] == [("parts", 10), ("parts", 2, "height_m")]
        assert {each.line for each in error.value.complaints} == {None}

    def test_height_above_the_workspace_is_refused_with_the_cure(self, folder: Path):
        error = self.complaints(folder, f"{SAID.replace('3 mm', '4.3 mm')}heights: given\n")
        assert ":2:72: parts.4.height_m: part 4 (chest), at [32, 27] of the picture, is 4.3 mm high" in str(error)
        assert str(error).endswith("workspace.relief_m 6.1 mm")
        assert error.complaints[0].location == ("parts", 4, "height_m")
        made = load_pipeline(
            write_pipeline(folder, f"{SAID.replace('3 mm', '4.3 mm')}heights: given\n"), ["workspace.relief_m=6.1 mm"]
        )
        assert made.surface.height_m.max() <= 0.0061
        load_pipeline(write_pipeline(folder, f"{SAID.replace('3 mm', '4.2 mm')}heights: given\n")).make("surface")

    @pytest.mark.parametrize("parts", [{}, {"heights": "depth"}], ids=["materials alone", "heights"])
    def test_unknown_part_is_refused_before_depth_runs(self, parts: dict):
        made = pipeline(None, parts={10: "ghost"}, depth=Ramp(), texture=Same(), **parts)
        with pytest.raises(ConfigError, match="there is no part 10"):
            made.make("surface")
        assert (ran, outcome_kinds(made)["parts"]) == (["segments"], "failed")

    @pytest.mark.parametrize("key", ["heights: given", "parts: {1: wall}"])
    def test_parts_without_segments_are_refused_with_the_cure(self, folder: Path, key: str):
        path = folder / "p.yaml"
        path.write_text(f"scene: {{photo: photo.npy}}\ndepth: luminance\n{key}\n")
        made = load_pipeline(path)
        plan = made.plan("surface")
        assert plan.steps[-1].product == "parts"
        assert "p.yaml:3:1: " in plan.refusal and "the scene has none" in plan.refusal
        with pytest.raises(ConfigError) as error:
            made.make("surface")
        assert error.value.complaints[0].location == (key.partition(":")[0],)

    def test_parts_that_are_small_or_too_many_are_told(self):
        grain = np.indices((2 * ROWS, 2 * COLUMNS)).sum(axis=0) % 2  # each pixel a part
        made = Pipeline(scene(grain, np.zeros(grain.shape)), heights="guess", cached=False)
        with pytest.raises(PictureError, match="at most 4096 can be felt"):
            made.plan("surface")
        labels = LABELS.copy()
        labels[2, 50] = labels[30, 2] = 5
        made = pipeline(labels, heights="given")
        made.make("surface")
        assert made.make("parts").count == 6
        (slip,) = notes(made, "parts")
        assert slip.kind == "warning"
        assert "part 2 at [50, 2] (1 pixel), part 6 at [2, 30] (1 pixel)" in slip.text


class TestWritten:
    def test_run_with_guessed_heights_lists_its_parts_in_an_equal_file(self, folder: Path):
        parts = "{1: Wand, 4: {name: Truhe, material: glass}}"
        text = f"title: Boxes\nlanguage: de\nparts: {parts}\nheights: {{by: guess, bulge_m: 1 mm}}\n"
        first = load_pipeline(write_pipeline(folder, text), cache=Cache(folder / "cache"))
        run = first.run(folder / "out")
        file = folder / "out" / "parts-guessed.yaml"
        assert file in run.files
        assert file.read_text(encoding="utf-8") == to_correct(first.engine)
        again = load_pipeline(file)
        assert again.config.heights == HeightChoice(by="given", bulge_m=0.001)
        assert again.config.part_names == {0: "Wand", 3: "Truhe"}
        assert (again.config.title, again.config.language) == ("Boxes", "de")
        assert again.surface.digest() == first.surface.digest()
        np.testing.assert_array_equal(again.surface.height_m, first.surface.height_m)
        line = next(each for each in file.read_text(encoding="utf-8").splitlines() if each.startswith("  4: "))
        assert (
            line.startswith("  4: {name: Truhe, height_m: 4.7 mm, ")
            and "material: glass}   # part 4: guessed, " in line
        )
        rerun = again.run(folder / "out")
        assert not file.exists() and file not in rerun.files
        run = load_pipeline(write_pipeline(folder, f"title: Boxes\n{SAID}heights: given\n")).run(folder / "out")
        document = json.loads((folder / "out" / "outcomes.json").read_text(encoding="utf-8"))
        assert (document["title"], document["language"]) == ("Boxes", "en")
        assert document["figures"]["parts"]["3"] == {
            "name": "chest", "material": "glass", "height_m": 0.003, "why": "given",
        }  # fmt: skip
        assert (folder / "out" / "parts.npz").exists()
        assert "Boxes. Input" in run.sheet_says and "4 chest: glass" in run.sheet_says
        assert "Segments" not in run.sheet_says
        assert "Its parts, from near to far, are chest (" in run.sheet_says
        assert "heights: {by: guess" not in run.sheet_says and not (folder / "out" / "parts-guessed.yaml").exists()


def test_many_parts_are_named_up_to_eight_and_the_others_counted():
    eight = "parts 1, 2, 3, 4, 5, 6, 7"
    said = [in_words(list(range(count))) for count in (1, 2, 8, 9, 12)]
    assert said == ["part 1", "parts 1 and 2", f"{eight} and 8", f"{eight}, 8 and 1 more", f"{eight}, 8 and 4 more"]
