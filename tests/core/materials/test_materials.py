"""Materials and their rules. Otherwise a part would feel like another material than its file says."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from matplotlib.colors import XKCD_COLORS, to_rgb

from tangible_core.data import Material, SegmentMap
from tangible_core.errors import ConfigError, MaterialError
from tangible_core.materials.assignment import LADDER, assign, library, load_library, relative_roughness
from tangible_core.materials.files import value_sources
from tangible_core.materials.rules import COLOURS, MaterialRule, colour_names, segment_colours

MUD = "mud: {stiffness_n_per_m: 300, damping_n_s_per_m: 2, static_friction: 0.6, dynamic_friction: 0.5}\n"


def stripes(count: int, size: int = 40) -> SegmentMap:
    """Return upright segments, side by side."""
    return SegmentMap(np.repeat(np.arange(count, dtype=np.int32), size)[None].repeat(size, axis=0))


def checkers(*amplitudes: float, size: int = 40) -> np.ndarray:
    """Return a picture of stripes, each a checkerboard of its amplitude about 0.5."""
    rows, columns = np.indices((size, size * len(amplitudes)))
    return 0.5 + np.where((rows + columns) % 2, 1, -1) * np.repeat(amplitudes, size)


def complaints(tmp_path: Path, text: str) -> list[str]:
    """Return the complaints about a library file, without its folder."""
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError) as error:
        load_library(path)
    return str(error.value).replace(f"{tmp_path}/", "").splitlines()


class TestOwnFile:
    def test_file_adds_and_changes_materials(self, tmp_path: Path):
        path = tmp_path / "mine.yaml"
        path.write_text(MUD)
        more = load_library(path)
        assert more["mud"] == Material("mud", 300, 2, 0.6, 0.5, source="guess")
        assert [*more] == [*library(), "mud"]
        assert "mud" not in library()
        path.write_text("ice: {stiffness_n_per_m: 1.2e3}\n")
        ice = load_library(path)["ice"]
        source = f"stiffness_n_per_m: mine.yaml; {library()['ice'].source}"
        assert ice == replace(library()["ice"], stiffness_n_per_m=1200.0, source=source)

    def test_all_complaints_come_at_once_with_their_places(self, tmp_path: Path):
        text = (
            "ice: {stifness_n_per_m: 3, damping_n_s_per_m: -1}\n"
            "mud:\n  stiffness_n_per_m: .nan\n  grain_m: fine\n  static_friction: yes\n  source: {grain: x}\n"
            "3: {}\n"
            "felt: 3\n"
            "wood: {dynamic_friction: 0.9}\n"
            "glas: {source: 4}\n"
        )
        lines = complaints(tmp_path, text)
        places = ["1:28", "1:7", "3:3", "5:3", "4:3", "6:12", "2:1", "7:1", "8:1", "9:1", "10:8", "10:1"]
        assert [line.split(": ", 1)[0] for line in lines] == [f"mine.yaml:{place}" for place in places]
        assert "did you mean 'stiffness_n_per_m'" in lines[1] and "did you mean 'grain_m'" in lines[5]
        assert "dynamic_friction 0.9 is above static_friction 0.26" in lines[9]
        assert "are missing" in lines[11] and "did you mean 'glass'" in lines[11]

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("ice: [\n", "mine.yaml:2:1: "),
            ("ice: {}\nice: {}\n", "mine.yaml:2:1: "),
            ("ice:\n\tgrain_m: 1\n", "mine.yaml:2:1: "),
            ("", "mine.yaml:1:1: the file is empty; a library is a mapping"),
            ("- ice\n", "mine.yaml:1:1: a library is a mapping"),
            ("ice: {stiffness_n_per_m: 0}\n", "mine.yaml:1:7: ice.stiffness_n_per_m: "),
            ("ice: {grain_m: .inf}\n", "mine.yaml:1:7: ice.grain_m: "),
            ("ice: {grain_m: true}\n", "mine.yaml:1:7: ice.grain_m: "),
            ("ice: {seed: 1.5}\n", "mine.yaml:1:7: ice.seed: "),
            ("ice: {direction_deg: 180}\n", "mine.yaml:1:7: ice.direction_deg: "),
            ("ice: {texture: periodical}\n", "mine.yaml:1:7: ice.texture: "),
            ("sand: {texture: smooth}\n", "mine.yaml:1:1: material 'sand': texture is smooth"),
        ],
    )
    def test_text_that_is_not_a_library_is_refused(self, tmp_path: Path, text: str, complaint: str):
        assert complaints(tmp_path, text)[0].startswith(complaint)

    def test_sources_of_each_value_are_told_apart(self, tmp_path: Path):
        path = tmp_path / "mine.yaml"
        path.write_text(MUD + "ice: {grain_m: 0.002, texture: smooth}\nglass: {source: my rig}\n")
        mine = load_library(path)
        assert set(value_sources(mine["mud"]).values()) == {"guess"}
        assert set(value_sources(mine["glass"]).values()) == {"my rig"}
        ice = value_sources(mine["ice"])
        assert ice["grain_m"] == ice["texture"] == "mine.yaml"
        assert ice["dynamic_friction"] == "physics.info/friction, ice on steel"
        assert ice["stiffness_n_per_m"] == "guess"


class TestByName:
    def test_labels_get_their_materials_and_all_mistakes_are_reported(self):
        assigned = assign(stripes(3), None, {1: "ice", 2: "sand", 3: "ice"}, library())
        assert [material.name for material in assigned.materials] == ["ice", "sand", "ice"]
        assert assigned.reasons == ("segment 1: named ice", "segment 2: named sand", "segment 3: named ice")
        with pytest.raises(MaterialError) as error:
            assign(stripes(3), None, {1: "icee", 4: "sand", -1: "sand"}, library())
        first, second, third = str(error.value).splitlines()
        assert first.startswith("segment 1: no material is named 'icee' (did you mean 'ice'?)")
        assert second == "there is no segment 4: the 3 segments are numbered from 1 to 3"
        assert third == "there is no segment -1: the 3 segments are numbered from 1 to 3"


class TestByRoughness:
    def test_rougher_segment_gets_the_rougher_material_in_order(self):
        picture = checkers(0.3, 0.0, 0.1)
        assigned = assign(stripes(3), picture, "roughness", library())
        assert [material.name for material in assigned.materials] == ["brick", "ice", "wood"]
        spread = picture.std()
        assert assigned.reasons == (
            f"segment 1: number 3 of 3 from smooth to rough ({0.3 / spread * np.sqrt(80 / 81):.3f}) -> brick",
            "segment 2: number 1 of 3 from smooth to rough (0.000) -> ice",
            f"segment 3: number 2 of 3 from smooth to rough ({0.1 / spread * np.sqrt(80 / 81):.3f}) -> wood",
        )
        assigned = assign(stripes(12), checkers(*np.arange(12) / 30), "roughness", library())
        rungs = [LADDER.index(material.name) for material in assigned.materials]
        assert rungs == [0, 1, 1, 2, 3, 4, 4, 5, 6, 7, 7, 8]

    @pytest.mark.parametrize(
        ("shape", "side"), [((40, 90), 3), ((300, 256), 5), pytest.param((704, 800), 11, marks=pytest.mark.whole)]
    )
    def test_roughness_window_is_a_64th_of_the_shorter_side(self, shape: tuple[int, int], side: int):
        """Compare with the plain formula: the median of the deviation in windows of at least three pixels."""
        picture = np.random.default_rng(2).random(shape)
        picture[:, shape[1] // 2 :] **= 6
        labels = np.zeros(shape, np.int32)
        labels[:, shape[1] // 2 :] = 1
        grey = np.pad(picture, side // 2, mode="symmetric")
        windows = np.lib.stride_tricks.sliding_window_view(grey, (side, side))
        deviations = windows.std(axis=(2, 3)) / picture.std()
        expected = [np.median(deviations[labels == label]) for label in (0, 1)]
        assert relative_roughness(SegmentMap(labels), picture) == pytest.approx(expected, abs=6e-4)

    def test_roughness_without_a_picture_is_refused(self):
        for picture in (None, np.zeros((3, 4))):
            with pytest.raises(MaterialError, match=r"need the picture of the segments, \(40, 80\)"):
                assign(stripes(2), picture, "roughness", library())


QUARTERS = np.uint8([[[90, 140, 200], [120, 85, 50]], [[60, 120, 50], [128, 128, 128]]])
"""Sky, wood, grass, stone: one segment each, in reading order."""


def quarters(side: int = 20) -> tuple[SegmentMap, np.ndarray]:
    labels = np.int32([[0, 1], [2, 3]]).repeat(side, axis=0).repeat(side, axis=1)
    return SegmentMap(labels), QUARTERS.repeat(side, axis=0).repeat(side, axis=1)


def rules(*texts: dict) -> list[MaterialRule]:
    return [MaterialRule.model_validate(text) for text in texts]


class TestByRules:
    def test_first_fitting_rule_wins(self):
        segments, picture = quarters()
        given = rules(
            {"segment": 4, "material": "sand"},
            {"at": [25.4, 0], "material": "ice"},
            {"colour": "brown", "material": "wood"},
            {"colour": "blue", "material": "water"},
            {"segment": 1, "material": "glass"},
        )
        assigned = assign(segments, picture, "rules", library(), given, "leather")
        assert [material.name for material in assigned.materials] == ["water", "ice", "leather", "sand"]
        assert assigned.reasons == (
            "segment 1: rule 4, 100 % of it blue -> water",
            "segment 2: rule 2, at [25.4, 0] -> ice",
            "segment 3: not named -> leather",
            "segment 4: rule 1, named -> sand",
        )

    @pytest.mark.parametrize(
        ("at", "label"), [([19.4, 19.4], 0), ([19.6, 19.4], 1), ([19.4, 19.6], 2), ([39, 39], 3), ([0, 39.4], 2)]
    )
    def test_point_selects_the_pixel_with_the_nearest_centre(self, at: list[float], label: int):
        assigned = assign(quarters()[0], None, "rules", library(), rules({"at": at, "material": "ice"}))
        assert [material.name for material in assigned.materials].index("ice") == label

    def test_rules_decide_by_colour_name_or_roughness(self):
        given = rules({"segment": 2, "material": "glass"})
        assigned = assign(stripes(3), None, {2: "sand", 3: "wood"}, library(), given)
        assert [material.name for material in assigned.materials] == ["plain", "glass", "wood"]
        picture = checkers(0.3, 0.0, 0.1)
        alone, ruled = (assign(stripes(3), picture, "roughness", library(), each) for each in ([], given))
        assert [material.name for material in ruled.materials] == ["brick", "glass", "wood"]
        assert ruled.reasons[::2] == alone.reasons[::2]
        segments, picture = quarters()
        picture[:9, :20] = (200, 30, 30)
        assigned = assign(segments, picture, "rules", library(), rules({"colour": "blue", "material": "water"}))
        assert assigned.reasons[0] == "segment 1: rule 1, 55 % of it blue -> water"
        picture[:11, :20] = (200, 30, 30)
        assigned = assign(segments, picture, "rules", library(), rules({"colour": "blue", "material": "water"}))
        assert assigned.reasons[0] == "segment 1: not named -> plain"

    def test_every_wrong_rule_is_reported(self):
        given = rules(
            {"segment": 5, "material": "ice"}, {"at": [40, 3], "material": "ice"}, {"colour": "red", "material": "ice"}
        )
        with pytest.raises(MaterialError) as error:
            assign(quarters()[0], np.zeros((3, 4)), "rules", library(), given)
        first, second, third = str(error.value).splitlines()
        assert first.startswith("materials: rule 1: there is no segment 5: the 4 segments are numbered from 1 to 4")
        assert second == "materials: rule 2: [40, 3] lies outside the picture of 40 x 40 pixels"
        assert third.startswith("materials: rule 3: a rule by colour needs the segmented picture")

    @pytest.mark.parametrize("rule", [{}, {"segment": 1, "colour": "red"}])
    def test_rule_with_two_selectors_or_none_is_refused(self, rule: dict):
        with pytest.raises(ValueError, match="takes one of segment, part, at and colour"):
            MaterialRule.model_validate({**rule, "material": "ice"})


BASIC = [name for name in COLOURS if name not in ("black", "white", "grey")]
SHADES = ("", "light ", "pale ", "bright ", "dull ", "dusty ", "dark ")
SURVEY = {
    f"{shade}{name}": (name, to_rgb(XKCD_COLORS[f"xkcd:{shade}{name}"]))
    for name in BASIC
    for shade in SHADES
    if f"xkcd:{shade}{name}" in XKCD_COLORS
}


def name_of(rgb: tuple[float, float, float]) -> str:
    (name,) = colour_names(cv2.cvtColor(np.float32([[rgb]]), cv2.COLOR_RGB2LAB)[0])
    return COLOURS[name]


@pytest.mark.parametrize("name", SURVEY)
def test_colour_names_agree_with_the_survey(name: str):
    expected, rgb = SURVEY[name]
    assert name_of(rgb) == expected


def test_colour_of_a_segment_is_named_by_its_hue_and_most_pixels():
    assert [name_of((share,) * 3) for share in (0, 0.5, 1)] == ["black", "grey", "white"]
    picture = np.zeros((2, 8, 3), np.uint8)
    picture[:, :3] = (0, 0, 255)
    picture[:, 3:4] = (255, 0, 0)
    picture[:, 4:] = (255, 255, 255)
    labels = np.repeat(np.int32([[0, 1]]), 4, axis=1).repeat(2, axis=0)
    assert segment_colours(SegmentMap(labels), picture) == [("blue", 0.75), ("white", 1.0)]
